//! Numbers alone, as text: a 3x3 matrix as NumPy saves it, or fx, fy, cx and cy. With or without commas, semicolons and brackets; `#`
//! begins a comment.

use objecthood::Camera;

use super::fields::camera;
use super::{CameraFile, wrong};
use crate::error::{Error, Result};
use crate::organize::GridCamera;
use crate::text::preview;

/// Words that are read: one more than a matrix has.
const MOST_WORDS: usize = 10;

/// Whether the text is such, by its beginning: a number, perhaps in brackets.
pub(super) fn is_mine(text: &str) -> bool {
    let first = text.lines().flat_map(words).next();
    first.is_some_and(|word| word.parse::<f64>().is_ok())
}

/// Reads the text.
///
/// # Errors
/// A word is no number, there are neither four nor nine, or they are no camera.
pub(super) fn read(text: &str) -> Result<CameraFile> {
    let words = text.lines().flat_map(words).take(MOST_WORDS);
    let numbers = words.map(number).collect::<Result<Vec<f64>>>()?;
    let camera = match numbers[..] {
        [fx, fy, cx, cy] => Camera::new(fx, fy, cx, cy)?,
        _ => match <[f64; 9]>::try_from(numbers) {
            Ok(nine) => camera("it", nine)?,
            Err(numbers) => return Err(wrong_count(numbers.len())),
        },
    };
    Ok(CameraFile { camera: GridCamera { camera, size: None }, depth_scale: None })
}

fn number(word: &str) -> Result<f64> {
    let parsed = word.parse().ok().filter(|number: &f64| number.is_finite());
    parsed.ok_or_else(|| wrong(format!("`{}` is not a number", preview(word.as_bytes()))))
}

fn wrong_count(count: usize) -> Error {
    let count = if count == MOST_WORDS { "more".to_owned() } else { count.to_string() };
    wrong(format!("a 3x3 matrix has 9 numbers, and fx, fy, cx, cy are 4; this has {count}"))
}

/// The words of a line up to a comment.
fn words(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split('#').next().unwrap_or_default();
    let is_between = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '[' | ']');
    code.split(is_between).filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use objecthood::Camera;

    #[test]
    fn matrices_are_read() {
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        for text in [
            "525 0 319.5\n0 526.5 239.5\n0 0 1\n",
            "# Kinect\n5.250000000000000000e+02 0.0e+00 3.195e+02\r\n0 5.265e2 239.5\r\n0 0 1\r\n",
            "[[525, 0, 319.5], [0, 526.5, 239.5], [0, 0, 1]]",
            "[525, 0, 319.5; 0, 526.5, 239.5; 0, 0, 1]",
            "525,0,319.5\n0,526.5,239.5\n0,0,1",
        ] {
            let file = parse(text.as_bytes()).unwrap();
            assert_eq!((file.camera.camera, file.camera.size, file.depth_scale), (camera, None, None));
        }
    }

    #[test]
    fn four_numbers_are_focal_lengths_and_principal_point() {
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        for text in
            ["525 526.5 319.5 239.5\n", "525,526.5,319.5,239.5", "# fx fy cx cy\n525\n526.5\n319.5\n239.5"]
        {
            let file = parse(text.as_bytes()).unwrap();
            assert_eq!(
                (file.camera.camera, file.camera.size, file.depth_scale),
                (camera, None, None),
                "{text}"
            );
        }
    }

    /// Rectification leaves it where no camera has any.
    #[test]
    fn a_skew_that_rounding_leaves_is_none() {
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        for text in ["525 5e-4 319.5 0 526.5 239.5 0 0 1", "525 0 0 -1e-14 526.5 0 319.5 239.5 1"] {
            assert_eq!(parse(text.as_bytes()).unwrap().camera.camera, camera, "{text}");
        }
        assert!(parse(b"525 6e-4 319.5 0 526.5 239.5 0 0 1").is_err());
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, said) in [
            ("525 525 320 240 640", "a 3x3 matrix has 9 numbers, and fx, fy, cx, cy are 4; this has 5"),
            ("525 525 320 1e8", "is not a camera"),
            ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "this has more"),
            ("525 0 c\n0 525 240\n0 0 1", "`c` is not a number"),
            ("525 0 inf\n0 525 240\n0 0 1", "`inf` is not a number"),
            ("525 2 320\n0 525 240\n0 0 1", "it is no matrix fx 0 cx, 0 fy cy, 0 0 1"),
            ("525 0 320\n0 525 240\n0 0 5", "it is no matrix"),
            ("525 0 320\n0 525 240\n1 0 1", "it is no matrix"),
            ("0 0 320\n0 525 240\n0 0 1", "focal lengths from"),
        ] {
            let message = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains('\n'), "{text}: {message}");
        }
    }
}
