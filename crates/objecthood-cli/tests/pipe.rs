//! Frames by stdin: `segment - --format frames`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use common::pipe::{good, parts, sent};
use common::scene::{Cloud, FOCAL_PX};
use common::{Folder, command};
use serde_json::{Value, json};

/// What is answered to bytes on stdin, the exit code, and stderr.
fn answers(arguments: &[&str], stdin: Vec<u8>) -> (Vec<Value>, i32, String) {
    let mut command = command();
    command.args(["segment", "-", "--format", "frames"]).args(arguments);
    let output = command.write_stdin(stdin).output().unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    let lines = lines.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (lines, output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_first_frame_is_answered_as_its_file_would_be() {
    let folder = Folder::new();
    let camera = json!({"fx": FOCAL_PX, "fy": FOCAL_PX, "cx": 159.5, "cy": 119.5});
    folder.write("camera.json", camera.to_string().as_bytes());
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.run("segment a.pcd --camera camera.json --out found", 0);
    let scene: Value = serde_json::from_slice(&folder.files("found")["a.json"]).unwrap();

    let (header, depth, color) = parts(&Cloud::two_boxes(0.0), "wrong");
    let stdin = [good("a", 0.0), sent(&header, &depth[1..], &color), good("b", 0.05)].concat();
    let (lines, code, stderr) = answers(&["--threads", "1"], stdin);
    assert_eq!((lines.len(), code), (3, 1), "{stderr}");
    assert_eq!(lines[0]["scene"]["objects"], scene["objects"]);
    assert_eq!(
        (&lines[0]["name"], &lines[0]["stamp_ns"], &lines[0]["dropped"]),
        (&json!("a"), &json!(17), &json!(0))
    );
    let runs = lines[0]["labels"].as_array().unwrap();
    let pixels = |label: u64| -> u64 {
        runs.iter().filter(|run| run[0] == label).map(|run| run[1].as_u64().unwrap()).sum()
    };
    assert_eq!(json!(pixels(1)), scene["objects"][0]["size_px"]);
    assert_eq!(runs.iter().map(|run| run[1].as_u64().unwrap()).sum::<u64>(), 320 * 240);
    assert!(lines[1]["error"].as_str().unwrap().contains("the depth has 307199 bytes"), "{}", lines[1]);
    assert_eq!((&lines[1]["number"], &lines[1]["name"]), (&json!(1), &json!("wrong")));
    assert_eq!(lines[2]["scene"]["objects"].as_array().unwrap().len(), 2);
    assert!(stderr.ends_with("2 of 3 frames done, 1 failed\n"), "{stderr}");
}

/// The noise of a frame is the mean of what it and the frames before it tell, as long as they are of one camera.
#[test]
fn what_frames_tell_of_their_sensor_is_handed_on() {
    let of_camera = |name: &str, fx: f64| {
        let (mut header, depth, color) = parts(&Cloud::two_boxes(0.0), name);
        header["camera"][0] = json!(fx);
        sent(&header, &depth, &color)
    };
    let stdin = [of_camera("a", FOCAL_PX), good("b", 0.05), of_camera("other", 260.0)].concat();
    let (lines, code, stderr) = answers(&[], stdin);
    let alone = [good("b", 0.05), of_camera("other", 260.0)].map(|frame| answers(&[], frame).0.remove(0));
    assert_eq!(code, 0, "{stderr}");
    assert_ne!(lines[1]["scene"]["noise"], alone[0]["scene"]["noise"]);
    assert_eq!(lines[2]["scene"]["noise"], alone[1]["scene"]["noise"]);
}

#[test]
fn what_the_command_line_says_holds_for_all_frames() {
    let (mut header, depth, color) = parts(&Cloud::two_boxes(0.0), "a");
    header["camera"] = Value::Null;
    let frame = sent(&header, &depth, &color);
    let (lines, code, _) = answers(&[], frame.clone());
    assert_eq!(code, 1);
    assert!(lines[0]["error"].as_str().unwrap().contains("--camera"), "{}", lines[0]);
    let (lines, code, _) = answers(&["--camera", "262.5,262.5,159.5,119.5", "--range", "0.1..5"], frame);
    assert_eq!((code, lines[0]["scene"]["objects"].as_array().unwrap().len()), (0, 2));
}

#[test]
fn with_latest_the_last_frame_is_answered_and_drops_are_said() {
    let frames: Vec<u8> = (0..12).flat_map(|k| good(&k.to_string(), 0.0)).collect();
    let (lines, code, stderr) = answers(&["--latest"], frames);
    let last = lines.last().unwrap();
    assert_eq!((code, &last["name"]), (0, &json!("11")), "{stderr}");
    let dropped = last["dropped"].as_u64().unwrap();
    assert_eq!(dropped + lines.len() as u64, 12);
    assert!(dropped > 0, "frames arrive faster than they are looked at");
    let said =
        format!("{} of 12 frames done, {dropped} dropped because a newer one was there\n", lines.len());
    assert!(stderr.ends_with(&said), "{stderr}");
}

#[test]
fn a_broken_stream_is_said_after_what_came_before() {
    let (lines, code, stderr) = answers(&[], [good("a", 0.0), good("b", 0.0)[..1000].to_vec()].concat());
    assert_eq!((lines.len(), code), (1, 1));
    assert!(stderr.contains("error: the stream ends within frame 1"), "{stderr}");
    let (lines, code, stderr) = answers(&[], b"P6 320 240 255".to_vec());
    assert_eq!((lines.len(), code), (0, 1));
    assert!(stderr.contains("frame 0 does not begin with OHF1"), "{stderr}");
    assert_eq!(answers(&[], Vec::new()).1, 0, "no frame at all");
}

#[test]
fn what_makes_no_sense_with_stdin_is_refused() {
    let folder = Folder::new();
    folder.refuses("segment - --out found", "only `segment - --format frames` reads");
    folder.refuses("segment a.pcd --format frames", "name - as the only input");
    folder.refuses("segment - --format frames --out found", "cannot be used with");
    folder.refuses("segment a.pcd --out found --latest", "cannot be used with");
    folder.refuses("segment a.pcd", "--out");
}

/// The client of docs/PIPE.md.
#[test]
fn the_documented_client_works() {
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!("skipped: no Python with NumPy (set OBJECTHOOD_PYTHON)");
        return;
    };
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/PIPE.md");
    let docs = std::fs::read_to_string(docs).unwrap();
    let client = docs.split_once("```python\n").unwrap().1.split_once("```").unwrap().0;
    let folder = Folder::new();
    let cloud = Cloud::two_boxes(0.0);
    let depth_mm = cloud.points.iter().map(|point| (1000.0 * point.xyz_m[2]).round() as u16);
    folder.write("depth", &depth_mm.flat_map(u16::to_le_bytes).collect::<Vec<_>>());
    folder.write("color", &cloud.points.iter().flat_map(|point| point.color).collect::<Vec<_>>());
    let script = format!(
        "{client}
depth = np.fromfile('depth', '<u2').reshape(240, 320)
rgb = np.fromfile('color', 'u1').reshape(240, 320, 3)
for _ in range(2):
    scene, labels = segment(depth, rgb, [{FOCAL_PX}, {FOCAL_PX}, 159.5, 119.5])
    sizes = [thing['size_px'] for thing in scene['objects']]
    assert sizes == [int((labels == k + 1).sum()) for k in range(2)], sizes
pipe.stdin.close()
assert pipe.wait() == 0
"
    );
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_objecthood")).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths(std::iter::once(program.to_owned()).chain(std::env::split_paths(&path)))
        .unwrap();
    let output = std::process::Command::new(python)
        .current_dir(folder.path())
        .env("PATH", path)
        .args(["-c", &script])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
