//! Ctrl-C, and an end by a signal that cannot be caught, in the middle of the work.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use common::Folder;

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
