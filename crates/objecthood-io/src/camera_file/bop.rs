//! Cameras of BOP data sets: `{"cam_K": [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1], "depth_scale": 0.1}`, or `scene_camera.json`, which has
//! such fields for each image. `depth_scale` is the millimetres of a unit, where ours is the units of a metre.

use std::collections::BTreeMap;

use serde_json::Value;

use super::fields::{Fields, depth_scale, matrix, size};
use super::{CameraFile, wrong};
use crate::error::Result;
use crate::organize::GridCamera;

/// Reads fields of this kind; `None`: they are of another.
///
/// # Errors
/// A number is missing or wrong, or the images have different cameras.
pub(super) fn read(fields: &Fields) -> Option<Result<CameraFile>> {
    if fields.contains_key("cam_K") {
        return Some(one(fields));
    }
    let mut images =
        fields.values().map(|image| image.as_object().filter(|image| image.contains_key("cam_K")));
    let first = images.next()??;
    Some(one(first).and_then(|camera| {
        for image in images {
            if image.map(one).transpose()? != Some(camera) {
                return Err(wrong(
                    "its images have different cameras, so none is that of all: write a file with one",
                ));
            }
        }
        Ok(camera)
    }))
}

/// The camera of each image of a `scene_camera.json`, by its number.
///
/// # Errors
/// A number is missing or wrong.
pub(super) fn images(fields: &Fields) -> Result<BTreeMap<u64, CameraFile>> {
    let image = |(name, image): (&String, &Value)| {
        let number = name.parse().map_err(|_| wrong(format!("`{name}` is not the number of an image")))?;
        let image = image.as_object().ok_or_else(|| wrong(NO_LIST))?;
        Ok((number, one(image)?))
    };
    fields.iter().map(image).collect()
}

/// What is wrong with a file of another kind.
pub(super) const NO_LIST: &str = "it does not list the cameras of images by their numbers";

fn one(fields: &Fields) -> Result<CameraFile> {
    let camera = GridCamera {
        camera: matrix("cam_K", fields.get("cam_K").unwrap_or(&Value::Null))?,
        size: size(fields)?,
    };
    Ok(CameraFile { camera, depth_scale: depth_scale(fields)?.map(|mm| 1000.0 / mm) })
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use objecthood::Camera;

    #[test]
    fn one_camera_is_read_and_two_are_refused() {
        let camera = GridCamera { camera: Camera::new(1066.0, 1067.0, 312.0, 241.0).unwrap(), size: None };
        let expected = CameraFile { camera, depth_scale: Some(10_000.0) };
        let image =
            r#"{"cam_K": [1066, 0, 312, 0, 1067, 241, 0, 0, 1], "cam_R_w2c": [1, 0], "depth_scale": 0.1}"#;
        assert_eq!(parse(image.as_bytes()).unwrap(), expected);
        assert_eq!(parse(format!(r#"{{"1": {image}, "2": {image}}}"#).as_bytes()).unwrap(), expected);
        let other = image.replace("1066", "1000");
        let error = parse(format!(r#"{{"1": {image}, "2": {other}}}"#).as_bytes()).unwrap_err().to_string();
        assert!(error.contains("different cameras"), "{error}");
    }
}
