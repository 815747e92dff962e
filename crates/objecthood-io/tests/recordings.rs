//! Recordings of other programs are read to the images that went in. Needs a Python in `OBJECTHOOD_PYTHON`, with the packages of
//! `xtask/requirements.txt`; without it, and without the real data, it says that it skips.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::{Path, PathBuf};

use common::data_folder;
use common::written::{WIDTH, bits, expected, scene, written};
use objecthood::{Params, Pipeline};
use objecthood_io::doctor::{Cause, Examination};
use objecthood_io::{Capture, Given, GridCamera, Selection, Source};

fn source(path: &Path) -> Source {
    Source::open(path, &Given::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn captures(path: &Path) -> Vec<Capture> {
    source(path).captures().map(|capture| capture.unwrap_or_else(|e| panic!("{e}"))).collect()
}

#[test]
fn every_container_and_encoding_gives_the_same_frames() {
    let Some(folder) = written("recordings.py") else { return };
    let color = scene().1;
    for name in [
        "raw_mcap",
        "raw_db3",
        "compressed_mcap",
        "compressed_db3",
        "points_mcap",
        "points_db3",
        "plain.mcap",
        "lz4.mcap",
        "zstd.mcap",
        "unchunked.mcap",
        "rvl.mcap",
        "floats.mcap",
        "plain.bag",
        "bz2.bag",
        "lz4.bag",
        "compressed.bag",
    ] {
        let path = folder.path().join(name);
        let opened = source(&path);
        assert!(opened.notices().is_empty(), "{name}: {:?}", opened.notices());
        assert_eq!(opened.frame_count(), Some(5), "{name}");
        let cameras = opened.topics().iter().filter(|topic| topic.kind == "sensor_msgs/CameraInfo");
        assert!(cameras.clone().all(|topic| topic.messages == 5), "{name}: {:?}", opened.topics());
        let captures = captures(&path);
        for (k, capture) in captures.iter().enumerate() {
            assert_eq!(bits(capture), expected(), "{name} {k}");
            assert_eq!(capture.frame.color().unwrap().as_slice(), color, "{name} {k}");
            assert_eq!(capture.stamp_ns, Some(1_700_000_000_000_000_000 + k as i64 * 50_000_000), "{name}");
            let camera = capture.frame.camera();
            assert!(
                (camera.fx_px - 80.0).abs() < 1e-3 && (camera.cy_px - 29.5).abs() < 1e-3,
                "{name}: {camera:?}"
            );
            assert!(capture.name.to_str().unwrap().ends_with(&format!("-{k:06}")));
        }
    }
    let selection = Selection { frames: None, time: Some("0.1..0.2".parse().unwrap()) };
    let selected = source(&folder.path().join("zstd.mcap")).select(&selection);
    assert_eq!(selected.map(|frame| frame.unwrap().number()).collect::<Vec<_>>(), [2, 3]);
}

#[test]
fn what_is_given_comes_first_and_what_is_wrong_is_told() {
    let Some(folder) = written("recordings.py") else { return };
    let path = folder.path().join("plain.mcap");
    let topics =
        |topics: &[&str]| Given { topics: topics.iter().map(|&t| t.into()).collect(), ..Given::default() };
    let message = Source::open(&path, &topics(&["/nothing"])).unwrap_err().to_string();
    assert!(
        message.contains("no topic `/nothing`; it has /camera/color/camera_info (sensor_msgs/CameraInfo)"),
        "{message}"
    );
    let message = Source::open(&path, &topics(&["/camera/color/camera_info"])).unwrap_err().to_string();
    assert!(message.contains("hold no depth and no points"), "{message}");
    assert!(Source::open(&path, &topics(&["/camera/depth/image_raw"])).is_ok());
    let camera: GridCamera = "90,90,40,30".parse().unwrap();
    let given = Given { camera: Some(camera), depth_scale: Some(500.0), ..Given::default() };
    let capture = objecthood_io::open_frame(&path, &given).unwrap();
    assert_eq!((capture.frame.camera(), capture.frame.depth_m()[79]), (camera.camera, 2.316));
    assert_eq!(capture.said.depth_scale, Some(1000.0));
}

/// A colour camera 0.1 m to the right with twice the pixels.
#[test]
fn colour_of_another_camera_is_looked_up() {
    let Some(folder) = written("recordings.py") else { return };
    let capture = &captures(&folder.path().join("apart.mcap"))[0];
    assert_eq!(bits(capture), expected());
    let (depth, color) = scene();
    for (u, v) in [(40, 30), (60, 10), (70, 50), (35, 25)] {
        let z_m = f64::from(depth[v * WIDTH + u]) / 1000.0;
        // The point is 0.1 m farther left for it. Its pixels are half as wide, in pairs of one colour.
        let other = 160.0 * ((u as f64 - 39.5) / 80.0 - 0.1 / z_m) + 79.5;
        let row = 160.0 * ((v as f64 - 29.5) / 80.0) + 59.5;
        let from = (row.round() as usize / 2) * WIDTH + other.round() as usize / 2;
        assert_eq!(capture.frame.color().unwrap()[v * WIDTH + u], color[from], "{u} {v}");
    }
    assert_eq!(capture.pose.unwrap().up().map(|part| part.round()), [0.0, -1.0, 0.0], "base_link is upright");
    let far = source(&folder.path().join("far.mcap"));
    let said: Vec<String> = far.notices().iter().map(ToString::to_string).collect();
    assert!(said.len() == 1 && said[0].contains("its colour is left out: it is not registered"), "{said:?}");
    let capture = far.captures().next().unwrap().unwrap();
    assert!(capture.frame.color().is_none() && bits(&capture) == expected());
}

/// The pixel of a rectified image is where `plumb_bob` of OpenCV bends its direction to.
#[test]
fn distortion_is_undone() {
    let Some(folder) = written("recordings.py") else { return };
    let capture = &captures(&folder.path().join("bent.mcap"))[0];
    let depth = scene().0;
    for (u, v) in [(0, 30), (79, 59), (20, 50), (60, 5)] {
        let (x, y) = ((u as f64 - 39.5) / 80.0, (v as f64 - 29.5) / 80.0);
        let r2 = x * x + y * y;
        let radial = 1.0 - 0.2 * r2 + 0.05 * r2 * r2;
        let (from_x, from_y) = (x * radial + 2.0 * 0.01 * x * y, y * radial + 0.01 * (r2 + 2.0 * y * y));
        let (u0, v0) = ((80.0 * from_x + 39.5).round() as usize, (80.0 * from_y + 29.5).round() as usize);
        let expected = (f64::from(depth[v0 * WIDTH + u0]) / 1000.0) as f32;
        assert_eq!(capture.frame.depth_m()[v * WIDTH + u], expected, "{u} {v}");
    }
}

/// Doctor says that the distortion is left as it is when another camera is given, and only then.
#[test]
fn distortion_that_is_not_undone_is_doubted() {
    let Some(folder) = written("recordings.py") else { return };
    let doubts = |camera: Option<GridCamera>| {
        let given = Given { camera, ..Given::default() };
        let capture = objecthood_io::open_frame(&folder.path().join("bent.mcap"), &given).unwrap();
        // The pixel in the corner is 49 px from the middle, r = 0.62: bent by 7 % of that.
        let bent_px = capture.said.distortion_px.unwrap();
        assert!((3.0..6.0).contains(&bent_px), "{bent_px}");
        let mut examination = Examination::default();
        let found = Pipeline::default().discover(&capture.frame, &Params::default()).unwrap().clone();
        examination.look(&capture, &found);
        let findings = examination.report(&[], &[]).findings;
        findings.iter().filter(|finding| finding.cause == Cause::Distortion).count()
    };
    assert_eq!(doubts(None), 0);
    assert_eq!(doubts(Some("82,82,39.5,29.5".parse().unwrap())), 1);
}

/// Recordings of other programs, which lie in the data folder.
#[test]
fn real_recordings_are_read() {
    let Some(data) = data_folder() else { return };
    let path = |name: &str| -> PathBuf { data.join("containers").join(name) };
    for name in ["ros2_mcap", "ros2_mcap/ros2_mcap.mcap"] {
        let source = source(&path(name));
        assert!(source.notices().is_empty(), "{:?}", source.notices());
        assert_eq!(source.frame_count(), Some(30));
        let capture = source.captures().nth(7).unwrap().unwrap();
        assert_eq!((capture.frame.size(), capture.frame.camera().fx_px), ((320, 240), 275.0));
        let video = objecthood_io::Source::open(&data.join("video/hand-plush"), &Given::default()).unwrap();
        assert!(video.frame_count().unwrap() >= 30 && capture.frame.color().is_some());
    }
    for name in ["realsense-softdevice.db3", "realsense-softdevice.bag"] {
        let source = source(&path(name));
        assert!(source.notices().is_empty(), "{:?}", source.notices());
        assert_eq!(source.frame_count(), Some(8), "{name}");
        for capture in source.captures() {
            let capture = capture.unwrap();
            assert_eq!((capture.frame.size(), capture.frame.camera().fx_px), ((640, 480), 525.0));
            assert_eq!(capture.said.depth_scale, Some(1000.0), "{name}");
            assert!(capture.frame.color().is_some() && capture.frame.depth_m()[0] == 1.5, "{name}");
        }
    }
}
