//! Cameras with a field for each number: `{"fx": 525, "fy": 525, "cx": 319.5, "cy": 239.5, "width": 640, "height": 480,
//! "depth_scale": 1000}`. Ours, and those that call the principal point otherwise:
//!
//! * `x_offset` and `y_offset`, with `img_width` and `img_height`: the files of NVIDIA's Unseen Object Clustering;
//! * `ppx` and `ppy`: intrinsics of librealsense.
//!
//! Our `depth_scale` is the units of a metre, 1000. Of librealsense it is the metres of a unit, 0.001, and in `camera.json` of a BOP data
//! set the millimetres of a unit, 0.1. No camera has less than one unit a metre, so a scale below 1 is one of these, and its size tells
//! which: units are between a thousandth of a millimetre and a centimetre. A scale of 1 is ours: depth in metres.

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
    let scale = depth_scale(fields)?.map(units_per_m);
    Ok(CameraFile { camera: GridCamera { camera, size: size(fields)? }, depth_scale: scale })
}

/// No unit of depth is longer (m).
const LONGEST_UNIT_M: f64 = 0.01;

/// The units in a metre, of a scale in units a metre, metres a unit, or millimetres a unit.
fn units_per_m(scale: f64) -> f64 {
    match scale {
        metres if metres < LONGEST_UNIT_M => metres.recip(),
        mm if mm < 1.0 => 1000.0 / mm,
        units => units,
    }
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

    #[test]
    fn a_scale_below_one_is_the_length_of_a_unit() {
        let units = |scale: &str| {
            let text = format!(r#"{{"cx": 1, "cy": 1, "fx": 9, "fy": 9, "depth_scale": {scale}}}"#);
            parse(text.as_bytes()).unwrap().depth_scale.unwrap()
        };
        // Metres of a unit, as RealSense has them; millimetres of a unit, as BOP; units of a metre.
        for (scale, expected) in [
            ("0.001", 1000.0),
            ("0.00025", 4000.0),
            ("0.1", 10_000.0),
            ("0.5", 2000.0),
            ("1", 1.0),
            ("1000", 1000.0),
        ] {
            assert!((units(scale) - expected).abs() < 1e-9, "{scale}: {}", units(scale));
        }
    }
}
