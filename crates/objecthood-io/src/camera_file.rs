//! Cameras in JSON files: `{"fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5, "width": 640, "height": 480, "depth_scale": 1000}`.
//!
//! Size and `depth_scale` (units of a depth image that make a metre) may be left out. `x_offset` and `y_offset` are
//! taken for `cx` and `cy`, `img_width` and `img_height` for the size: so the files of NVIDIA's Unseen Object Clustering
//! have them. Whatever else is in the file is ignored.

use std::path::Path;

use objecthood::Camera;
use serde::Deserialize;

use crate::error::{Error, Result};
use crate::formats::read_file;
use crate::organize::GridCamera;

/// What a camera file says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// The camera and the size of its image.
    pub camera: GridCamera,
    /// Units of a depth image that make a metre.
    pub depth_scale: Option<f64>,
}

/// The file as it is written.
#[derive(Deserialize)]
struct Fields {
    fx: f64,
    fy: f64,
    #[serde(alias = "x_offset")]
    cx: f64,
    #[serde(alias = "y_offset")]
    cy: f64,
    #[serde(alias = "img_width")]
    width: Option<usize>,
    #[serde(alias = "img_height")]
    height: Option<usize>,
    depth_scale: Option<f64>,
}

/// Opens the file at `path`.
///
/// # Errors
/// [`Error::At`] the path: it cannot be read, or those of [`parse`].
pub fn open(path: &Path) -> Result<CameraFile> {
    let bytes = read_file(path, |head| match head.trim_ascii_start() {
        [b'{', ..] => Ok(()),
        _ => Err(Error::BadCameraFile { reason: "it does not begin with {".to_owned() }),
    });
    bytes.and_then(|bytes| parse(&bytes)).map_err(|error| error.at(path))
}

/// Reads the content of a camera file.
///
/// # Errors
/// [`Error::BadCameraFile`] says what is missing or wrong, [`Error::Frame`] that these are no intrinsics.
pub fn parse(bytes: &[u8]) -> Result<CameraFile> {
    let wrong = |reason: String| Error::BadCameraFile { reason };
    let Fields { fx, fy, cx, cy, width, height, depth_scale } =
        serde_json::from_slice(bytes).map_err(|e| wrong(e.to_string()))?;
    let size = match (width, height) {
        (None, None) => None,
        (Some(width @ 1..), Some(height @ 1..)) => Some((width, height)),
        (Some(_), Some(_)) => return Err(wrong("an image without pixels".to_owned())),
        _ => return Err(wrong("of `width` and `height` one is missing".to_owned())),
    };
    if let Some(scale) = depth_scale.filter(|scale| !(scale.is_finite() && *scale > 0.0)) {
        return Err(wrong(format!("depth_scale {scale} is not positive")));
    }
    Ok(CameraFile { camera: GridCamera { camera: Camera::new(fx, fy, cx, cy)?, size }, depth_scale })
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
            ("", "EOF"),
            ("fx = 5", "expected"),
            ("[525, 525, 320, 240]", "invalid length"),
            (r#"{"fx": 1, "fy": 1, "cx": 1}"#, "missing field `cy`"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "x_offset": 1, "cy": 1}"#, "duplicate field `cx`"),
            (r#"{"fx": "1", "fy": 1, "cx": 1, "cy": 1}"#, "invalid type"),
            (r#"{"fx": 0, "fy": 1, "cx": 1, "cy": 1}"#, "focal lengths from"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5}"#, "one is missing"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "width": 5, "height": 0}"#, "without pixels"),
            (r#"{"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": -1}"#, "not positive"),
        ] {
            let message = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(said) && !message.contains('\n'), "{text}: {message}");
        }
    }
}
