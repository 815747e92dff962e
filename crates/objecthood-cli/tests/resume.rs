//! Runs over many frames: killed and gone on with, with broken frames among them, interrupted, and without growing.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use common::Folder;
use common::photo::png;
use common::scene::Cloud;
use image::{DynamicImage, ImageBuffer, Luma};
use serde_json::Value;

/// Frames of the test with kills; one of them is broken.
const FRAMES: usize = 40;

/// A folder `in` with frames, of which the last but one is broken.
fn frames() -> Folder {
    let folder = Folder::new();
    for k in 0..FRAMES {
        let bytes = Cloud::two_boxes(0.001 * k as f64).to_binary_pcd();
        let end = if k == FRAMES - 2 { bytes.len() / 2 } else { bytes.len() };
        folder.write(&format!("in/{k:03}.pcd"), &bytes[..end]);
    }
    folder
}

fn lines(folder: &Folder, out: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(folder.path().join(out).join("frames.jsonl")).unwrap_or_default();
    // The first line is that of the settings.
    text.lines().skip(1).filter_map(|line| serde_json::from_str(line).ok()).collect()
}

fn summary(folder: &Folder, out: &str) -> Value {
    serde_json::from_slice(&folder.files(out)["summary.json"]).unwrap()
}

fn start(folder: &Folder, arguments: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_objecthood"));
    command.current_dir(folder.path()).args(arguments.split_whitespace());
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits until so many frames are in the record.
fn wait_for(folder: &Folder, out: &str, count: usize, child: &mut Child) {
    while lines(folder, out).len() < count {
        assert!(child.try_wait().unwrap().is_none(), "it ended before {count} frames were there");
        thread::sleep(Duration::from_millis(2));
    }
}

/// The outputs without the summary, which has times, and the record without what broken frames say in each run.
fn outputs(folder: &Folder, out: &str) -> (BTreeMap<String, Vec<u8>>, Vec<Value>) {
    let mut files = folder.files(out);
    files.remove("frames.jsonl").expect("--resume keeps it");
    files.remove("summary.json").unwrap();
    let done = lines(folder, out).into_iter().filter(|line| line.get("error").is_none()).collect();
    (files, done)
}

#[test]
fn killed_ten_times_and_gone_on_with_it_ends_as_if_undisturbed() {
    let folder = frames();
    folder.run("segment in --out whole --resume --summary", 1);
    for kill in 0..10 {
        let mut child = start(&folder, "segment in --out parts --resume --summary");
        wait_for(&folder, "parts", 3 * (kill + 1), &mut child);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let run = folder.run("segment in --out parts --resume --summary", 1);
    assert!(
        run.stderr.contains(&format!("{} of {FRAMES} frames done, 1 failed", FRAMES - 1)),
        "{}",
        run.stderr
    );
    assert!(outputs(&folder, "parts") == outputs(&folder, "whole"), "{:?}", folder.names("parts"));

    let (whole, parts) = (summary(&folder, "whole"), summary(&folder, "parts"));
    for key in ["version", "parameters_fingerprint", "frames", "done", "failed", "objects", "failures"] {
        assert_eq!(whole[key], parts[key], "{key}");
    }
    assert_eq!(whole["before"], 0);
    assert!(parts["before"].as_u64().unwrap() >= 30, "{parts}");
    let failure = &whole["failures"][0];
    assert!(failure["source"].as_str().unwrap().ends_with("038.pcd"), "{failure}");
    assert!(failure["error"].as_str().unwrap().contains("038.pcd"), "{failure}");
}

#[test]
fn what_has_changed_is_done_again() {
    let folder = Folder::new();
    for k in 0..3 {
        folder.write(&format!("in/{k}.pcd"), &Cloud::two_boxes(0.01 * f64::from(k)).to_binary_pcd());
    }
    let done = |arguments: &str| {
        folder.run(&format!("segment in --out out --resume --write labels --summary {arguments}"), 0);
        let summary = summary(&folder, "out");
        summary["done"].as_u64().unwrap() - summary["before"].as_u64().unwrap()
    };
    assert_eq!(done(""), 3);
    assert_eq!(done(""), 0);
    folder.write("in/1.pcd", &Cloud::two_boxes(0.02).to_pcd());
    assert_eq!(done(""), 1, "a frame");
    std::fs::remove_file(folder.path().join("out/2.labels.png")).unwrap();
    assert_eq!(done(""), 1, "an output");
    assert_eq!(done("--set objectness.threshold=0.4"), 3, "a parameter");
    assert_eq!(done(""), 3, "and back, for the outputs were replaced");
    assert_eq!(done("--range 0.1..5"), 3, "what is looked at");
    assert_eq!(done("--write json"), 3, "what is written");
    folder.refuses("segment in --out out --resume --write coco", "--write coco needs every frame");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_whole_files_and_says_how_to_go_on() {
    let folder = frames();
    let mut child = start(&folder, "segment in --out out --threads 1");
    wait_for(&folder, "out", 2, &mut child);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.ends_with("note: to go on, give the same command with --resume\n"), "{stderr}");
    let count = lines(&folder, "out").len();
    assert_eq!(folder.names("out").len(), 1 + 2 * count, "whole frames only: {:?}", folder.names("out"));
    let run = folder.run("segment in --out out --resume", 1);
    folder.run("segment in --out plain", 1);
    assert!(!folder.names("plain").contains(&"frames.jsonl".to_owned()), "it is of no use any more");
    assert_eq!(run.stdout.lines().count(), FRAMES - 1 - count, "{}", run.stdout);
}

/// Resident memory of a process (KiB).
#[cfg(target_os = "linux")]
fn resident_kib(child: &Child) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

/// One small depth image under many names. As many as `OBJECTHOOD_MANY` says, or so many that the test is quick.
#[cfg(target_os = "linux")]
#[test]
fn memory_stays_flat_over_many_files_and_the_first_result_comes_at_once() {
    let count: usize = std::env::var("OBJECTHOOD_MANY").map_or(3000, |text| text.parse().unwrap());
    let folder = Folder::new();
    let depth = ImageBuffer::from_fn(32, 24, |u, v| {
        Luma([1000 + 5 * v as u16 + if u < 12 && v < 12 { 0 } else { 150_u16 }])
    });
    let bytes = png(&DynamicImage::ImageLuma16(depth));
    for k in 0..count {
        folder.write(&format!("in/{k}.png"), &bytes);
    }
    let begin = Instant::now();
    let arguments =
        "segment --depth in --camera 30,30,15.5,11.5 --depth-scale 1000 --out out --write labels --resume";
    let mut child = start(&folder, arguments);
    let mut stderr = child.stderr.take().unwrap();
    let silent = thread::spawn(move || std::io::copy(&mut stderr, &mut std::io::sink()));
    let mut printed = BufReader::new(child.stdout.take().unwrap()).lines();
    let (mut early, mut late, mut first_s) = (0, 0, 0.0);
    for k in 0..count {
        printed.next().unwrap().unwrap();
        if k == 0 {
            first_s = begin.elapsed().as_secs_f64();
        } else if k == count / 5 {
            early = resident_kib(&child).unwrap();
        } else if k == count - count / 50 {
            late = resident_kib(&child).unwrap();
        }
    }
    assert!(child.wait().unwrap().success());
    silent.join().unwrap().unwrap();
    let seconds = begin.elapsed().as_secs_f64();
    eprintln!(
        "{count} frames: first after {first_s:.2} s, all after {seconds:.1} s, {early} KiB early, {late} KiB late"
    );
    assert!(late < early + early / 10 + 2048, "{early} KiB after a fifth, {late} KiB at the end");
    assert!(first_s < 5.0, "the first result came after {first_s} s");
}
