//! Cameras of Open3D: `{"intrinsic_matrix": [525, 0, 0, 0, 525, 0, 319.5, 239.5, 1], "width": 640, "height": 480}`, column by column.
//! In its `PinholeCameraParameters` the same stands in `intrinsic`. `depth_scale` is the units of a metre.

use super::CameraFile;
use super::fields::{Fields, depth_scale, matrix, size};
use crate::error::Result;
use crate::organize::GridCamera;

/// Reads fields of this kind; `None`: they are of another.
///
/// # Errors
/// A number is missing or wrong.
pub(super) fn read(fields: &Fields) -> Option<Result<CameraFile>> {
    let inner = fields.get("intrinsic").and_then(|inner| inner.as_object()).unwrap_or(fields);
    let name = "intrinsic_matrix";
    let value = inner.get(name)?;
    Some(matrix(name, value).and_then(|camera| {
        let camera = GridCamera { camera, size: size(inner)? };
        Ok(CameraFile { camera, depth_scale: depth_scale(fields)? })
    }))
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use objecthood::Camera;

    #[test]
    fn both_files_are_read() {
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        let camera = GridCamera { camera, size: Some((640, 480)) };
        // As Open3D 0.19 writes them.
        let intrinsic = r#"{
            "height" : 480,
            "intrinsic_matrix" :
            [525.0, 0.0, 0.0, 0.0, 526.5, 0.0, 319.5, 239.5, 1.0],
            "width" : 640
        }"#;
        let expected = CameraFile { camera, depth_scale: None };
        assert_eq!(parse(intrinsic.as_bytes()).unwrap(), expected);
        let parameters = format!(
            r#"{{"class_name": "PinholeCameraParameters", "extrinsic": [1.0, 0.0], "intrinsic": {intrinsic}}}"#
        );
        assert_eq!(parse(parameters.as_bytes()).unwrap(), expected);
        let by_rows =
            br#"{"intrinsic_matrix": [[525, 0, 319.5], [0, 526.5, 239.5], [0, 0, 1]], "depth_scale": 1000}"#;
        let by_rows = parse(by_rows).unwrap();
        assert_eq!((by_rows.camera.camera, by_rows.depth_scale), (camera.camera, Some(1000.0)));
    }
}
