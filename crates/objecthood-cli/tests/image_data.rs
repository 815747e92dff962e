//! One line for every set of images that people have.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::PathBuf;

use common::{Folder, command, workspace};

/// The folder of a set, if it is there; else says that the test is skipped.
fn data(set: &str) -> Option<PathBuf> {
    let data =
        std::env::var_os("OBJECTHOOD_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    let folder = data.join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no {set} in the data folder, which OBJECTHOOD_DATA names");
    None
}

/// Runs in the folder of a set and expects so many frames, each with objects and none with an error.
#[track_caller]
fn runs(set: &str, arguments: &str, frames: usize) -> Option<Vec<String>> {
    let (from, to) = (data(set)?, Folder::new());
    let output = command()
        .current_dir(from)
        .args(["segment", "--write", "labels,json,panels", "--out"])
        .arg(to.path().join("out"))
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{stderr}");
    assert!(stderr.ends_with(&format!("{frames} of {frames} frames done\n")), "{stderr}");
    let names = to.names("out");
    assert_eq!(names.len(), 3 * frames);
    for (name, bytes) in to.files("out").iter().filter(|(name, _)| name.ends_with(".json")) {
        let scene: serde_json::Value = serde_json::from_slice(bytes).unwrap();
        assert!(!scene["objects"].as_array().unwrap().is_empty(), "{name}");
    }
    Some(names)
}

#[test]
fn tabletop_clutter() {
    let arguments = "--color . --depth . --camera camera_params.json --depth-scale 1000";
    let Some(names) = runs("stills/tabletop-clutter", arguments, 9) else { return };
    assert_eq!(names[..3], ["000000.json", "000000.labels.png", "000000.panels.png"]);
}

#[test]
fn ycb_video() {
    let arguments = "--color *-color.png --depth *-depth.png --camera 1066.78,1067.49,312.99,241.31 \
                     --depth-scale 10000 --range 0.3..1.5";
    let Some(names) = runs("stills/ycb-video", arguments, 10) else { return };
    assert_eq!(names[0], "000001.json");
}

#[test]
fn tum_fr1_rpy() {
    let Some(names) = runs("video/tum-fr1-rpy", ".", 20) else { return };
    assert_eq!(names[0], "1305031232.868557.json");
}

#[test]
fn hand_plush() {
    // One frame a second. Camera file and unit are its own.
    let arguments = "--color rgb/?.000000.png --depth depth/?.000000.png --camera camera.json";
    let Some(names) = runs("video/hand-plush", arguments, 10) else { return };
    assert_eq!(names[0], "0.000000.json");
}
