//! Our lines are those of the project's independent scorer, `tools/score.py`, character by character.
//!
//! Needs the data and, in `OBJECTHOOD_PYTHON`, a Python with numpy, scipy, pillow and python-lzf.

mod common;

use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use objecthood::Raster;
use objecthood_eval::{LabelFolder, Report, SceneRef, Split, Truth, VerdictCounts, evaluate, scenes};
use objecthood_io::label_image;

/// Where everything is, or why the test cannot run.
fn setting() -> Result<(PathBuf, OsString), &'static str> {
    let data = common::data().ok_or("no mOSD here (set OBJECTHOOD_DATA)")?;
    let python = std::env::var_os("OBJECTHOOD_PYTHON")
        .ok_or("no Python with numpy, scipy, pillow and python-lzf (set OBJECTHOOD_PYTHON)")?;
    if data.join("../tools/score.py").is_file() {
        Ok((data, python))
    } else {
        Err("no tools/score.py beside the data")
    }
}

/// What score.py prints for the label images in a folder.
fn oracle(python: &OsString, data: &Path, labels: &LabelFolder) -> String {
    let output = Command::new(python)
        .arg(data.join("../tools/score.py"))
        .arg(&labels.path)
        .args(["--per-scene", "--split", "learn", "--suffix", &labels.suffix, "--osd"])
        .arg(data.join("mosd"))
        .output()
        .expect("OBJECTHOOD_PYTHON runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("score.py prints text")
}

/// The same from us.
fn ours(scenes: &[SceneRef], labels: &LabelFolder) -> (Report, String) {
    let report =
        evaluate(scenes, None, |_, scene| labels.read(scene)).expect("scenes and label images are there");
    let mut lines = String::new();
    for scene in &report.scenes {
        writeln!(lines, "{scene}").expect("a string takes all");
    }
    writeln!(lines, "{}", report.total).expect("a string takes all");
    (report, lines)
}

/// Ways of being wrong. `prediction` is a fair label image of the scene, `random` a number per pixel.
const DAMAGES: &[(&str, Damage)] = &[
    ("empty", |_| 0),
    ("all one", |_| 1),
    ("merged in pairs", |p| p.prediction.div_ceil(2)),
    ("shifted", |p| p.shifted),
    ("striped", |p| if p.prediction > 0 { p.prediction * 8 + p.u as u16 / 40 % 8 } else { 0 }),
    ("noise", |p| p.random % 5),
    ("noise of large labels", |p| if p.random < 200 { 65535 - p.random } else { 0 }),
    ("only where the truth is ignored", |p| u16::from(p.truth == 0)),
    ("only background", |p| u16::from(p.truth == 1)),
    ("full of holes", |p| if p.truth > 1 && (p.u + p.v) % 3 > 0 { 9 - p.truth as u16 % 9 } else { 0 }),
    ("spread", |p| {
        if p.truth > 1 && (p.u ^ p.v) & 1 == 0 { p.truth as u16 } else { u16::from(p.truth == 1) * 2 }
    }),
    ("perfect", |p| if p.truth > 1 { 1000 - p.truth as u16 } else { 0 }),
    ("parts", |p| p.part as u16),
    ("halves", |p| if p.truth > 1 { p.truth as u16 * 2 + p.v as u16 % 2 } else { 0 }),
];

type Damage = fn(&Pixel) -> u16;

struct Pixel {
    u: usize,
    v: usize,
    prediction: u16,
    shifted: u16,
    truth: u32,
    part: u32,
    random: u16,
}

fn damaged(prediction: &Raster<u16>, truth: &Truth, damage: Damage) -> Raster<u16> {
    let (width, height) = prediction.size();
    let mut state = 1_u32;
    let label = |i: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (u, v) = (i % width, i / width);
        damage(&Pixel {
            u,
            v,
            prediction: prediction[i],
            shifted: prediction.get(u + 25, v + 12).copied().unwrap_or(0),
            truth: truth.labels()[i],
            part: truth.parts()[i],
            random: (state >> 16) as u16,
        })
    };
    Raster::from_vec(width, height, (0..width * height).map(label).collect()).expect("as large as before")
}

#[test]
fn the_reference_label_images_score_as_the_oracle_says() {
    let (data, python) = match setting() {
        Ok(setting) => setting,
        Err(why) => return println!("skipped: {why}"),
    };
    let reference = data.join("../design/reference/learn");
    if !reference.is_dir() {
        return println!("skipped: no reference label images beside the data");
    }
    let scenes = scenes(&data.join("mosd"), &Split::Folder("learn".to_owned())).unwrap();
    for suffix in [".paper.png", ".context.png"] {
        let labels = LabelFolder { path: reference.clone(), suffix: suffix.to_owned() };
        assert_eq!(ours(&scenes, &labels).1, oracle(&python, &data, &labels), "{suffix}");
    }
}

#[test]
fn damaged_label_images_score_as_the_oracle_says() {
    let (data, python) = match setting() {
        Ok(setting) => setting,
        Err(why) => return println!("skipped: {why}"),
    };
    let reference =
        LabelFolder { path: data.join("../design/reference/learn"), suffix: ".paper.png".to_owned() };
    if !reference.path.is_dir() {
        return println!("skipped: no reference label images beside the data");
    }
    let scenes = scenes(&data.join("mosd"), &Split::Folder("learn".to_owned())).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut seen = VerdictCounts::default();
    // Every scene is damaged in another way in each round.
    for round in 0..3 {
        let labels = LabelFolder { path: folder.path().to_owned(), suffix: ".labels.png".to_owned() };
        for (k, scene) in scenes.iter().enumerate() {
            let (_, damage) = DAMAGES[(k + 5 * round) % DAMAGES.len()];
            let prediction = reference.read(scene).unwrap().labels;
            let image = damaged(&prediction, &scene.load(None).unwrap().truth, damage);
            let path = labels.path.join(format!("{}{}", scene.name, labels.suffix));
            fs::write(path, label_image::encode(&image).unwrap()).unwrap();
        }
        let (report, lines) = ours(&scenes, &labels);
        assert_eq!(lines, oracle(&python, &data, &labels), "round {round}");
        report.scenes.iter().flat_map(|s| &s.score.objects).for_each(|o| seen += o.verdict);
    }
    let VerdictCounts { correct, occlusion, over, under, boundary, missed } = seen;
    assert!([correct, occlusion, over, under, boundary, missed].iter().all(|&n| n > 0), "{seen:?}");
}
