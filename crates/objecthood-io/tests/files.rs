//! Clouds, arrays and images of other programs are read to the depth that went in: plyfile, NumPy, `OpenEXR`, tifffile, Pillow. Needs a Python in
//! `OBJECTHOOD_PYTHON`, with the packages of `xtask/requirements.txt`; without it, it says that it skips.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::Path;

use common::written::{HEIGHT, WIDTH, bits, expected, scene, written};
use objecthood_io::images::decode_images;
use objecthood_io::{Capture, Given, Result, open_frame};

fn camera() -> Given {
    Given { camera: Some("80,80,39.5,29.5,80,60".parse().unwrap()), ..Given::default() }
}

fn millimetres() -> Given {
    Given { depth_scale: Some(1000.0), ..Given::default() }
}

/// Depth and colour of the scene, and no other.
fn assert_scene(capture: &Capture, has_color: bool, what: &str) {
    assert_eq!(capture.frame.size(), (WIDTH, HEIGHT), "{what}");
    assert!(bits(capture) == expected(), "{what}: the depth is another");
    let colors = capture.frame.color().map(|color| color.as_slice().to_vec());
    let is_seen = |k: usize| capture.frame.depth_m()[k] > 0.0;
    assert_eq!(colors.is_some(), has_color, "{what}");
    for (k, color) in colors.iter().flatten().enumerate().filter(|&(k, _)| is_seen(k)) {
        assert_eq!(*color, scene().1[k], "{what} {k}");
    }
}

fn image(folder: &Path, name: &str, given: &Given) -> Result<Capture> {
    decode_images(None, &std::fs::read(folder.join(name)).unwrap(), given)
}

#[test]
fn what_other_programs_wrote_is_read_and_what_is_broken_told() {
    let Some(folder) = written("files.py") else { return };
    let folder = folder.path();
    clouds(folder);
    arrays(folder);
    images(folder);
}

fn clouds(folder: &Path) {
    for name in ["text.ply", "little.ply", "big.ply", "list.npy"] {
        let capture = open_frame(&folder.join(name), &camera()).unwrap();
        assert_scene(&capture, true, name);
        // Without a camera: a virtual one, and an answer for every point.
        let capture = open_frame(&folder.join(name), &Given::default()).unwrap();
        let list = capture.list.unwrap();
        assert!(list.is_virtual && list.seen > list.points_m.len() * 9 / 10, "{name}: {}", list.seen);
        assert_eq!(list.points_m.len(), WIDTH * HEIGHT - 25);
    }
    for (name, has_color) in [("grid.npy", false), ("colored.npy", true), ("points.npz", true)] {
        let capture = open_frame(&folder.join(name), &Given::default()).unwrap();
        assert_scene(&capture, has_color, name);
        assert!((capture.frame.camera().fx_px - 80.0).abs() < 1e-3 && capture.list.is_none(), "{name}");
    }
    let capture = open_frame(&folder.join("organized.ply"), &Given::default()).unwrap();
    assert_scene(&capture, true, "organized.ply");
    assert!((capture.frame.camera().fx_px - 80.0).abs() < 1e-3 && capture.list.is_none());
}

fn arrays(folder: &Path) {
    let stored = open_frame(&folder.join("stored.npz"), &Given::default()).unwrap();
    assert_scene(&stored, true, "stored.npz");
    assert_eq!((stored.frame.camera().fx_px, stored.frame.camera().cy_px), (80.0, 29.5));
    let compressed = open_frame(&folder.join("compressed.npz"), &millimetres()).unwrap();
    assert_scene(&compressed, true, "compressed.npz");
    assert_scene(&open_frame(&folder.join("no-camera.npz"), &camera()).unwrap(), false, "no-camera.npz");
    assert_scene(&image(folder, "metres.npy", &camera()).unwrap(), false, "metres.npy");
    let known = Given { depth_scale: Some(1000.0), ..camera() };
    assert_scene(&image(folder, "depth.npy", &known).unwrap(), false, "depth.npy");
    for (said, error) in [
        ("unit of integer depth is not known", open_frame(&folder.join("compressed.npz"), &Given::default())),
        ("do not say which camera", open_frame(&folder.join("no-camera.npz"), &Given::default())),
        ("no array `depth` or `points`", open_frame(&folder.join("no-depth.npz"), &Given::default())),
        ("give a depth image with --depth", open_frame(&folder.join("depth.npy"), &known)),
        ("are whole numbers", open_frame(&folder.join("whole.npy"), &known)),
        ("column by column", image(folder, "columns.npy", &known)),
        ("an array of 3 sides", image(folder, "color.npy", &known)),
    ] {
        let message = error.unwrap_err().to_string();
        assert!(message.contains(said), "expected `{said}`: {message}");
    }
}

fn images(folder: &Path) {
    for name in ["zip.exr", "piz.exr", "rle.exr", "none.exr", "grey.exr", "metres.tif", "strips.tif"] {
        assert_scene(&image(folder, name, &camera()).unwrap(), false, name);
    }
    let known = Given { depth_scale: Some(1000.0), ..camera() };
    for name in ["depth.png", "packed.tif", "depth.tif", "tiles.tif", "big-endian.tif"] {
        assert_scene(&image(folder, name, &known).unwrap(), false, name);
    }
    for name in ["color.png", "color.tif"] {
        let [color, depth] = [name, "depth.png"].map(|name| std::fs::read(folder.join(name)).unwrap());
        assert_scene(&decode_images(Some(&color), &depth, &known).unwrap(), true, name);
    }
    let message = image(folder, "color.exr", &camera()).unwrap_err().to_string();
    assert!(message.contains("a depth image has one channel but this one has 3"), "{message}");
}
