//! The command line on mOSD: real frames, and the scorer that is not ours.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use std::process::Command;

use common::{Folder, mosd};

/// A few scenes of every category.
const SOME: [&str; 5] = ["learn2.pcd", "learn10.pcd", "learn19.pcd", "learn28.pcd", "learn44.pcd"];

/// A folder in which the data set stands under the name `mosd`.
#[cfg(unix)]
fn folder_with_data() -> Option<Folder> {
    let folder = Folder::new();
    std::os::unix::fs::symlink(std::fs::canonicalize(mosd()?).unwrap(), folder.path().join("mosd")).unwrap();
    Some(folder)
}

#[cfg(not(unix))]
fn folder_with_data() -> Option<Folder> {
    println!("skipped: mOSD needs a system with symbolic links here");
    None
}

#[test]
fn labels_do_not_depend_on_threads() {
    let Some(folder) = folder_with_data() else { return };
    let inputs = SOME.map(|scene| format!("mosd/learn/{scene}")).join(" ");
    folder.run(&format!("segment {inputs} --out one --threads 1 --write labels,json"), 0);
    let one = folder.files("one");
    assert_eq!(one.len(), 10);
    for threads in [2, 8, 8] {
        let out = format!("out{threads}");
        folder.run(&format!("segment {inputs} --out {out} --threads {threads} --write labels,json"), 0);
        assert!(folder.files(&out) == one, "{threads} threads");
        // Alone, a frame has all threads to itself.
        folder.run(&format!("segment mosd/learn/learn28.pcd --out alone{threads} --threads {threads}"), 0);
        assert!(folder.files(&format!("alone{threads}"))["learn28.labels.png"] == one["learn28.labels.png"]);
    }
}

/// `paper` on learn finds 72 of 112 objects, overlap F 82.7, boundary F 59.4 in the reference (PARITY.md, The reference).
#[test]
fn accuracy_of_paper_on_learn_does_not_fall() {
    accuracy_on_learn("paper", [69.0, 0.807, 0.57]);
}

/// `context` finds all objects of learn, overlap F 99.1, boundary F 97.3 (docs/EVALUATION.md, Objectness).
#[test]
fn accuracy_of_context_on_learn_does_not_fall() {
    accuracy_on_learn("context", [112.0, 0.988, 0.965]);
}

/// A method has at least so many correct objects, and at least this overlap F and boundary F.
fn accuracy_on_learn(method: &str, least: [f64; 3]) {
    let Some(folder) = folder_with_data() else { return };
    let run = folder.run(&format!("eval mosd --split learn --method {method} --json figures.json"), 0);
    let figures: serde_json::Value = serde_json::from_slice(&folder.files("")["figures.json"]).unwrap();
    let total = &figures["total"];
    assert_eq!(total["objects"], 112);
    let reached = [&total["counts"]["correct"], &total["oF"], &total["bF"]];
    for (figure, least) in reached.into_iter().zip(least) {
        assert!(figure.as_f64().unwrap() >= least, "{least}: {}", run.stdout);
    }
}

/// The paper's comparison, against the figures of the reference (PARITY.md, The reference).
#[test]
fn the_ablation_on_learn_is_that_of_the_reference() {
    let Some(folder) = folder_with_data() else { return };
    let run = folder.run("eval mosd --split learn --method paper --ablation --json figures.json", 0);
    let figures: serde_json::Value = serde_json::from_slice(&folder.files("")["figures.json"]).unwrap();
    let reference = [
        ("color, curvature off", 49, 71.8),
        ("depth, curvature off", 39, 67.2),
        ("both, curvature off", 51, 75.9),
        ("color, curvature on", 77, 82.0),
        ("depth, curvature on", 53, 73.7),
        ("both, curvature on", 72, 82.7),
    ];
    assert_eq!(figures.as_array().unwrap().len(), reference.len());
    for (row, (setting, correct, overlap_f)) in figures.as_array().unwrap().iter().zip(reference) {
        assert_eq!(row["setting"], setting);
        let total = &row["total"];
        assert!(
            (total["counts"]["correct"].as_i64().unwrap() - correct).abs() <= 4,
            "{setting}\n{}",
            run.stdout
        );
        assert!(
            (100.0 * total["oF"].as_f64().unwrap() - overlap_f).abs() <= 2.0,
            "{setting}\n{}",
            run.stdout
        );
    }
}

#[test]
fn the_independent_scorer_agrees_to_the_last_digit() {
    let Some(folder) = folder_with_data() else { return };
    let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") else {
        println!(
            "skipped: comparison with tools/score.py; `cargo xtask test` makes the Python that it needs"
        );
        return;
    };
    let shared = std::fs::canonicalize(folder.path().join("mosd")).unwrap().join("../..");
    let scorer_py = shared.join("tools/score.py");
    if !scorer_py.is_file() {
        println!("skipped: comparison with tools/score.py, which is not beside the data folder");
        return;
    }
    folder.run("segment mosd/learn --out labels --write labels", 0);
    let reference = shared.join("design/reference/learn");
    let mut compared = vec![(folder.path().join("labels"), ".labels.png")];
    if reference.is_dir() {
        compared.extend([".paper.png", ".context.png"].map(|suffix| (reference.clone(), suffix)));
    } else {
        println!("skipped: scores of the reference label images, which are not beside the data folder");
    }
    let data = folder.path().join("mosd");
    for (labels, suffix) in compared {
        let mut scorer = Command::new(&python);
        let theirs = scored(scorer.arg(&scorer_py).arg(&labels).arg("--osd").arg(&data), suffix);
        let mut eval = Command::new(env!("CARGO_BIN_EXE_objecthood"));
        let ours = scored(eval.arg("eval").arg(&data).arg("--labels").arg(&labels), suffix);
        assert_eq!(theirs.lines().count(), 46);
        assert!(ours.starts_with(&theirs), "{}\n{theirs}\n{ours}", labels.display());
    }
}

/// The lines for every scene and the total, as a scorer prints them.
fn scored(scorer: &mut Command, suffix: &str) -> String {
    let output = scorer.args(["--split", "learn", "--per-scene", "--suffix", suffix]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
