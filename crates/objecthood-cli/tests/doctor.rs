//! `objecthood doctor`: real inputs as they are raise no sure doubt; what people get wrong is caught.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::Path;
use std::process::Command;

use common::photo::png;
use common::scene::Cloud;
use common::{Folder, command, data};
use image::{DynamicImage, ImageBuffer, Luma, RgbImage, imageops};
use serde_json::{Value, json};

type Depth = ImageBuffer<Luma<u16>, Vec<u16>>;

const TABLETOP: [f64; 4] = [612.937, 613.173, 322.549, 248.158];

/// What doctor says: certainty and cause of every doubt.
fn doubts(folder: &Path, arguments: &[String]) -> Vec<(String, String)> {
    let output = command().current_dir(folder).args(["doctor", "--json"]).args(arguments).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {stderr}"));
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let findings = report["findings"].as_array().unwrap();
    let doubts: Vec<_> = findings.iter().map(|f| (text(&f["certainty"]), text(&f["cause"]))).collect();
    let is_sure = doubts.iter().any(|(certainty, _)| certainty == "sure");
    assert_eq!(output.status.code(), Some(is_sure.into()), "{stderr}");
    doubts
}

#[test]
fn real_inputs_raise_no_sure_doubt_and_at_most_one_suspicion() {
    let Some(data) = data() else { return };
    let path = |name: &str| data.join(name).display().to_string();
    let pairs = |set: &str, camera: &str, scale: &str| {
        let images = |what: &str| path(&format!("stills/{set}/*-{what}.png"));
        ["--color", &images("color"), "--depth", &images("depth"), "--camera", camera, "--depth-scale", scale]
            .map(str::to_owned)
            .to_vec()
    };
    let inputs = [
        pairs("tabletop-clutter", "612.937,613.173,322.549,248.158", "1000"),
        pairs("ycb-video", "1066.78,1067.49,312.99,241.31", "10000"),
        vec![path("video/tum-fr1-rpy")],
        vec![path("video/hand-plush")],
        vec![path("mosd/learn")],
        vec![path("stills/milk_cartoon_all_small_clorox.pcd")],
    ];
    for input in inputs {
        let found = doubts(&data, &input);
        let sure = found.iter().filter(|(certainty, _)| certainty == "sure").count();
        assert!(sure == 0 && found.len() <= 1, "{input:?}: {found:?}");
    }
}

/// A still of the table, as its files have it.
#[derive(Clone)]
struct Still {
    color: RgbImage,
    depth: Depth,
    camera: [f64; 4],
    scale: f64,
}

impl Still {
    fn open(data: &Path) -> Self {
        let open =
            |what| image::open(data.join(format!("stills/tabletop-clutter/000000-{what}.png"))).unwrap();
        Self {
            color: open("color").to_rgb8(),
            depth: open("depth").to_luma16(),
            camera: TABLETOP,
            scale: 1000.0,
        }
    }

    fn depth(mut self, change: impl Fn(u16) -> u16) -> Self {
        self.depth.pixels_mut().for_each(|Luma([raw])| *raw = change(*raw));
        self
    }

    /// The images as files, and how they are named to the program.
    fn write(&self, folder: &Folder) -> Vec<String> {
        folder.write("color.png", &png(&self.color.clone().into()));
        folder.write("depth.png", &png(&DynamicImage::ImageLuma16(self.depth.clone())));
        let [fx, fy, cx, cy] = self.camera;
        let named = format!(
            "--color color.png --depth depth.png --camera {fx},{fy},{cx},{cy} --depth-scale {}",
            self.scale
        );
        named.split(' ').map(str::to_owned).collect()
    }

    fn doubts(&self) -> Vec<(String, String)> {
        let folder = Folder::new();
        let arguments = self.write(&folder);
        doubts(folder.path(), &arguments)
    }
}

#[test]
fn what_people_get_wrong_is_caught() {
    let Some(data) = data() else { return };
    let still = Still::open(&data);
    let with = |change: &dyn Fn(&mut Still)| {
        let mut still = still.clone();
        change(&mut still);
        still
    };
    let half = |image: &RgbImage| imageops::resize(image, 320, 240, imageops::FilterType::Triangle);
    let disparity = |raw: u16| if raw == 0 { 0 } else { (500_000.0 / f64::from(raw)).round() as u16 };
    let cases: Vec<(&str, Still, &str, &[&str])> = vec![
        ("x 1000", with(&|s| s.scale = 1.0), "sure", &["unreadable", "too_far"]),
        ("x 10", with(&|s| s.scale = 100.0), "sure", &["too_far"]),
        ("x 5", with(&|s| s.scale = 200.0), "suspect", &["too_far"]),
        ("/ 10", with(&|s| s.scale = 10_000.0), "sure", &["too_near"]),
        ("fx halved", with(&|s| s.camera[0] /= 2.0), "suspect", &["camera"]),
        (
            "both images resized without K",
            with(&|s| {
                s.color = half(&s.color);
                s.depth = imageops::resize(&s.depth, 320, 240, imageops::FilterType::Nearest);
            }),
            "sure",
            &["camera"],
        ),
        ("colour resized alone", with(&|s| s.color = half(&s.color)), "sure", &["unreadable"]),
        ("8 bits", still.clone().depth(|raw| raw / 256 * 256), "sure", &["eight_bit"]),
        ("disparity", still.clone().depth(disparity), "sure", &["not_depth"]),
        ("constant", still.clone().depth(|_| 1000), "sure", &["constant"]),
        ("shifted by 8 px", with(&|s| s.depth = shifted(&s.depth, 8)), "sure", &["registration"]),
        ("shifted back by 8 px", with(&|s| s.depth = shifted(&s.depth, -8)), "sure", &["registration"]),
        (
            "upside down",
            with(&|s| {
                s.color = imageops::rotate180(&s.color);
                s.depth = imageops::rotate180(&s.depth);
            }),
            "suspect",
            &["turned"],
        ),
    ];
    let mut missed = Vec::new();
    for (name, still, certainty, causes) in cases {
        let found = still.doubts();
        if !found.iter().any(|(how, cause)| how == certainty && causes.contains(&cause.as_str())) {
            missed.push((name, found));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

fn shifted(depth: &Depth, by_px: i64) -> Depth {
    ImageBuffer::from_fn(depth.width(), depth.height(), |u, v| {
        let from = i64::from(u) - by_px;
        if (0..i64::from(depth.width())).contains(&from) {
            *depth.get_pixel(from as u32, v)
        } else {
            Luma([0])
        }
    })
}

#[test]
fn swapped_images_are_caught() {
    let Some(data) = data() else { return };
    let folder = Folder::new();
    let mut arguments = Still::open(&data).write(&folder);
    arguments.swap(1, 3);
    assert_eq!(doubts(folder.path(), &arguments), [("sure".to_owned(), "unreadable".to_owned())]);
}

/// A TUM folder of the hand video with other lines in its lists.
fn video(data: &Path, lines: impl Fn(Vec<String>) -> Vec<String>) -> Folder {
    let (folder, from) = (Folder::new(), data.join("video/hand-plush"));
    for list in ["rgb", "depth"] {
        let text = std::fs::read_to_string(from.join(format!("{list}.txt"))).unwrap();
        let own = text.lines().filter(|line| !line.starts_with('#')).take(30);
        let named = lines(
            own.map(|line| line.replace(&format!(" {list}/"), &format!(" {}/{list}/", from.display())))
                .collect(),
        );
        folder.write(&format!("{list}.txt"), (named.join("\n") + "\n").as_bytes());
    }
    folder.write("camera.json", &std::fs::read(from.join("camera.json")).unwrap());
    folder
}

#[test]
fn missing_and_repeated_frames_are_caught() {
    let Some(data) = data() else { return };
    let here = || vec![".".to_owned()];
    let plain = video(&data, |lines| lines);
    assert_eq!(doubts(plain.path(), &here()), []);
    let dropped = video(&data, |mut lines| {
        lines.drain(8..13);
        lines
    });
    assert_eq!(doubts(dropped.path(), &here()), [("suspect".to_owned(), "sequence".to_owned())]);
    // Each frame is a file of its own with the content of the first.
    let first = std::fs::read(data.join("video/hand-plush/depth/0.000000.png")).unwrap();
    let frozen = video(&data, |lines| lines);
    let stamps = (0..30).map(|k| format!("{:.6} depth/{k}.png", f64::from(k) / 15.0));
    frozen.write("depth.txt", stamps.collect::<Vec<_>>().join("\n").as_bytes());
    (0..30).for_each(|k| drop(frozen.write(&format!("depth/{k}.png"), &first)));
    assert_eq!(doubts(frozen.path(), &here()), [("sure".to_owned(), "sequence".to_owned())]);
}

/// Two recordings were taken for one, in which a clock was set back.
#[test]
fn each_input_is_a_recording_of_its_own() {
    let folder = Folder::new();
    for k in 0..4 {
        folder.write(&format!("in/{k}.pcd"), &Cloud::two_boxes(0.01 * f64::from(k)).to_binary_pcd());
    }
    folder.run("synth --video empty --fps 5 --size 160x120 --out video", 0);
    std::fs::create_dir(folder.path().join("bags")).unwrap();
    folder.run("convert in --to mcap --out bags/c.mcap", 0);
    folder.run("convert in --to mcap --out bags/d.mcap", 0);
    let run = folder.run("doctor video/empty0 bags in/0.pcd in/1.pcd nothing.pcd", 1);
    let titles: Vec<&str> = run.stdout.split("\n\n").filter_map(|report| report.lines().next()).collect();
    assert_eq!(
        titles,
        [
            "video/empty0",
            "bags/c.mcap",
            "bags/d.mcap",
            "2 frames in files of their own",
            "what cannot be read"
        ]
    );
    assert!(!run.stdout.contains("out of order"), "{}", run.stdout);
    let json = folder.run("doctor bags/c.mcap bags/d.mcap --json", 0).stdout;
    let reports: Vec<Value> =
        serde_json::Deserializer::from_str(&json).into_iter().collect::<Result<_, _>>().unwrap();
    let frames = reports.iter().map(|report| (&report["input"], &report["facts"]["frames"]));
    let expected = [(&json!("bags/c.mcap"), &json!(4)), (&json!("bags/d.mcap"), &json!(4))];
    assert_eq!(frames.collect::<Vec<_>>(), expected);
}

/// Mistakes in recordings of `rosbags`, which knows nothing of this program.
#[test]
fn mistakes_in_recordings_are_caught() {
    let Some(data) = data() else { return };
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!("skipped: no Python with rosbags (set OBJECTHOOD_PYTHON)");
        return;
    };
    let folder = Folder::new();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doctor.py");
    let (video, out) = (data.join("video/hand-plush"), folder.path());
    assert!(Command::new(python).arg(script).arg(video).arg(out).status().unwrap().success());
    let found = |name: &str| doubts(out, &[name.to_owned()]);
    assert_eq!(found("good"), []);
    let cases = [
        ("dropped", "suspect", "sequence"),
        ("set_back", "sure", "sequence"),
        ("frozen", "sure", "sequence"),
        ("shifted", "sure", "registration"),
        ("ten_times", "sure", "too_far"),
        ("one_byte", "sure", "eight_bit"),
    ];
    let told = cases.map(|(name, ..)| (name, found(name)));
    for ((name, certainty, cause), (_, doubts)) in cases.iter().zip(&told) {
        assert!(doubts.contains(&((*certainty).to_owned(), (*cause).to_owned())), "{name}: {told:#?}");
    }
}

#[test]
fn segment_says_the_likely_doubt_when_it_finds_nothing() {
    let folder = Folder::new();
    let flat = Depth::from_pixel(320, 240, Luma([1000]));
    folder.write("depth.png", &png(&DynamicImage::ImageLuma16(flat)));
    let run = folder
        .run("segment --depth depth.png --camera 262.5,262.5,159.5,119.5 --depth-scale 1000 --out out", 0);
    assert!(run.stderr.contains("most likely, every depth is 1.000 m"), "{}", run.stderr);
}
