//! Cameras with a field for each number: `{"fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5, "width": 640, "height": 480,
//! "depth_scale": 1000}`. Ours, and those that call the principal point otherwise:
//!
//! * `x_offset` and `y_offset`, with `img_width` and `img_height`: the files of NVIDIA's Unseen Object Clustering;
//! * `ppx` and `ppy`: intrinsics of librealsense. Its `depth_scale` is the metres of a unit, 0.001, where ours is the units of a
//!   metre, 1000. No camera has less than one unit a metre, so a scale below 1 beside `ppx` is one of librealsense.

use objecthood::Camera;

use super::CameraFile;
use super::fields::{Fields, depth_scale, number, size};
use crate::error::Result;
use crate::organize::GridCamera;

/// Reads fields of this kind.
///
/// # Errors
/// A number is missing or wrong.
pub(super) fn read(fields: &Fields) -> Result<CameraFile> {
    let camera = Camera::new(
        number(fields, &["fx"])?,
        number(fields, &["fy"])?,
        number(fields, &["cx", "x_offset", "ppx"])?,
        number(fields, &["cy", "y_offset", "ppy"])?,
    )?;
    let is_of_unit = |scale: &f64| fields.contains_key("ppx") && *scale < 1.0;
    let scale = depth_scale(fields)?.map(|scale| if is_of_unit(&scale) { scale.recip() } else { scale });
    Ok(CameraFile { camera: GridCamera { camera, size: size(fields)? }, depth_scale: scale })
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    #[test]
    fn every_spelling_is_read() {
        let ours =
            parse(br#"{"fx": 525, "fy": 526.5, "cx": 319.5, "cy": 239.5, "depth_scale": 5000.0}"#).unwrap();
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        assert_eq!(ours, CameraFile { camera: GridCamera { camera, size: None }, depth_scale: Some(5000.0) });
        let sized = GridCamera { camera, size: Some((640, 480)) };
        let clustering = br#"{"img_width": 640, "img_height": 480, "fx": 525, "fy": 526.5, "x_offset": 319.5,
            "y_offset": 239.5, "model": "plumb_bob"}"#;
        assert_eq!(parse(clustering).unwrap(), CameraFile { camera: sized, depth_scale: None });
        let realsense = br#"{"width": 640, "height": 480, "ppx": 319.5, "ppy": 239.5, "fx": 525.0, "fy": 526.5,
            "model": "distortion.inverse_brown_conrady", "coeffs": [0.0, 0.0, 0.0, 0.0, 0.0], "depth_scale": 0.0010000000474974513}"#;
        let realsense = parse(realsense).unwrap();
        assert_eq!(realsense.camera, sized);
        assert!((realsense.depth_scale.unwrap() - 1000.0).abs() < 1e-3);
    }
}
