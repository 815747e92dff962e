//! Cameras in JSON files: `{"fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5, "width": 640, "height": 480, "depth_scale": 1000}`.
//!
//! Size and `depth_scale` (units of a depth image that make a metre) may be left out. `x_offset` and `y_offset` are
//! taken for `cx` and `cy`, `img_width` and `img_height` for the size: so the files of NVIDIA's Unseen Object Clustering
//! have them. Whatever else is in the file is ignored.

use std::path::Path;

use objecthood::Camera;
use serde::Deserialize;
use serde_json::Value;

use crate::error::{Error, Result};
use crate::formats::read_file;
use crate::organize::GridCamera;
use crate::text::without_byte_order_mark;

/// What a camera file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// The camera and the size of its image.
    pub camera: GridCamera,
    /// Units of a depth image that make a metre.
    pub depth_scale: Option<f64>,
}

/// The file as it is written. Values of any kind, so that one of the wrong kind is named.
#[derive(Deserialize)]
struct Fields {
    fx: Value,
    fy: Value,
    #[serde(alias = "x_offset")]
    cx: Value,
    #[serde(alias = "y_offset")]
    cy: Value,
    #[serde(alias = "img_width")]
    width: Option<Value>,
    #[serde(alias = "img_height")]
    height: Option<Value>,
    depth_scale: Option<Value>,
}

/// Opens the file at `path`.
///
/// # Errors
/// [`Error::At`] the path: it cannot be read, or those of [`parse`].
pub fn open(path: &Path) -> Result<CameraFile> {
    let bytes = read_file(path, check_beginning);
    bytes.and_then(|bytes| parse(&bytes)).map_err(|error| error.at(path))
}

/// Reads the content of a camera file.
///
/// # Errors
/// [`Error::BadCameraFile`] says what is missing or wrong, [`Error::Frame`] that these are no intrinsics.
pub fn parse(bytes: &[u8]) -> Result<CameraFile> {
    check_beginning(bytes)?;
    let fields: Fields = serde_json::from_slice(without_byte_order_mark(bytes)).map_err(not_json)?;
    let size = match (&fields.width, &fields.height) {
        (None, None) => None,
        (Some(width), Some(height)) => Some((pixels("width", width)?, pixels("height", height)?)),
        _ => return Err(wrong("of `width` and `height` one is missing")),
    };
    let depth_scale = fields.depth_scale.as_ref().map(|scale| match number("depth_scale", scale)? {
        positive if positive > 0.0 => Ok(positive),
        other => Err(wrong(format!("depth_scale {other} is not positive"))),
    });
    let Fields { fx, fy, cx, cy, .. } = &fields;
    let camera = Camera::new(number("fx", fx)?, number("fy", fy)?, number("cx", cx)?, number("cy", cy)?)?;
    Ok(CameraFile { camera: GridCamera { camera, size }, depth_scale: depth_scale.transpose()? })
}

/// Refuses what is no JSON object by its first bytes, so that a large file of another kind is not loaded.
fn check_beginning(head: &[u8]) -> Result<()> {
    match without_byte_order_mark(head).trim_ascii_start() {
        [b'{', ..] => Ok(()),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Err(wrong("it is UTF-16, not UTF-8")),
        _ => Err(wrong("it does not begin with {")),
    }
}

/// A finite number: JSON has no others.
fn number(name: &str, value: &Value) -> Result<f64> {
    value.as_f64().ok_or_else(|| wrong(format!("`{name}` is {value}, which is not a number")))
}

fn pixels(name: &str, value: &Value) -> Result<usize> {
    let pixels = value.as_u64().and_then(|pixels| usize::try_from(pixels).ok()).filter(|&pixels| pixels > 0);
    pixels.ok_or_else(|| wrong(format!("`{name}` is {value}, which is not a number of pixels")))
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn not_json(error: serde_json::Error) -> Error {
    if error.is_eof() { wrong("it is cut short") } else { wrong(error.to_string()) }
}

/// A file that holds no camera, for this reason. A value may be as long as the file.
fn wrong(reason: impl Into<String>) -> Error {
    const LONGEST: usize = 100;
    Error::BadCameraFile { reason: reason.into().chars().take(LONGEST).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_are_read() {
        let ours =
            parse(br#"{"fx": 525, "fy": 526.5, "cx": 319.5, "cy": 239.5, "depth_scale": 5000.0}"#).unwrap();
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        assert_eq!(ours, CameraFile { camera: GridCamera { camera, size: None }, depth_scale: Some(5000.0) });
        let theirs = br#"{"img_width": 640, "img_height": 480, "fx": 525, "fy": 526.5, "x_offset": 319.5,
            "y_offset": 239.5, "model": "plumb_bob"}"#;
        let theirs = parse(theirs).unwrap();
        assert_eq!(
            theirs,
            CameraFile { camera: GridCamera { camera, size: Some((640, 480)) }, depth_scale: None }
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_end_is_not_loaded() {
        let message = open(Path::new("/dev/zero")).unwrap_err().to_string();
        assert!(message.starts_with("/dev/zero: not a camera file (it does not begin with {)"), "{message}");
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, said) in [
            ("", "does not begin with {"),
            ("fx = 5", "does not begin with {"),
            ("[525, 525, 320, 240]", "does not begin with {"),
            (r#"{"fx": 1, "fy""#, "it is cut short"),
            (r#"{"fx": 1 "fy": 1}"#, "expected `,` or `}` at line 1 column 10"),
            (r#"{"fx": 1, "fy": 1, "cx": 1}"#, "missing field `cy`"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "x_offset": 1, "cy": 1}"#, "duplicate field `cx`"),
            (r#"{"fx": "1", "fy": 1, "cx": 1, "cy": 1}"#, "`fx` is \"1\", which is not a number"),
            (r#"{"fx": 0, "fy": 1, "cx": 1, "cy": 1}"#, "focal lengths from"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5}"#, "one is missing"),
            (
                r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5, "height": 0}"#,
                "`height` is 0, which is not a number of pixels",
            ),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5.5, "height": 2}"#, "`width` is 5.5"),
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
