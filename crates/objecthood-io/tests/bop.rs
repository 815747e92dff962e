//! Folders in the layout of the BOP benchmark, made as its documentation describes them.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::path::Path;

use image::{ImageBuffer, Luma, Rgb};
use objecthood_io::{Given, GridCamera, Source};

/// Images 3 and 12 of 4 x 3 pixels, with cameras and units of their own; the second is grey.
fn folder(cameras: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for part in ["depth", "rgb", "gray"] {
        std::fs::create_dir(folder.path().join(part)).unwrap();
    }
    for (name, raw) in [("000003", 1500_u16), ("000012", 20_000)] {
        let depth = ImageBuffer::from_pixel(4, 3, Luma([raw]));
        depth.save(folder.path().join(format!("depth/{name}.png"))).unwrap();
    }
    ImageBuffer::from_pixel(4, 3, Rgb([9_u8, 8, 7])).save(folder.path().join("rgb/000003.png")).unwrap();
    ImageBuffer::from_pixel(4, 3, Luma([6_u8])).save(folder.path().join("gray/000012.png")).unwrap();
    std::fs::write(folder.path().join("scene_camera.json"), cameras).unwrap();
    folder
}

const CAMERAS: &str = r#"{"12": {"cam_K": [8, 0, 1.5, 0, 8, 1, 0, 0, 1], "depth_scale": 0.1, "view_level": 2},
    "3": {"cam_K": [4, 0, 1.5, 0, 4, 1, 0, 0, 1], "depth_scale": 1.0, "cam_R_w2c": [1, 0, 0, 0, 1, 0, 0, 0, 1]}}"#;

#[test]
fn each_image_has_its_own_camera_and_unit() {
    let folder = folder(CAMERAS);
    let source = Source::open(folder.path(), &Given::default()).unwrap();
    assert_eq!(source.frame_count(), Some(2));
    assert_eq!(source.shared_files(), [folder.path().join("scene_camera.json")]);
    let captures: Vec<_> = source.captures().map(Result::unwrap).collect();
    for (capture, (name, fx_px, depth_m, color)) in
        captures.iter().zip([("000003", 4.0, 1.5, [9, 8, 7]), ("000012", 8.0, 2.0, [6; 3])])
    {
        assert_eq!((capture.name.to_str(), capture.frame.camera().fx_px), (Some(name), fx_px));
        assert_eq!((capture.frame.depth_m()[0], capture.frame.color().unwrap()[0]), (depth_m, color));
    }
    let camera: GridCamera = "5,5,1.5,1".parse().unwrap();
    let given = Given { camera: Some(camera), depth_scale: Some(500.0), ..Given::default() };
    let capture = objecthood_io::open_frame(folder.path(), &given).unwrap();
    assert_eq!((capture.frame.camera(), capture.frame.depth_m()[0]), (camera.camera, 3.0));
}

#[test]
fn what_is_wrong_is_told_with_its_file() {
    let said = |folder: &Path| match Source::open(folder, &Given::default()) {
        Err(error) => error.to_string(),
        Ok(source) => source.captures().find_map(|capture| capture.err()).unwrap().to_string(),
    };
    for (cameras, message) in [
        ("{", "it is cut short"),
        ("[1]", "it does not list the cameras of images by their numbers"),
        (r#"{"a": {"cam_K": [1, 0, 0, 0, 1, 0, 0, 0, 1]}}"#, "`a` is not the number of an image"),
        (r#"{"1": {"cam_K": [1, 0]}}"#, "cam_K"),
        (r#"{"1": 5}"#, "it does not list the cameras"),
        ("{}", "no point cloud"),
        (r#"{"77": {"cam_K": [4, 0, 1.5, 0, 4, 1, 0, 0, 1]}}"#, "depth/000077.png: cannot be read"),
    ] {
        let folder = folder(cameras);
        let said = said(folder.path());
        assert!(said.contains(message) && !said.contains('\n'), "{said}");
    }
}
