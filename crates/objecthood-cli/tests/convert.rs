//! `objecthood convert` and `info`: frames in other formats give the same labels.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use common::photo::{camera, png};
use common::scene::Cloud;
use common::{Folder, run_in};

/// Two pairs of images in tenths of a millimetre, and their labels.
fn pairs() -> (Folder, String) {
    let folder = Folder::new();
    folder.write_pair("in", "000000", &Cloud::two_boxes(0.0));
    folder.write_pair("in", "000001", &Cloud::two_boxes(0.05));
    let named =
        format!("--color in/*-color.png --depth in/*-depth.png --camera {} --depth-scale 10000", camera());
    folder.run(&format!("segment {named} --out labels --write labels"), 0);
    (folder, named)
}

fn labels(folder: &Folder, out: &str) -> Vec<Vec<u8>> {
    folder
        .files(out)
        .into_iter()
        .filter(|(name, _)| name.ends_with(".labels.png"))
        .map(|(_, bytes)| bytes)
        .collect()
}

#[test]
fn a_tum_folder_gives_the_same_labels() {
    let (folder, named) = pairs();
    let run = folder.run(&format!("convert {named} --to tum --out tum"), 0);
    assert!(run.stderr.contains("without stamps") && !run.stderr.contains("rounded"), "{}", run.stderr);
    folder.run("segment tum --out again --write labels", 0);
    assert_eq!(labels(&folder, "again"), labels(&folder, "labels"));
    let info = folder.run("info tum", 0).stdout;
    assert!(
        info.starts_with("frames   2, depth/000000 to depth/000001\nimages   320 x 240, colour and depth\n"),
        "{info}"
    );
    assert!(info.contains("unit     10000 a metre"), "{info}");
}

#[test]
fn images_of_a_bop_scene_give_the_same_labels() {
    let (folder, named) = pairs();
    folder.run(&format!("convert {named} --to bop --out bop"), 0);
    folder.run(
        "segment --color bop/rgb --depth bop/depth --camera bop/scene_camera.json --out again --write labels",
        0,
    );
    assert_eq!(labels(&folder, "again"), labels(&folder, "labels"));
}

/// Metres as float numbers, and whole millimetres as 16 bits.
#[test]
fn a_recording_gives_the_same_labels() {
    let (folder, named) = pairs();
    folder.run(&format!("convert {named} --to mcap --out frames.mcap"), 0);
    folder.run("segment frames.mcap --out again --write labels", 0);
    assert_eq!(labels(&folder, "again"), labels(&folder, "labels"));
    folder.write("mm/a-depth.png", &png(&Cloud::two_boxes(0.0).depth(1000.0)));
    folder.write("mm/a-color.png", &png(&Cloud::two_boxes(0.0).color()));
    let in_mm =
        format!("--color mm/*-color.png --depth mm/*-depth.png --camera {} --depth-scale 1000", camera());
    folder.run(&format!("segment {in_mm} --out mm-labels --write labels"), 0);
    folder.run(&format!("convert {in_mm} --to mcap --out mm.mcap"), 0);
    folder.run("segment mm.mcap --out mm-again --write labels", 0);
    assert_eq!(labels(&folder, "mm-again"), labels(&folder, "mm-labels"));
}

#[test]
fn recordings_and_arrays_hold_every_bit() {
    let (folder, named) = pairs();
    folder.run(&format!("convert {named} --to mcap --out frames.mcap"), 0);
    folder.run(&format!("convert {named} --to npz --out npz"), 0);
    assert_eq!(folder.names("npz"), ["000000.npz", "000001.npz"]);
    folder.refuses(&format!("convert {named} --to npz --out npz"), "is there already");
    folder.refuses(&format!("convert {named} --to mcap --out frames.mcap"), "is there already");
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!("skipped: no Python with numpy and mcap (set OBJECTHOOD_PYTHON)");
        return;
    };
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/convert.py");
    let output = std::process::Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn what_a_layout_cannot_hold_is_said() {
    let folder = Folder::new();
    folder.write_pair("in", "a", &Cloud::two_boxes(0.0));
    let named = format!("--depth in/a-depth.png --camera {} --depth-scale 10000", camera());
    let run = folder.run(&format!("convert {named} --to tum --out tum"), 1);
    assert!(
        run.stderr.contains("the frame has no colour, and the layout of TUM cannot hold that"),
        "{}",
        run.stderr
    );
    folder.write("third.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let run = folder.run("convert third.pcd --to bop --out bop", 0);
    assert!(run.stderr.contains("depth was rounded by at most 0.05"), "{}", run.stderr);
}

/// The frames of a recording that is the folder in which the user is were called `.-000000`, so their outputs were hidden.
#[test]
fn outputs_of_a_recording_that_is_the_current_folder_have_its_name() {
    let (folder, named) = pairs();
    std::fs::create_dir(folder.path().join("talk")).unwrap();
    folder.run(&format!("convert {named} --to mcap --out talk/talk_0.mcap"), 0);
    let metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - talk_0.mcap\n";
    folder.write("talk/metadata.yaml", metadata.as_bytes());
    let run = run_in(&folder.path().join("talk"), "segment . --out ../out --write labels", 0);
    assert_eq!(folder.names("out"), ["talk-000000.labels.png", "talk-000001.labels.png"], "{}", run.stdout);
}
