//! The real recordings: mOSD learn and the stills of the Point Cloud Library.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::path::{Path, PathBuf};

use common::{data_folder, decode, open};
use objecthood::{Frame, Raster};
use objecthood_io::formats::pcd;
use objecthood_io::organize::organize;
use objecthood_io::{Capture, Given, GridCamera, PointCloud};

fn learn_scenes(data: &Path) -> Vec<PathBuf> {
    (0..45).map(|k| data.join(format!("mosd/learn/learn{k}.pcd"))).collect()
}

fn kinect() -> GridCamera {
    "525,525,319.5,239.5".parse().unwrap()
}

#[test]
fn every_learn_scene_tells_its_camera() {
    let Some(data) = data_folder() else { return };
    let mut worst = 0.0_f64;
    for path in learn_scenes(&data) {
        let Capture { frame, truth, camera_fit, turned, .. } = open(&path, None).unwrap();
        let fit = camera_fit.unwrap();
        assert_eq!(frame.size(), (640, 480));
        assert!(frame.color().is_some() && !turned);
        let camera = fit.camera;
        for (found, known) in
            [(camera.fx_px, 525.0), (camera.fy_px, 525.0), (camera.cx_px, 319.5), (camera.cy_px, 239.5)]
        {
            worst = worst.max((found - known).abs());
        }
        assert!(fit.residual_px < 1e-4, "{}: {fit:?}", path.display());
        assert_eq!(fit.points, (0..frame.depth_m().len()).filter(|&i| frame.is_valid(i)).count());

        // In learn, label 0 says that there is no depth.
        let truth = truth.unwrap();
        assert!((0..truth.len()).all(|i| (truth[i] != 0) == frame.is_valid(i)), "{}", path.display());
    }
    println!("cameras of learn: at most {worst:.1e} px from 525 525 319.5 239.5");
    assert!(worst < 2e-5, "{worst}");
}

/// The same depth, bit by bit, and the same labels; the same colour where there is depth.
fn assert_same(grid: &Capture, again: &Capture) {
    let bits = |frame: &Frame| frame.depth_m().map(|z| z.to_bits());
    assert_eq!(bits(&again.frame), bits(&grid.frame));
    assert_eq!(again.truth, grid.truth);
    let seen = |capture: &Capture| -> Raster<[u8; 3]> {
        let color = capture.frame.color().unwrap();
        let seen = (0..color.len()).map(|i| if capture.frame.is_valid(i) { color[i] } else { [0; 3] });
        Raster::from_vec(color.width(), color.height(), seen.collect()).unwrap()
    };
    assert_eq!(seen(again), seen(grid));
}

#[test]
fn flattened_scenes_come_back_to_their_grid() {
    let Some(data) = data_folder() else { return };
    for path in learn_scenes(&data) {
        let file = std::fs::read(&path).unwrap();
        let grid = decode(&file, None).unwrap();

        // The same file, said to be a list.
        let size = b"WIDTH 640\nHEIGHT 480\n";
        let at = file.windows(size.len()).position(|window| window == size).unwrap();
        let list = [&file[..at], b"WIDTH 307200\nHEIGHT 1\n", &file[at + size.len()..]].concat();
        // Without a camera, the pixels are found again from the points.
        let again = decode(&list, None).unwrap();
        let (grid_camera, camera) = (grid.frame.camera(), again.frame.camera());
        assert!((camera.fx_px - grid_camera.fx_px).abs() < 1e-2, "{camera:?}");
        assert_eq!(again.frame.measured_px(), grid.frame.measured_px());
        assert_same(&grid, &decode(&list, Some(&kinect())).unwrap());

        // The list without the missing points.
        let cloud = pcd::parse(&list).unwrap();
        let kept: Vec<usize> = (0..cloud.width).filter(|&i| grid.frame.is_valid(i)).collect();
        let (color, label) = (cloud.color.unwrap(), cloud.label.unwrap());
        let short = PointCloud {
            width: kept.len(),
            height: 1,
            points_m: kept.iter().map(|&i| cloud.points_m[i]).collect(),
            color: Some(kept.iter().map(|&i| color[i]).collect()),
            label: Some(kept.iter().map(|&i| label[i]).collect()),
            viewpoint: None,
        };
        assert!(short.width < 307_200);
        assert_same(
            &grid,
            &organize(short, &Given { camera: Some(kinect()), max_pixels: 640 * 480, ..Given::default() })
                .unwrap(),
        );
    }
}

#[test]
fn an_uncropped_room_tells_a_sensible_camera() {
    let Some(data) = data_folder() else { return };
    let capture = open(&data.join("stills/milk_cartoon_all_small_clorox.pcd"), None).unwrap();
    let fit = capture.camera_fit.unwrap();
    println!("camera of milk_cartoon: {fit:?}");
    let camera = fit.camera;
    assert!((camera.fx_px - 525.0).abs() < 1.0 && (camera.fy_px - 525.0).abs() < 1.0, "{fit:?}");
    assert!((camera.cx_px - 319.5).abs() < 1.0 && (camera.cy_px - 239.5).abs() < 1.0, "{fit:?}");
    assert!(fit.residual_px < 0.01, "{fit:?}");
    assert!(capture.truth.is_none() && capture.frame.color().is_some());
}
