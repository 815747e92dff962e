//! Folders in the layout of the TUM benchmark, as sources.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::path::Path;

use common::data_folder;
use image::{ImageBuffer, Luma, Rgb};
use objecthood_io::{Error, FrameRef, Given, Pose, Said, Source};

const CAMERA: &str = r#"{"fx": 4, "fy": 4, "cx": 1.5, "cy": 1}"#;

/// Three pairs of 4 x 3 pixels at 1, 2 and 3 m, and poses for two of them.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| std::fs::write(folder.path().join(name), content).unwrap();
    std::fs::create_dir(folder.path().join("rgb")).unwrap();
    std::fs::create_dir(folder.path().join("depth")).unwrap();
    for k in 1..=3_u16 {
        let color = ImageBuffer::from_pixel(4, 3, Rgb([k as u8; 3]));
        color.save(folder.path().join(format!("rgb/{k}.0.png"))).unwrap();
        let depth = ImageBuffer::from_pixel(4, 3, Luma([5000 * k]));
        depth.save(folder.path().join(format!("depth/{k}.01.png"))).unwrap();
    }
    write("rgb.txt", "1.0 rgb/1.0.png\n2.0 rgb/2.0.png\n3.0 rgb/3.0.png\n");
    write("depth.txt", "1.01 depth/1.01.png\n2.01 depth/2.01.png\n3.01 depth/3.01.png\n");
    write("groundtruth.txt", "1.01 1 2 3 0 0 0 1\n2.005 4 5 6 0 1 0 0\n3.04 7 8 9 0 0 0 1\n");
    write("camera.json", CAMERA);
    folder
}

fn open(folder: &Path, given: &Given) -> Result<Vec<FrameRef>, Error> {
    Source::open(folder, given)?.collect()
}

#[test]
fn a_frame_has_name_stamp_pose_and_what_its_folder_says() {
    let folder = folder();
    let source = Source::open(folder.path(), &Given::default()).unwrap();
    assert_eq!(source.frame_count(), Some(3));
    assert_eq!(source.shared_files(), [folder.path().join("camera.json")]);
    assert!(source.notices().is_empty());
    let camera = "4,4,1.5,1".parse().unwrap();
    let poses =
        [Some(([1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0])), Some(([4.0, 5.0, 6.0], [0.0, 1.0, 0.0, 0.0])), None];
    for (k, (frame, pose)) in source.zip(poses).enumerate() {
        let frame = frame.unwrap();
        assert!(!frame.is_metric());
        let [color, depth] = [format!("rgb/{}.0.png", k + 1), format!("depth/{}.01.png", k + 1)];
        let files: Vec<_> = frame.files().map(|file| file.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(files, [Path::new(&color), Path::new(&depth)]);

        let capture = frame.read().unwrap();
        assert_eq!(capture.name, *format!("{}.01", k + 1));
        assert_eq!(capture.stamp_ns, Some(1_000_000_000 * (k as i64 + 1) + 10_000_000));
        let pose = pose.map(|(position_m, rotation_xyzw)| Pose { position_m, rotation_xyzw });
        assert_eq!(capture.pose, pose);
        assert_eq!(capture.said, Said { camera: Some(camera), depth_scale: Some(5000.0), ..Said::default() });
        assert_eq!(capture.frame.depth_m()[0], k as f32 + 1.0);
        assert_eq!(capture.frame.color().unwrap()[0], [k as u8 + 1; 3]);
    }
}

#[test]
fn what_is_given_comes_before_what_the_folder_says() {
    let folder = folder();
    let depth_m = |given: &Given| {
        let capture = open(folder.path(), given).unwrap()[0].read().unwrap();
        (capture.frame.depth_m()[0], capture.frame.camera().fx_px, capture.said.depth_scale)
    };
    assert_eq!(depth_m(&Given::default()), (1.0, 4.0, Some(5000.0)));
    let camera = Some("8,8,1.5,1".parse().unwrap());
    let given = Given { camera, depth_scale: Some(1000.0), ..Given::default() };
    assert_eq!(depth_m(&given), (5.0, 8.0, Some(5000.0)));
    let own_scale = CAMERA.replace('}', r#", "depth_scale": 2500}"#);
    std::fs::write(folder.path().join("camera.json"), own_scale).unwrap();
    assert_eq!(depth_m(&Given::default()), (2.0, 4.0, Some(2500.0)));
    std::fs::remove_file(folder.path().join("camera.json")).unwrap();
    assert_eq!(depth_m(&Given { camera, ..Given::default() }), (1.0, 8.0, Some(5000.0)));
    let error = open(folder.path(), &Given::default()).unwrap_err();
    assert!(matches!(error, Error::At { error, .. } if matches!(*error, Error::NoCameraFile { .. })));
}

#[test]
fn an_image_that_is_not_there_is_said_when_it_is_read() {
    let folder = folder();
    std::fs::remove_file(folder.path().join("rgb/2.0.png")).unwrap();
    let frames = open(folder.path(), &Given::default()).unwrap();
    assert!(frames[0].read().is_ok() && frames[2].read().is_ok());
    let message = frames[1].read().unwrap_err().to_string();
    assert!(message.contains("rgb/2.0.png: cannot be read"), "{message}");
}

#[test]
fn every_frame_of_a_recording_has_its_pose() {
    let Some(data) = data_folder() else { return };
    let frames = open(&data.join("video/tum-fr1-rpy"), &Given::default()).unwrap();
    assert_eq!(frames.len(), 20);
    assert!(frames.is_sorted_by_key(FrameRef::stamp_ns));
    for frame in [&frames[0], &frames[19]] {
        let pose = frame.read().unwrap().pose.unwrap();
        assert!(pose.position_m.iter().all(|x| x.abs() < 5.0), "{pose:?}");
    }
    // The camera turns: between the first and the last frame by degrees, not by radians.
    let [a, b] = [&frames[0], &frames[19]].map(|frame| frame.read().unwrap().pose.unwrap().rotation_xyzw);
    let cosine_of_half = a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>().abs();
    assert!(cosine_of_half > 0.9 && cosine_of_half < 0.9999, "{cosine_of_half}");
}
