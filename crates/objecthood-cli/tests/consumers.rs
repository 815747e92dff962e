//! What `segment --write` gives to other programs, read back by them: jsonschema, pycocotools, supervision, NumPy, plyfile, the MCAP
//! libraries, and Open3D where it is installed.
//!
//! Needs, in `OBJECTHOOD_PYTHON`, a Python with the packages of `xtask/requirements.txt`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use common::Folder;
use common::scene::Cloud;

const EVERYTHING: &str = "labels,json,npz,ply,ply-objects,coco,bop,mcap";

fn two_frames() -> Folder {
    let folder = Folder::new();
    for (name, shift_m) in [("first", 0.0), ("second", 0.05)] {
        folder.write(&format!("in/{name}.pcd"), &Cloud::two_boxes(shift_m).to_binary_pcd());
    }
    folder
}

#[test]
fn every_file_is_read_by_its_consumer() {
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!(
            "skipped: no Python with pycocotools, supervision, plyfile and mcap (set OBJECTHOOD_PYTHON)"
        );
        return;
    };
    let folder = two_frames();
    folder.run(&format!("segment in --out found --write {EVERYTHING}"), 0);
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/consumers.py");
    let output = std::process::Command::new(python)
        .arg(script)
        .arg(folder.path().join("found"))
        .args(["first", "second"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).trim_end().ends_with("read back 2"));
}

#[test]
fn files_do_not_depend_on_threads_and_are_no_input() {
    let folder = two_frames();
    folder.run(&format!("segment in --out one --threads 1 --write {EVERYTHING}"), 0);
    folder.run(&format!("segment in --out two --threads 3 --write {EVERYTHING}"), 0);
    let names = folder.names("one");
    for name in [
        "instances.coco.json",
        "objects.labels.mcap",
        "bop/objecthood_results.json",
        "first.object2.labels.ply",
    ] {
        assert!(names.iter().any(|own| own == name), "{name}: {names:?}");
    }
    assert!(folder.files("one") == folder.files("two"));
    let run = folder.run("segment one --out three", 1);
    assert!(run.stderr.contains("no point cloud"), "{}", run.stderr);
}

/// A frame that fails leaves the files of the run with those that are done.
#[test]
fn a_frame_that_fails_is_missing_in_the_files_of_the_run() {
    let folder = two_frames();
    folder.write("in/broken.pcd", b"# .PCD v0.7\nVERSION 0.7\n");
    folder.run("segment in --out found --write coco", 1);
    let coco: serde_json::Value =
        serde_json::from_slice(&folder.files("found")["instances.coco.json"]).unwrap();
    let images: Vec<_> = coco["images"].as_array().unwrap().iter().map(|image| &image["file_name"]).collect();
    assert_eq!(images, ["first.pcd", "second.pcd"]);
    assert_eq!(coco["annotations"].as_array().unwrap().len(), 4);
}

#[test]
fn a_file_of_the_run_is_not_written_over_an_input() {
    let folder = two_frames();
    folder.write("in/instances.coco.json", br#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5}"#);
    folder
        .refuses("segment in --camera in/instances.coco.json --out in --write coco", "choose another --out");
}
