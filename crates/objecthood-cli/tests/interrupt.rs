//! Ctrl-C, and an end by a signal that cannot be caught, in the middle of the work.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use common::Folder;
use common::scene::Cloud;
use serde_json::Value;

/// Starts a command, presses Ctrl-C as soon as it has written a `first` file, and waits for its end.
fn interrupted(folder: &Folder, arguments: &str, first: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_objecthood"));
    command.current_dir(folder.path()).args(arguments.split_whitespace());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !folder.path().join(first).exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before {first} was there");
        thread::sleep(Duration::from_millis(5));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    child.wait_with_output().unwrap()
}

/// The program ended without a word.
#[test]
fn ctrl_c_finishes_what_is_under_way_and_says_how_much_is_done() {
    let folder = Folder::new();
    let output = interrupted(
        &folder,
        "synth --out out --scenes 1000 --threads 1 --family single",
        "out/single0-color.png",
    );
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.starts_with("note: finishing what is under way"), "{stderr}");
    let done =
        stderr.trim().lines().last().unwrap().strip_suffix(" of 1000 scenes done, interrupted").unwrap();
    let done: usize = done.parse().unwrap();
    assert!((1..1000).contains(&done), "{stderr}");
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), done, "a line for every scene");
    // Every scene that is done is whole, and none is begun.
    assert_eq!(folder.names("out").len(), 1 + 6 * done, "{:?}", folder.names("out"));
    assert!(folder.names("out").iter().all(|name| !name.contains(".part")));
}

/// A recording of `frames` frames, two by turns.
fn recording(frames: usize) -> Folder {
    let folder = Folder::new();
    let stills = [0.0, 0.05].map(|shift_m| {
        folder.write(&format!("stills/{shift_m}.pcd"), &Cloud::two_boxes(shift_m).to_binary_pcd())
    });
    std::fs::create_dir(folder.path().join("in")).unwrap();
    for (k, still) in (0..frames).zip(stills.iter().cycle()) {
        std::fs::hard_link(still, folder.path().join(format!("in/{k:03}.pcd"))).unwrap();
    }
    folder.run("convert in --to mcap --out long.mcap", 0);
    folder
}

/// An interrupted run of the 100 frames of `long.mcap`: what it says, after a check that every file is whole.
fn interrupted_recording(folder: &Folder, arguments: &str, first: &str) -> String {
    let output = interrupted(folder, arguments, first);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    for (name, bytes) in folder.files("out") {
        match Path::new(&name).extension().and_then(|end| end.to_str()) {
            Some("png") => drop(image::load_from_memory(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"))),
            Some("json") => drop(serde_json::from_slice::<Value>(&bytes).unwrap()),
            Some("jsonl") => {
                let text = String::from_utf8(bytes).unwrap();
                assert!(text.lines().all(|line| serde_json::from_str::<Value>(line).is_ok()), "{name}");
            }
            Some("mcap") => assert!(bytes.ends_with(b"\x89MCAP0\r\n"), "{name} is cut"),
            _ => panic!("{name}: no output of a run"),
        }
    }
    stderr
}

#[test]
fn an_interrupted_recording_leaves_whole_files_and_says_how_to_go_on() {
    let folder = recording(100);
    let stderr =
        interrupted_recording(&folder, "segment long.mcap --out out --threads 1", "out/long-000000.json");
    assert!(stderr.contains("of 100 frames done, interrupted"), "{stderr}");
    assert!(stderr.contains("to go on, give the same command with --resume"), "{stderr}");
    let before = folder.files("out").keys().filter(|name| name.ends_with(".json")).count();
    assert!((1..100).contains(&before), "{before} frames");
    folder.run("segment long.mcap --out out --resume", 0);
    assert_eq!(folder.files("out").keys().filter(|name| name.ends_with(".json")).count(), 100);
}

/// There was no line that says how to go on.
#[test]
fn files_of_an_interrupted_run_are_whole_and_it_says_how_to_go_on() {
    let folder = recording(100);
    let arguments = "segment long.mcap --out out --threads 1 --write json,coco,bop,mcap";
    let stderr = interrupted_recording(&folder, arguments, "out/long-000000.json");
    assert!(
        stderr.contains("to go on, give the frames that are left (--frames) and another --out"),
        "{stderr}"
    );
    let files = folder.files("out");
    for file in ["instances.coco.json", "objects.labels.mcap"] {
        assert!(files.contains_key(file), "{file}: {:?}", files.keys());
    }
}

#[test]
fn an_interrupted_video_leaves_whole_files_and_says_how_to_go_on() {
    let folder = recording(100);
    let arguments = "track long.mcap --out out --threads 1";
    let stderr = interrupted_recording(&folder, arguments, "out/labels/long-000000.png");
    assert!(stderr.contains("the same command follows the video from its beginning"), "{stderr}");
    let files = folder.files("out");
    let told = String::from_utf8_lossy(&files["tracks.jsonl"]).lines().count();
    assert!((1..100).contains(&told), "{told} frames");
    assert_eq!(files.keys().filter(|name| name.starts_with("labels/")).count(), told);
}

/// Half of a file stayed in the folder for ever.
#[test]
fn what_a_killed_process_left_is_removed_by_the_next() {
    let folder = Folder::new();
    // The system kills a process that writes more than 20 blocks to a file; an image is longer.
    let program = env!("CARGO_BIN_EXE_objecthood");
    let killed = Command::new("sh")
        .current_dir(folder.path())
        .args(["-c", &format!("ulimit -f 20; exec '{program}' synth --out out --scenes 1")])
        .output()
        .unwrap();
    assert_eq!(killed.status.code(), None, "ended by a signal");
    let strays = || folder.names("out").iter().filter(|name| name.ends_with(".part")).count();
    assert_eq!((strays(), folder.names("out").len()), (1, 2), "half a file beside the camera");
    folder.run("synth --out out --scenes 1", 0);
    assert_eq!((strays(), folder.names("out").len()), (0, 7));
}
