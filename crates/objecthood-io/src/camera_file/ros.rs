//! Cameras of ROS, as JSON or YAML: the message `CameraInfo` with `K` (ROS 1) or `k` (ROS 2), as `rostopic echo` prints it, and the
//! files of its calibration with `camera_matrix`, as OpenCV writes it too. Distortion is ignored: images are to be rectified.

use super::CameraFile;
use super::fields::{Fields, depth_scale, matrix, optional, size};
use crate::error::Result;
use crate::organize::GridCamera;

/// Reads fields of this kind; `None`: they are of another.
///
/// # Errors
/// A number is missing or wrong.
pub(super) fn read(fields: &Fields) -> Option<Result<CameraFile>> {
    let (name, value) = match optional(fields, &["K", "k", "camera_matrix"]) {
        Ok(found) => found?,
        Err(error) => return Some(Err(error)),
    };
    let value = value.get("data").unwrap_or(value);
    Some(matrix(name, value).and_then(|camera| {
        let camera = GridCamera { camera, size: size(fields)? };
        Ok(CameraFile { camera, depth_scale: depth_scale(fields)? })
    }))
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use objecthood::Camera;

    #[test]
    fn messages_and_calibrations_are_read() {
        let camera = Camera::new(525.0, 526.5, 319.5, 239.5).unwrap();
        let camera = GridCamera { camera, size: Some((640, 480)) };
        let ros1 = "header: \n  seq: 7\n  frame_id: \"camera\"\nheight: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n\
                    D: [0.0, 0.0]\nK: [525.0, 0.0, 319.5, 0.0, 526.5, 239.5, 0.0, 0.0, 1.0]\nR: [1.0, 0.0]\n---\nheader: \n";
        let ros2 = "header:\n  stamp:\n    sec: 1\n    nanosec: 2\n  frame_id: c\nheight: 480\nwidth: 640\nd:\n- 0.0\n\
                    k:\n- 525.0\n- 0.0\n- 319.5\n- 0.0\n- 526.5\n- 239.5\n- 0.0\n- 0.0\n- 1.0\np:\n- 1.0\n---\n";
        let calibration = "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                           data: [525, 0, 319.5, 0, 526.5, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n";
        let opencv = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
                      dt: d\n   data: [ 525., 0., 3.195e+02, 0., 5.265e+02, 239.5, 0.,\n       0., 1. ]\n";
        let json = r#"{"width": 640, "height": 480, "K": [525, 0, 319.5, 0, 526.5, 239.5, 0, 0, 1]}"#;
        for text in [ros1, ros2, calibration, opencv, json] {
            let file = parse(text.as_bytes()).map_err(|error| panic!("{text}: {error}")).unwrap();
            assert_eq!(file, CameraFile { camera, depth_scale: None }, "{text}");
        }
    }
}
