//! Files with a camera, in the forms that people have:
//!
//! | file | text | known by |
//! |---|---|---|
//! | ours, NVIDIA's Unseen Object Clustering, librealsense | JSON, YAML | `fx`; see `named.rs` |
//! | Open3D | JSON | `intrinsic_matrix` |
//! | ROS, OpenCV | JSON, YAML | `K`, `k` or `camera_matrix` |
//! | BOP | JSON | `cam_K` |
//! | a 3x3 matrix, or fx, fy, cx and cy | text | begins with a number |
//!
//! Size and `depth_scale` (units of a depth image that make a metre) may be left out. Whatever else is in a file is ignored.
//! A format is a file in `camera_file/`.

mod bop;
mod fields;
mod named;
mod open3d;
mod plain_numbers;
mod ros;
mod yaml;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use serde_json::Value;

use crate::error::{Error, Result};
use crate::formats::{HEAD_BYTES, read_head};
use crate::organize::GridCamera;
use crate::text::without_byte_order_mark;

/// A file with more bytes is refused. The longest that are met list the cameras of thousands of images.
const MOST_BYTES: usize = 16 << 20;

/// What a camera file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// The camera and the size of its image.
    pub camera: GridCamera,
    /// Units of a depth image that make a metre.
    pub depth_scale: Option<f64>,
}

/// Opens the file at `path`.
///
/// # Errors
/// [`Error::At`] the path: it cannot be read, or those of [`parse`].
pub fn open(path: &Path) -> Result<CameraFile> {
    read(path).and_then(|bytes| parse(&bytes)).map_err(|error| error.at(path))
}

/// The bytes of a camera file. It may be a pipe, so its length shows only as it is read.
fn read(path: &Path) -> Result<Vec<u8>> {
    let io = |reason| Error::Read { reason };
    let mut file = File::open(path).map_err(io)?;
    let mut bytes = read_head(&mut file)?;
    check_beginning(&bytes)?;
    file.take(MOST_BYTES as u64).read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

/// Opens the `scene_camera.json` of a BOP scene: the camera of each image, by its number.
///
/// # Errors
/// [`Error::At`] the file: it cannot be read, [`Error::BadCameraFile`], [`Error::Frame`].
pub(crate) fn open_images(path: &Path) -> Result<BTreeMap<u64, CameraFile>> {
    let parse = |bytes: Vec<u8>| match serde_json::from_slice(&bytes).map_err(not_json)? {
        Value::Object(fields) => bop::images(&fields),
        _ => Err(wrong(bop::NO_LIST)),
    };
    read(path).and_then(parse).map_err(|e| e.at(path))
}

/// Reads the content of a camera file.
///
/// # Errors
/// [`Error::BadCameraFile`] says what is missing or wrong, [`Error::Frame`] that these are no intrinsics.
pub fn parse(bytes: &[u8]) -> Result<CameraFile> {
    check_beginning(&bytes[..bytes.len().min(HEAD_BYTES)])?;
    if bytes.len() > MOST_BYTES {
        return Err(wrong(format!("it has more than {} MB", MOST_BYTES >> 20)));
    }
    let text = std::str::from_utf8(without_byte_order_mark(bytes)).map_err(|_| wrong("it is not UTF-8"))?;
    if plain_numbers::is_mine(text) {
        return plain_numbers::read(text);
    }
    let value = if text.trim_ascii_start().starts_with('{') {
        serde_json::from_str(text).map_err(not_json)?
    } else {
        yaml::read(text)?
    };
    let Value::Object(fields) = &value else {
        return Err(wrong("it has no fields and does not begin with a number"));
    };
    let known = open3d::read(fields).or_else(|| ros::read(fields)).or_else(|| bop::read(fields));
    known.unwrap_or_else(|| named::read(fields))
}

/// Refuses what is no text by its first bytes, so that a large file of another kind is not loaded.
fn check_beginning(head: &[u8]) -> Result<()> {
    match head {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Err(wrong("it is UTF-16, not UTF-8")),
        head if head.trim_ascii().is_empty() => Err(wrong("it is empty")),
        head if head.iter().any(|byte| byte.is_ascii_control() && !byte.is_ascii_whitespace()) => {
            Err(wrong("it is not text"))
        }
        _ => Ok(()),
    }
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn not_json(error: serde_json::Error) -> Error {
    if error.is_eof() { wrong("it is cut short") } else { wrong(error.to_string()) }
}

/// A file that holds no camera, for this reason. A value may be as long as the file, and have lines.
fn wrong(reason: impl Into<String>) -> Error {
    const LONGEST: usize = 100;
    let one_line = |c: char| if c.is_control() { ' ' } else { c };
    Error::BadCameraFile { reason: reason.into().chars().take(LONGEST).map(one_line).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_end_is_not_loaded() {
        let message = open(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(message.starts_with("/dev/zero: not a camera file (it is not text)"), "{message}");
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, said) in [
            ("", "it is empty"),
            (" \n", "it is empty"),
            ("\0\0", "it is not text"),
            ("caf\u{e9}", "it has no fields and does not begin with a number"),
            ("fx = 5", "it has no fields and does not begin with a number"),
            ("[525, 525, 320]", "this has 3"),
            ("fx: 525\nfy: 525", "missing field `cx`"),
            (r#"{"K": [1, 0]}"#, "`K` is not nine numbers"),
            (r#"{"K": [0, 0, 0, 0, 0, 0, 0, 0, 0]}"#, "the camera is not calibrated: calibrate it, or"),
            (r#"{"cam_K": [1, 2, 3, 4, 5, 6, 7, 8, 9]}"#, "`cam_K` is no matrix fx 0 cx"),
            (r#"{"K": 1, "k": 2}"#, "it has both `K` and `k`"),
            (r#"{"fx": 1, "fy""#, "it is cut short"),
            (r#"{"fx": 1 "fy": 1}"#, "expected `,` or `}` at line 1 column 10"),
            (r#"{"fx": 1, "fy": 1, "cx": 1}"#, "missing field `cy`"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "x_offset": 1, "cy": 1}"#, "it has both `cx` and `x_offset`"),
            (r#"{"fx": "1", "fy": 1, "cx": 1, "cy": 1}"#, "`fx` is \"1\", which is not a number"),
            (r#"{"fx": 0, "fy": 1, "cx": 1, "cy": 1}"#, "focal lengths from"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5}"#, "one is missing"),
            (
                r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5, "height": 0}"#,
                "`height` is 0, which is not a number of pixels",
            ),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5.5, "height": 2}"#, "`width` is 5.5"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": -5.0, "height": 2}"#, "`width` is -5.0"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 1e30, "height": 2}"#, "`width` is 1e"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": -1}"#, "not positive"),
        ] {
            let message = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains('\n'), "{text}: {message}");
        }
    }
    /// Editors of Windows put a mark before UTF-8, and `>` of its shell writes UTF-16.
    #[test]
    fn a_camera_file_with_a_byte_order_mark_is_read() {
        let plain = r#"{"fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5}"#;
        let marked = format!("\u{feff}{plain}");
        assert_eq!(parse(marked.as_bytes()).unwrap(), parse(plain.as_bytes()).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.json");
        std::fs::write(&path, marked).unwrap();
        assert_eq!(open(&path).unwrap(), parse(plain.as_bytes()).unwrap());

        let wide: Vec<u8> = format!("\u{feff}{plain}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(parse(&wide).unwrap_err().to_string().contains("UTF-16"));
    }
}
