//! A 3x3 matrix as text, as NumPy saves it: nine numbers, with or without commas, semicolons and brackets. `#` begins a comment.

use super::fields::camera;
use super::{CameraFile, wrong};
use crate::error::Result;
use crate::organize::GridCamera;
use crate::text::preview;

/// Whether the text is one, by its beginning: a number, perhaps in brackets.
pub(super) fn is_mine(text: &str) -> bool {
    let first = text.lines().flat_map(words).next();
    first.is_some_and(|word| word.parse::<f64>().is_ok())
}

/// Reads the text.
///
/// # Errors
/// A word is no number, there are not nine, or they are no camera.
pub(super) fn read(text: &str) -> Result<CameraFile> {
    let words: Vec<&str> = text.lines().flat_map(words).take(10).collect();
    let mut nine = [0.0; 9];
    if words.len() != nine.len() {
        let count = if words.len() > 9 { "more".to_owned() } else { words.len().to_string() };
        return Err(wrong(format!("a 3x3 matrix has 9 numbers, this has {count}")));
    }
    for (number, word) in nine.iter_mut().zip(&words) {
        let parsed = word.parse().ok().filter(|number: &f64| number.is_finite());
        *number = parsed.ok_or_else(|| wrong(format!("`{}` is not a number", preview(word.as_bytes()))))?;
    }
    Ok(CameraFile { camera: GridCamera { camera: camera("it", nine)?, size: None }, depth_scale: None })
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
    fn what_is_wrong_is_said() {
        for (text, said) in [
            ("525 525 320 240", "a 3x3 matrix has 9 numbers, this has 4"),
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
