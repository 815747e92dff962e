//! `objecthood eval` on a small data set of our own.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::Folder;
use common::scene::Cloud;

/// ROOT/left with two scenes, ROOT/right with one.
fn data_set() -> Folder {
    let folder = Folder::new();
    for (k, name) in ["left/scene1.pcd", "left/scene2.pcd", "right/scene10.pcd"].iter().enumerate() {
        folder.write(&format!("root/{name}"), &Cloud::two_boxes(0.03 * k as f64).to_binary_pcd());
    }
    folder
}

fn json(folder: &Folder, name: &str) -> serde_json::Value {
    serde_json::from_slice(&folder.files("")[name]).unwrap()
}

#[test]
fn a_method_is_scored_with_its_stages() {
    let folder = data_set();
    let run = folder.run("eval root --per-scene --json figures.json", 0);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert!(lines[0].starts_with("scene1   2/2  oF "), "{}", run.stdout);
    assert!(lines[2].starts_with("scene10  2/2  oF "), "{}", run.stdout);
    assert!(lines[3].starts_with("correct 1.000 (6/6)  overlap P "), "{}", run.stdout);
    for word in ["| left ", "| right ", "| all ", "superpixels", "facets", "shapes", "contact recall"] {
        assert!(run.stdout.contains(word), "{word}: {}", run.stdout);
    }
    let figures = json(&folder, "figures.json");
    assert_eq!(figures["total"]["counts"]["correct"], 6);
    assert_eq!(figures["scenes"]["scene2"]["objects"], 2);
    for threads in [1, 8] {
        assert_eq!(folder.run(&format!("eval root --per-scene --threads {threads}"), 0).stdout, run.stdout);
    }

    let run = folder.run("eval root --split right", 0);
    assert!(run.stdout.starts_with("correct 1.000 (2/2)"), "{}", run.stdout);
    let run = folder.run("eval root --method paper --set objectness.max_side_m=0.01", 0);
    assert!(run.stdout.starts_with("correct 0.000 (0/6)"), "{}", run.stdout);
}

#[test]
fn our_own_label_images_get_the_same_score() {
    let folder = data_set();
    folder.run("segment root --out labels", 0);
    let method = folder.run("eval root --per-scene --json method.json", 0).stdout;
    let labels = folder.run("eval root --per-scene --labels labels --json labels.json", 0).stdout;
    // Label images have no objectness to rank by, and no stages.
    let (ranking, others): (Vec<_>, Vec<_>) =
        method.lines().partition(|line| line.starts_with("average precision 1.000 of 1.000"));
    assert!(ranking.len() == 1 && others.join("\n").starts_with(labels.trim_end()), "{method}\n{labels}");
    assert_eq!(json(&folder, "method.json")["total"]["oF"], json(&folder, "labels.json")["total"]["oF"]);
}

#[test]
fn the_ablations_have_six_and_three_settings() {
    let folder = data_set();
    let paper = [
        "color, curvature off",
        "depth, curvature off",
        "both, curvature off",
        "color, curvature on",
        "depth, curvature on",
        "both, curvature on",
    ];
    let context = ["depth only", "colour for stages 1 and 2, without skirts", "colour for all stages"];
    for (method, expected) in [("paper", &paper[..]), ("context", &context)] {
        let run = folder.run(&format!("eval root --method {method} --ablation --json figures.json"), 0);
        let figures = json(&folder, "figures.json");
        let settings: Vec<&str> =
            figures.as_array().unwrap().iter().map(|report| report["setting"].as_str().unwrap()).collect();
        assert_eq!(settings, expected);
        for setting in expected {
            // One row of objects and three of stages.
            assert_eq!(run.stdout.matches(&format!("| {setting} ")).count(), 4, "{}", run.stdout);
        }
        // The last setting is that of the method alone.
        let last = &figures[expected.len() - 1];
        assert_eq!(last["total"]["counts"]["correct"], 6);
        folder.run(&format!("eval root --method {method} --json default.json"), 0);
        assert_eq!(last["scenes"], json(&folder, "default.json")["scenes"]);
    }
}

#[test]
fn the_support_forest_is_scored_on_synthetic_scenes() {
    let folder = Folder::new();
    let run = folder.run("eval --support 2 --seed 3 --json figures.json", 0);
    for word in
        ["scenes 3 to 4", "| own, all ", "| true, all ", "in against on:", "| of a horizontal camera "]
    {
        assert!(run.stdout.contains(word), "{word}: {}", run.stdout);
    }
    let figures = json(&folder, "figures.json");
    assert_eq!((&figures["first_seed"], &figures["scenes"]), (&3.into(), &2.into()));
    assert!(figures["own"]["precision"].as_f64() > Some(0.5), "{figures}");
    assert!(figures["families"]["stacked"]["truth"]["edges"]["right"].as_u64() > Some(3), "{figures}");
    assert_eq!(folder.run("eval --support 2 --seed 3 --threads 1", 0).stdout, run.stdout);
    for (arguments, said) in [
        ("--support 2 --method paper", "forest"),
        ("--support 2 --composites 2", "--composites"),
        ("--support 2 root", "ROOT"),
        ("--support 2 --ladder", "--ladder"),
        ("--support 0", "--support"),
        ("--seed 2", "--composites"),
        ("--family desk", "choose single, tabletop"),
        ("--family bin root", "ROOT"),
        ("--family bin --support 2", "--support"),
        ("--support 2 --sensor tof", "--sensor"),
        ("root --scenes 3", "--scenes"),
    ] {
        let run = folder.run(&format!("eval {arguments}"), 2);
        assert!(run.stderr.contains(said), "{arguments}: {}", run.stderr);
    }
}

#[test]
fn what_cannot_be_scored_is_named() {
    let folder = data_set();
    folder.run("segment root/left --out labels", 0);
    let run = folder.run("eval root --labels labels --json figures.json", 1);
    assert!(run.errors()[0].contains("scene10.labels.png"), "{}", run.stderr);
    assert_eq!((run.stderr.lines().count(), run.stdout.as_str()), (1, ""));
    assert!(!folder.path().join("figures.json").exists());
    folder.run("eval root --labels labels --split left", 0);
    let run = folder.run("eval root --labels labels --split left --suffix .png", 1);
    assert!(run.stderr.contains("scene1.png"), "{}", run.stderr);

    folder.write("labels/scene10.labels.png", b"noise");
    let run = folder.run("eval root --labels labels", 1);
    assert!(run.errors()[0].contains("scene10.labels.png"), "{}", run.stderr);
    let small = image::ImageBuffer::from_pixel(32, 24, image::Luma([1_u16]));
    small.save(folder.path().join("labels/scene10.labels.png")).unwrap();
    let run = folder.run("eval root --labels labels", 1);
    let said = run.errors()[0];
    assert!(said.contains("scene10") && said.contains("32x24") && said.contains("320x240"), "{said}");

    let run = folder.run("eval root --split middle", 1);
    assert!(run.stderr.contains("left") && run.stderr.contains("right"), "{}", run.stderr);
    assert!(folder.run("eval nowhere", 1).stderr.contains("nowhere"));
    folder.write("root/right/scene11.pcd", b"noise");
    let run = folder.run("eval root", 1);
    assert!(run.errors().len() == 1 && run.stderr.contains("scene11.pcd"), "{}", run.stderr);
}

#[test]
fn contradictions_are_mistakes_of_usage() {
    let folder = data_set();
    folder.run("segment root --out labels", 0);
    folder.write("empty.toml", b"");
    for (arguments, said) in [
        ("--labels labels --method paper", "--labels"),
        ("--labels labels --ablation", "--labels"),
        ("--labels labels --set curvature.threshold=0.1", "--labels"),
        ("--labels labels --config empty.toml", "--labels"),
        ("--suffix .png", "--labels"),
        ("--method paper --ablation --set graph.channels=depth", "leave out --set"),
        ("--set graph.chanels=depth", "`graph.channels`"),
        ("--json nowhere/figures.json", "nowhere"),
        ("--json root", "--json root is a folder: name a file"),
        ("--ablation --set sensor.color=none", "leave out --set"),
        ("--ladder --method paper", "say --method context"),
        ("--ladder --ablation", "--ladder"),
        ("--sensitivity --labels labels", "--labels"),
        ("--composites 3 --labels labels", "--labels"),
        ("--seed 3", "--composites"),
        ("--pictures drawn --labels labels", "--labels"),
        ("--pictures drawn --sensitivity", "--sensitivity"),
        ("--pictures empty.toml", "--pictures empty.toml is a file: name a folder"),
    ] {
        folder.refuses(&format!("eval root {arguments}"), said);
    }
}

#[test]
fn composed_scenes_are_a_folder_of_their_own() {
    let folder = data_set();
    let run = folder.run("eval root --split left --method context --composites 3 --json figures.json", 0);
    assert!(run.stdout.contains("\n| composite |"), "{}", run.stdout);
    assert!(run.stdout.contains("\ncomposite: correct "), "{}", run.stdout);
    let figures = json(&folder, "figures.json");
    assert_eq!(figures["folders"]["left"]["objects"], 4);
    assert_eq!(figures["folders"]["composite"]["scenes"], 3);
    let names: Vec<&String> = figures["scenes"].as_object().unwrap().keys().collect();
    assert_eq!(names, ["composite0", "composite1", "composite2", "scene1", "scene2"]);

    // The first of them by another seed is the second; threads change nothing.
    folder.run(
        "eval root --split left --method context --composites 1 --seed 1 --threads 1 --json one.json",
        0,
    );
    assert_eq!(json(&folder, "one.json")["scenes"]["composite1"], figures["scenes"]["composite1"]);
}

#[test]
fn the_ladder_ends_with_the_method_itself() {
    let folder = data_set();
    let run =
        folder.run("eval root --split left --method context --composites 1 --ladder --json figures.json", 0);
    let figures = json(&folder, "figures.json");
    let settings: Vec<&str> =
        figures.as_array().unwrap().iter().map(|r| r["setting"].as_str().unwrap()).collect();
    assert_eq!((settings[0], settings[19]), ("plane facets, convexity", "+ objectness"));
    assert_eq!((settings[20], settings.len()), ("without occlusion evidence", 38));
    assert_eq!(run.stdout.lines().count(), 40, "{}", run.stdout);
    folder.run("eval root --split left --method context --composites 1 --json method.json", 0);
    let without_stages = |mut report: serde_json::Value| {
        report["scenes"]
            .as_object_mut()
            .unwrap()
            .values_mut()
            .for_each(|s| _ = s.as_object_mut().unwrap().remove("stages"));
        report["scenes"].clone()
    };
    assert_eq!(figures[19]["scenes"], without_stages(json(&folder, "method.json")));
}

#[test]
fn the_sensitivity_goes_through_what_the_method_reads() {
    let folder = data_set();
    for (method, reads, other) in [
        ("paper", "curvature.threshold = 0.182", "border."),
        ("context", "border.gap_quanta = 2.8", "curvature."),
    ] {
        let run = folder.run(&format!("eval root --split right --method {method} --sensitivity"), 0);
        assert!(run.stdout.contains("\n| (nothing changed) "), "{}", run.stdout);
        assert!(run.stdout.contains(&format!("\n| {reads} ")), "{}", run.stdout);
        assert!(!run.stdout.contains(other), "{}", run.stdout);
        assert!(run.stdout.lines().last().unwrap().starts_with("right: "), "{}", run.stdout);
    }
}

#[test]
fn hard_scenes_are_drawn() {
    let folder = data_set();
    folder.run("eval root --method context --composites 1 --pictures drawn", 0);
    let pictures = folder.files("drawn");
    let names: Vec<&String> = pictures.keys().collect();
    assert_eq!(names, ["composite0.png", "scene1.png", "scene10.png", "scene2.png"]);
    let picture = image::load_from_memory(&pictures["scene1.png"]).unwrap();
    assert!(picture.width() > 4 * 320 && picture.height() > 240, "four tiles in a row");
}

/// One file without labels made an evaluation of all the others impossible.
#[test]
fn a_scene_without_labels_is_named_and_the_others_are_scored() {
    let folder = data_set();
    let whole = folder.run("eval root --per-scene", 0).stdout;
    let plain =
        String::from_utf8(Cloud::two_boxes(0.0).to_pcd()).unwrap().replace("rgba label", "rgba other");
    folder.write("root/left/scene3.pcd", plain.as_bytes());
    let run = folder.run("eval root --per-scene", 1);
    assert_eq!(run.stdout, whole);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    assert!(run.errors()[0].starts_with("error: root/left/scene3.pcd: no truth: "), "{}", run.stderr);

    let run = folder.run("eval root --split left --composites 1", 1);
    assert!(run.stdout.contains("\n| composite |"), "{}{}", run.stdout, run.stderr);
}

#[test]
fn options_that_help_are_named() {
    let folder = data_set();
    folder.write("root/other/scene1.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let run = folder.run("eval root", 1);
    assert!(run.errors()[0].ends_with("have the same name: evaluate one folder at a time with --split"));
}

/// The rows of the table of families: family, sensor, figures as text.
fn rows(stdout: &str) -> Vec<Vec<&str>> {
    let lines = stdout.lines().filter(|line| line.starts_with("| ")).skip(2);
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

#[test]
fn families_are_scored_sensor_by_sensor() {
    let folder = Folder::new();
    let run = folder.run("eval --family all --sensor kinect --scenes 1 --seed 7 --json figures.json", 0);
    assert!(
        run.stdout.starts_with("method context, synthetic scenes 7 to 7, holes none\n"),
        "{}",
        run.stdout
    );
    let figures = json(&folder, "figures.json");
    let (rows, lines) = (rows(&run.stdout), figures.as_array().unwrap());
    assert_eq!((rows.len(), lines.len()), (23, 23));
    let sum: u64 = lines[..22].iter().map(|line| line["objects"].as_u64().unwrap()).sum();
    assert_eq!((&lines[22]["family"], lines[22]["objects"].as_u64()), (&"all".into(), Some(sum)));
    for (row, line) in rows.iter().zip(lines) {
        assert_eq!((row[0], row[1]), (line["family"].as_str().unwrap(), "kinect"));
        assert_eq!((row[3], row[4]), (&*line["objects"].to_string(), &*line["hypotheses"].to_string()));
    }
    let empty: Vec<_> = rows.iter().filter(|row| row[0].starts_with("empty")).collect();
    assert!(empty.len() == 2 && empty.iter().all(|row| row[2] == "-" && row[3] == "0"), "{rows:?}");

    let two = folder.run("eval --family single --sensor all --scenes 1 --holes grid --method paper", 0);
    assert!(two.stdout.starts_with("method paper, synthetic scenes 0 to 0, holes grid\n"), "{}", two.stdout);
    let sensors: Vec<_> = self::rows(&two.stdout).iter().map(|row| row[1].to_owned()).collect();
    assert_eq!(sensors, ["kinect", "stereo", "tof", "ideal", "phone", "structured-light"]);
}

/// The least a method may score on eight tables: share of the objects correct, average precision.
struct Floor {
    method: &'static str,
    correct: f64,
    precision: f64,
}

/// Measured when this was written, of 35 objects: `context` 0.971 and 1.000, `paper` 0.629 and 0.743.
const FLOORS: [Floor; 2] = [
    Floor { method: "context", correct: 0.91, precision: 0.96 },
    Floor { method: "paper", correct: 0.57, precision: 0.68 },
];

#[test]
fn no_method_falls_below_its_floor() {
    for Floor { method, correct, precision } in FLOORS {
        let folder = Folder::new();
        let run = folder.run(&format!("eval --family tabletop --scenes 8 --method {method}"), 0);
        let rows = rows(&run.stdout);
        assert_eq!(rows.len(), 1, "{}", run.stdout);
        assert!(rows[0][2].parse::<f64>().unwrap() >= correct, "{method}: {}", run.stdout);
        assert!(rows[0][6].parse::<f64>().unwrap() >= precision, "{method}: {}", run.stdout);
        assert_eq!(folder.names(""), Vec::<String>::new(), "nothing is written");
    }
}

/// By way of files it is the same, on any number of threads.
#[test]
fn eval_of_families_is_eval_of_their_files() {
    let folder = Folder::new();
    let here = folder.run("eval --family stacked --scenes 6 --method paper --threads 1", 0);
    assert_eq!(folder.run("eval --family stacked --scenes 6 --method paper", 0).stdout, here.stdout);
    folder.run("synth --out scenes --scenes 6 --family stacked", 0);
    folder.run(
        "segment --method paper --color scenes/*-color.png --depth scenes/*-depth.png --camera scenes/camera.json \
         --out found --write labels",
        0,
    );
    folder.run("eval scenes --labels found --json figures.json", 0);
    let total = &json(&folder, "figures.json")["total"];
    let rows = rows(&here.stdout);
    let share = format!("{:.3}", total["correct"].as_f64().unwrap());
    let counts = [&total["objects"], &total["hypotheses"]].map(|count| count.to_string());
    assert_eq!(rows[0][2..5], [share, counts[0].clone(), counts[1].clone()]);
    let off = total["hypotheses_off_objects"].as_f64().unwrap() / 6.0;
    assert_eq!(rows[0][5], format!("{off:.2}"));
}
