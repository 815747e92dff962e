//! `objecthood synth`, and what `segment` and `eval` make of its files.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::{Folder, command};
use serde_json::Value;

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

fn size_and_depth(bytes: &[u8]) -> (u32, u32, image::ColorType) {
    let image = image::load_from_memory(bytes).unwrap();
    (image.width(), image.height(), image.color())
}

fn labels(bytes: &[u8]) -> Vec<u16> {
    image::load_from_memory(bytes).unwrap().into_luma16().into_raw()
}

/// The commands that the program proposes, without its name.
fn next(stdout: &str) -> Vec<&str> {
    let (_, next) = stdout.split_once("next:\n").unwrap();
    next.lines().map(|line| line.split_once("objecthood ").unwrap().1).collect()
}

#[test]
fn every_scene_has_all_its_files_and_they_agree() {
    let folder = Folder::new();
    let run = folder.run("synth --out out --scenes 7 --seed 3", 0);
    assert_eq!(run.stderr, "7 of 7 scenes done\n");
    let files = folder.files("out");
    let families = ["single", "tabletop", "stacked", "occluded", "vessels", "clutter", "single"];
    for (family, seed) in families.iter().zip(3..) {
        let name = format!("{family}{seed}");
        assert!(run.stdout.contains(&format!("{name}: ")), "{}", run.stdout);
        assert_eq!(size_and_depth(&files[&format!("{name}-color.png")]), (640, 480, image::ColorType::Rgb8));
        for kind in ["depth", "truth", "surfaces"] {
            let file = &files[&format!("{name}-{kind}.png")];
            assert_eq!(size_and_depth(file), (640, 480, image::ColorType::L16));
        }
        let scene = json(&files[&format!("{name}-scene.json")]);
        assert_eq!(
            (&scene["family"], &scene["seed"], &scene["sensor"]),
            (&(*family).into(), &seed.into(), &"kinect".into())
        );
        let solids = scene["solids"].as_array().unwrap();
        let labels = |kind: &str| labels(&files[&format!("{name}-{kind}.png")]);
        let (truth, surfaces) = (labels("truth"), labels("surfaces"));
        for (k, solid) in solids.iter().enumerate() {
            let own = || truth.iter().zip(&surfaces).filter(|&(&instance, _)| usize::from(instance) == k + 1);
            assert_eq!(solid["size_px"], own().count(), "{name} {solid}");
            let [first, last] = [0, 1].map(|end| solid["surfaces"][end].as_u64().unwrap());
            assert!(own().all(|(_, &surface)| (first..=last).contains(&surface.into())), "{name} {solid}");
            assert!(solid["pose"]["origin_m"].is_array() && solid["visible_fraction"].is_number());
        }
        assert!(!scene["contacts"].as_array().unwrap().is_empty());
        assert!(files[&format!("{family}/{name}.pcd")].starts_with(b"# .PCD v0.7"));
    }
    assert_eq!(files.len(), 7 * 6 + 1, "{:?}", files.keys());
    assert_eq!(json(&files["camera.json"])["depth_scale"], 10_000.0);
}

#[test]
fn the_proposed_commands_work_as_they_are() {
    let folder = Folder::new();
    let run = folder.run("synth --out out --scenes 2 --seed 10 --family stacked", 0);
    let next = next(&run.stdout);
    assert_eq!(next.len(), 3, "{}", run.stdout);
    let unquoted = |command: &str| command.replace('\'', "");
    let run = folder.run(&unquoted(next[0]), 0);
    assert_eq!(run.stdout.matches(" objects -> ").count(), 2, "{}", run.stdout);
    assert_eq!(
        folder.names("out/found"),
        [
            "stacked10.json",
            "stacked10.labels.png",
            "stacked10.panels.png",
            "stacked11.json",
            "stacked11.labels.png",
            "stacked11.panels.png"
        ]
    );
    // By way of images or of points: the same objects of the same truth, but for the rounding of depth to 0.1 mm, which
    // may decide where two borders of a pile balance; these stacks are not so.
    let correct = |stdout: &str| -> (usize, usize) {
        let counts = stdout.split_once('(').unwrap().1.split_once(')').unwrap().0;
        let (correct, all) = counts.split_once('/').unwrap();
        (correct.parse().unwrap(), all.parse().unwrap())
    };
    let images = correct(&folder.run(&unquoted(next[1]), 0).stdout);
    let points = correct(&folder.run(&unquoted(next[2]), 0).stdout);
    assert!(
        images.1 >= 6 && images.1 == points.1 && images.0.abs_diff(points.0) <= 1,
        "{images:?} {points:?}"
    );
}

#[test]
fn commands_for_a_folder_with_a_strange_name_are_quoted() {
    let folder = Folder::new();
    let output = command()
        .current_dir(folder.path())
        .args(["synth", "--scenes", "1", "--out", "it's mine"])
        .output()
        .unwrap();
    let stdout = String::from_utf8(output.stdout).unwrap();
    let last = stdout.lines().last().unwrap().trim();
    assert!(last.ends_with(r"objecthood eval 'it'\''s mine'"), "{last}");
}

#[test]
fn the_same_number_is_the_same_scene() {
    let folder = Folder::new();
    folder.run("synth --out all --scenes 3 --seed 4 --threads 1", 0);
    let all = folder.files("all");
    for threads in [2, 5] {
        folder.run(&format!("synth --out threads{threads} --scenes 3 --seed 4 --threads {threads}"), 0);
        assert!(folder.files(&format!("threads{threads}")) == all);
    }
    // Alone it is what it was among others.
    folder.run("synth --out alone --scenes 1 --seed 5 --family tabletop", 0);
    for (name, bytes) in folder.files("alone") {
        assert!(all[&name] == bytes, "{name}");
    }
    folder.run("synth --out other --scenes 1 --seed 5 --family tabletop --sensor tof", 0);
    let other = folder.files("other");
    assert!(other["tabletop5-color.png"] == all["tabletop5-color.png"]);
    assert!(other["tabletop5-depth.png"] != all["tabletop5-depth.png"]);
    assert_eq!(json(&other["tabletop5-scene.json"])["sensor"], "tof");
}

#[test]
fn images_have_the_size_and_the_holes_that_were_asked_for() {
    let folder = Folder::new();
    folder
        .run("synth --out small --scenes 1 --family robot-arm --size 320x240 --holes grid --sensor phone", 0);
    let files = folder.files("small");
    assert_eq!(size_and_depth(&files["robot-arm0-depth.png"]), (320, 240, image::ColorType::L16));
    let camera = json(&files["camera.json"]);
    assert_eq!((&camera["fx"], &camera["cx"], &camera["width"]), (&262.5.into(), &159.5.into(), &320.into()));
    let depth = labels(&files["robot-arm0-depth.png"]);
    let holes = depth.iter().filter(|&&z| z == 0).count();
    assert_eq!(holes, 320 * 240 / 25);
    let scene = json(&files["robot-arm0-scene.json"]);
    assert_eq!(
        (&scene["family"], &scene["sensor"], &scene["holes"]),
        (&"robot-arm".into(), &"phone".into(), &"grid".into())
    );
}

#[test]
fn mistakes_are_explained_and_nothing_is_done() {
    let folder = Folder::new();
    folder.write("file", b"content");
    for (arguments, said) in [
        ("--out out --scenes 0", "give a whole number from 1 to 1000000"),
        ("--out out --scenes many", "give a whole number from 1 to 1000000"),
        ("--out out", "--scenes"),
        ("--scenes 1", "--out"),
        ("--out out --scenes 1 --family desk", "choose single, tabletop, stacked"),
        (
            "--out out --scenes 1 --sensor lidar",
            "choose kinect, stereo, tof, ideal, phone or structured-light",
        ),
        ("--out out --scenes 1 --holes moth", "choose none or grid"),
        ("--out out --scenes 1 --size 640", "as in 1280x960"),
        ("--out out --scenes 1 --size 640x0", "as in 1280x960"),
        ("--out out --scenes 1 --seed -1", "-1"),
        ("--out out --scenes 1 --seed 4294967296", "4294967296"),
        ("--out file --scenes 1", "--out file is a file: name a folder"),
        ("--out out --scenes 1 --threads 0", "--threads"),
    ] {
        folder.refuses(&format!("synth {arguments}"), said);
    }
    let run = folder.run("synth --out file/below --scenes 1", 1);
    assert!(run.errors()[0].contains("cannot make the folder file/below"), "{}", run.stderr);
    assert_eq!(folder.names(""), ["file"]);
}

#[test]
fn a_scene_that_cannot_be_written_leaves_nothing_and_the_others_are_done() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.path().join("out/single0-scene.json")).unwrap();
    let run = folder.run("synth --out out --scenes 2", 1);
    let errors = run.errors();
    assert_eq!(errors.len(), 1, "{}", run.stderr);
    assert!(
        errors[0].starts_with("error: single0: ") && errors[0].contains("single0-scene.json"),
        "{}",
        errors[0]
    );
    assert!(run.stderr.ends_with("1 of 2 scenes done, 1 failed\n"), "{}", run.stderr);
    let names = folder.names("out");
    assert_eq!(names.len(), 7, "{names:?}");
    assert!(names.iter().all(|name| name == "camera.json" || name.contains("tabletop1")), "{names:?}");
}

#[test]
fn a_video_has_an_image_of_every_frame_and_its_truth() {
    let folder = Folder::new();
    for (clip, expected) in [("empty", &[][..]), ("pick", &["picked_up", "placed_on"])] {
        let run = folder.run(&format!("synth --out out --video {clip} --seed 4 --fps 5 --size 64x48"), 0);
        assert!(run.stdout.contains(&format!("{clip}4: ")), "{}", run.stdout);
        let files = folder.files(&format!("out/{clip}4"));
        let count = json(&files["clip.json"])["frames"].as_u64().unwrap() as usize;
        let text = |name: &str| String::from_utf8(files[name].clone()).unwrap();
        for list in ["rgb.txt", "depth.txt", "groundtruth.txt"] {
            assert_eq!(
                text(list).lines().filter(|line| !line.starts_with('#')).count(),
                count,
                "{clip} {list}"
            );
        }
        assert_eq!(text("truth.jsonl").lines().count(), count, "{clip}");
        for kind in ["color", "depth", "truth"] {
            let images: Vec<_> = files.keys().filter(|name| name.starts_with(&format!("{kind}/"))).collect();
            assert_eq!(images.len(), count, "{clip} {kind}");
            assert!(images.iter().all(|name| size_and_depth(&files[*name]).0 == 64), "{clip} {kind}");
        }
        let events: Vec<Value> = text("events.jsonl").lines().map(|line| json(line.as_bytes())).collect();
        let types: Vec<_> = events.iter().map(|event| event["type"].as_str().unwrap()).collect();
        assert_eq!(types, expected, "{clip}");
        let [proposed] = next(&run.stdout)[..] else { panic!("{}", run.stdout) };
        folder.run(proposed, 0);
    }
}

#[test]
fn unknown_videos_and_options_of_scenes_are_refused_with_advice() {
    let folder = Folder::new();
    let run = folder.run("synth --out out --video juggle", 2);
    assert!(run.stderr.contains("juggle") && run.stderr.contains("push-flush"), "{}", run.stderr);
    let run = folder.run("synth --out out --video pick --fps 0", 2);
    assert!(run.stderr.contains("5"), "{}", run.stderr);
    let run = folder.run("synth --out out", 2);
    assert!(run.stderr.contains("--scenes"), "{}", run.stderr);
}
