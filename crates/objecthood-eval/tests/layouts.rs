//! Data sets in their published layouts, as made folders: OSD, OCID and BOP with masks.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::fs;
use std::path::Path;

use objecthood::Raster;
use objecthood_eval::{Error, Scene, SceneRef, Split, scenes};
use objecthood_io::label_image;

const SIZE: (usize, usize) = (8, 6);

fn write(root: &Path, name: &str, bytes: &[u8]) {
    let path = root.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// A label image, from the label of each column.
fn columns(labels: [u16; 8]) -> Vec<u8> {
    let labels = (0..SIZE.0 * SIZE.1).map(|i| labels[i % SIZE.0]).collect();
    label_image::encode(&Raster::from_vec(SIZE.0, SIZE.1, labels).unwrap()).unwrap()
}

/// A depth image (mm), 1 m everywhere but in the first column.
fn depth() -> Vec<u8> {
    columns([0, 1000, 1000, 1000, 1000, 1000, 1000, 1000])
}

/// The same as an organized cloud.
fn cloud() -> Vec<u8> {
    let camera = objecthood::Camera::new(10.0, 10.0, 3.5, 2.5).unwrap();
    let points = (0..SIZE.0 * SIZE.1).map(|i| {
        let [x, y, z] =
            camera.back_project(i % SIZE.0, i / SIZE.0, if i % SIZE.0 == 0 { f32::NAN } else { 1.0 });
        format!("{x} {y} {z}\n")
    });
    let header = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 8\nHEIGHT 6\n\
        VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 48\nDATA ascii\n";
    (header.to_owned() + &points.collect::<String>()).into_bytes()
}

fn found(root: &Path, split: &str) -> Vec<SceneRef> {
    scenes(root, &split.parse::<Split>().unwrap()).unwrap()
}

/// The label of each column of the truth.
fn truth(scene: &Scene) -> Vec<u32> {
    assert_eq!(scene.truth.size(), SIZE);
    scene.truth.labels().as_slice()[..SIZE.0].to_vec()
}

#[test]
fn osd_with_clouds_and_with_depth_images() {
    for has_clouds in [true, false] {
        let root = tempfile::tempdir().unwrap();
        for name in ["learn1", "learn10", "test3"] {
            write(root.path(), &format!("annotation/{name}.png"), &columns([1, 0, 0, 3, 3, 1, 1, 0]));
            let color = image_of_grey();
            write(root.path(), &format!("image_color/{name}.png"), &color);
            if has_clouds {
                write(root.path(), &format!("pcd/{name}.pcd"), &cloud());
            } else {
                write(root.path(), &format!("disparity/{name}.png"), &depth());
            }
        }
        let names: Vec<String> = found(root.path(), "all").into_iter().map(|scene| scene.name).collect();
        assert_eq!(names, ["learn1", "learn10", "test3"]);
        assert_eq!(found(root.path(), "test").len(), 1);
        let error = scenes(root.path(), &"train".parse().unwrap()).unwrap_err().to_string();
        assert!(error.contains("the splits there are: all, learn, test"), "{error}");

        let camera = "10,10,3.5,2.5".parse().unwrap();
        let camera = (!has_clouds).then_some(&camera);
        let scene = found(root.path(), "test")[0].load(camera).unwrap();
        // 0 does not count, 1 is background, the objects follow.
        assert_eq!(truth(&scene), [0, 1, 1, 3, 3, 2, 2, 1]);
        assert!((scene.frame.camera().fx_px - 10.0).abs() < 1e-3);
        assert_eq!(scene.frame.color().is_some(), !has_clouds);
    }
}

/// An 8-bit grey image.
fn image_of_grey() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::GrayImage::from_pixel(8, 6, image::Luma([90]))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

#[test]
fn ocid_has_no_objects_in_table_and_floor() {
    let root = tempfile::tempdir().unwrap();
    for sequence in ["ARID20/table/top/seq01", "ARID20/floor/bottom/seq01", "YCB10/table/top/mixed/seq02"] {
        write(root.path(), &format!("{sequence}/rgb/result_1.png"), &image_of_grey());
        write(root.path(), &format!("{sequence}/label/result_1.png"), &columns([0, 0, 1, 2, 2, 3, 9, 9]));
        write(root.path(), &format!("{sequence}/pcd/result_1.pcd"), &cloud());
    }
    let all = found(root.path(), "all");
    let names: Vec<&str> = all.iter().map(|scene| scene.name.as_str()).collect();
    let expected = [
        "ARID20-floor-bottom-seq01-result_1",
        "ARID20-table-top-seq01-result_1",
        "YCB10-table-top-mixed-seq02-result_1",
    ];
    assert_eq!(names, expected);
    assert_eq!(truth(&all[0].load(None).unwrap()), [0, 1, 1, 2, 2, 3, 4, 4], "on the floor 2 is an object");
    assert_eq!(truth(&all[1].load(None).unwrap()), [0, 1, 1, 1, 1, 2, 3, 3]);
    assert_eq!(found(root.path(), "YCB10").len(), 1);
}

#[test]
fn bop_has_a_mask_for_each_object() {
    let root = tempfile::tempdir().unwrap();
    let scene = "test/000007";
    let camera = r#"{"cam_K": [10, 0, 3.5, 0, 10, 2.5, 0, 0, 1], "depth_scale": 1.0}"#;
    let cameras = format!(r#"{{"4": {camera}, "12": {camera}, "13": {camera}}}"#);
    write(root.path(), &format!("{scene}/scene_camera.json"), cameras.as_bytes());
    for image in ["000004", "000012", "000013"] {
        write(root.path(), &format!("{scene}/depth/{image}.png"), &depth());
    }
    write(root.path(), &format!("{scene}/mask_visib/000004_000000.png"), &columns([0, 0, 9, 9, 0, 0, 0, 0]));
    write(root.path(), &format!("{scene}/mask_visib/000012_000000.png"), &columns([9, 9, 0, 0, 0, 0, 0, 0]));
    write(root.path(), &format!("{scene}/mask_visib/000012_000001.png"), &columns([0, 0, 0, 0, 0, 9, 9, 9]));
    let all = found(root.path(), "all");
    let names: Vec<(&str, &str)> =
        all.iter().map(|scene| (scene.name.as_str(), scene.folder.as_str())).collect();
    assert_eq!(names, [("test-000007-000004", "test"), ("test-000007-000012", "test")], "13 has no truth");
    assert_eq!(truth(&all[0].load(None).unwrap()), [0, 1, 2, 2, 1, 1, 1, 1]);
    assert_eq!(truth(&all[1].load(None).unwrap()), [0, 2, 1, 1, 1, 3, 3, 3]);

    let small = label_image::encode(&Raster::from_vec(2, 2, vec![9; 4]).unwrap()).unwrap();
    write(root.path(), &format!("{scene}/mask_visib/000004_000000.png"), &small);
    let error = all[0].load(None).unwrap_err();
    assert!(matches!(error, Error::TruthSize { truth: (2, 2), .. }), "{error}");
}
