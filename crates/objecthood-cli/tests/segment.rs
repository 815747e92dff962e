//! `objecthood segment` on good frames.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::Folder;
use common::photo::png;
use common::scene::Cloud;

fn scenes() -> Folder {
    let folder = Folder::new();
    for k in [1, 2, 3, 10] {
        let cloud = Cloud::two_boxes(0.01 * f64::from(k));
        folder.write(&format!("in/scene{k}.pcd"), &cloud.to_binary_pcd());
    }
    folder
}

fn labels(bytes: &[u8]) -> image::ImageBuffer<image::Luma<u16>, Vec<u16>> {
    match image::load_from_memory(bytes).unwrap() {
        image::DynamicImage::ImageLuma16(labels) => labels,
        other => panic!("not 16-bit grey: {:?}", other.color()),
    }
}

#[test]
fn two_boxes_on_a_table_are_two_objects() {
    let folder = Folder::new();
    let cloud = Cloud::two_boxes(0.0);
    folder.write("a.b.pcd", &cloud.to_pcd());
    let run = folder.run("segment a.b.pcd --out new/out --write labels,json,panels", 0);
    assert!(run.stdout.starts_with("a.b.pcd: 2 objects\n"), "{}", run.stdout);
    assert_eq!(run.stderr, "");

    let files = folder.files("new/out");
    assert_eq!(files.keys().collect::<Vec<_>>(), ["a.b.json", "a.b.labels.png", "a.b.panels.png"]);
    for name in files.keys() {
        assert!(run.stdout.contains(&format!("new/out/{name}")), "{}", run.stdout);
    }
    let scene: serde_json::Value = serde_json::from_slice(&files["a.b.json"]).unwrap();
    let objects = scene["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 2);
    // Each object covers its box and nothing else, but for the borders.
    let labels = labels(&files["a.b.labels.png"]);
    assert_eq!(labels.dimensions(), (320, 240));
    let mut hit = std::collections::BTreeMap::new();
    for (point, label) in cloud.points.iter().zip(labels.iter()) {
        *hit.entry((point.label, *label)).or_insert(0) += 1;
    }
    for truth in [20, 30] {
        let all: i32 = hit.iter().filter(|(key, _)| key.0 == truth).map(|(_, n)| n).sum();
        let best = hit.iter().filter(|(key, _)| key.0 == truth && key.1 > 0).map(|(_, n)| *n).max().unwrap();
        assert!(f64::from(best) > 0.9 * f64::from(all), "{hit:?}");
    }
    assert!(image::load_from_memory(&files["a.b.panels.png"]).unwrap().width() > 3 * 320);
}

#[test]
fn scene_files_obey_the_published_schema() {
    let schema = std::fs::read(common::workspace().join("docs/scene.schema.json")).unwrap();
    let schema = serde_json::from_slice(&schema).unwrap();
    let schema = jsonschema::validator_for(&schema).unwrap();
    let folder = scenes();
    // Without objects, without a plane, without colour differences, one pixel.
    folder.write("in/grey.pcd", &Cloud::two_boxes(0.0).map(|p| p.color = [9; 3]).to_binary_pcd());
    let table = Cloud::two_boxes(9.0);
    folder.write("in/table.pcd", &table.to_binary_pcd());
    let pixel = Cloud { width: 1, height: 1, points: vec![table.points[200 * 320 + 160]] };
    folder.write("one/pixel.pcd", &pixel.to_binary_pcd());
    folder.run("segment in --out out", 0);
    folder.run("segment in --out out/camera --set gravity.up_from=camera", 0);
    folder.run("segment one --camera 525,525,0,0 --out out", 0);
    let scenes: Vec<_> =
        folder.files("out").into_iter().filter(|(name, _)| name.ends_with(".json")).collect();
    assert_eq!(scenes.len(), 13);
    for (name, bytes) in scenes {
        let scene = serde_json::from_slice(&bytes).unwrap();
        let complaints: Vec<String> = schema.iter_errors(&scene).map(|e| e.to_string()).collect();
        assert!(complaints.is_empty(), "{name}: {complaints:#?}");
    }
}

#[test]
fn a_single_pixel_and_a_scene_without_a_plane_are_no_errors() {
    let folder = Folder::new();
    let pixel = Cloud { width: 1, height: 1, points: vec![Cloud::two_boxes(0.0).points[200 * 320 + 160]] };
    folder.write("pixel.pcd", &pixel.to_pcd());
    let run = folder.run("segment pixel.pcd --camera 525,525,0,0 --out out --write labels,json,panels", 0);
    assert!(run.stdout.starts_with("pixel.pcd: 0 objects\n"), "{}", run.stdout);
    assert!(run.stderr.starts_with("note: pixel.pcd: no plane"), "{}", run.stderr);
    assert_eq!(labels(&folder.files("out")["pixel.labels.png"]).into_raw(), [0]);
}

/// A camera of so few pixels across that one pixel is no less than an object has.
#[test]
fn a_single_point_is_no_object_of_size_0() {
    let folder = Folder::new();
    let pixel = Cloud { width: 1, height: 1, points: vec![Cloud::two_boxes(0.0).points[200 * 320 + 160]] };
    folder.write("pixel.pcd", &pixel.to_pcd());
    for method in ["context", "paper"] {
        let run = folder.run(&format!("segment pixel.pcd --camera 10,10,0,0 --out out --method {method}"), 0);
        assert!(run.stdout.starts_with("pixel.pcd: 0 objects\n"), "{}", run.stdout);
    }
}

/// Label images look black in every viewer.
#[test]
fn an_overlay_is_the_picture_with_outlines_and_numbers() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let run = folder.run("segment a.pcd --out out --write overlay,labels", 0);
    assert!(run.stdout.ends_with("out/a.labels.png\nout/a.overlay.png\n"), "{}", run.stdout);
    let files = folder.files("out");
    let overlay = image::load_from_memory(&files["a.overlay.png"]).unwrap().into_rgb8();
    let labels = labels(&files["a.labels.png"]);
    assert_eq!(overlay.dimensions(), labels.dimensions());
    let changed = |object: u16| {
        let own = labels.enumerate_pixels().filter(|(.., label)| label.0[0] == object);
        // The boxes of the scene are of one colour each, the table is grey.
        let colors: std::collections::BTreeSet<_> = own.map(|(u, v, _)| overlay.get_pixel(u, v).0).collect();
        colors.len()
    };
    assert!(changed(1) > 2 && changed(2) > 2, "outline, number and box: {} {}", changed(1), changed(2));
    assert!(changed(0) < 20, "only what the labels leave out of the boxes, and digits: {}", changed(0));
}

#[test]
fn results_are_the_same_for_any_number_of_threads_and_from_run_to_run() {
    let folder = scenes();
    let all = "segment in --write labels,json,panels --out";
    folder.run(&format!("{all} first --threads 1"), 0);
    let first = folder.files("first");
    assert_eq!(first.len(), 12);
    for (out, threads) in [("again", 1), ("two", 2), ("eight", 8)] {
        folder.run(&format!("{all} {out} --threads {threads}"), 0);
        assert!(folder.files(out) == first, "{threads} threads");
    }
    // A frame alone has all threads to itself.
    folder.run("segment in/scene2.pcd --out alone --threads 8", 0);
    assert_eq!(folder.files("alone")["scene2.labels.png"], first["scene2.labels.png"]);
}

#[test]
fn folders_are_searched_below_and_results_come_in_natural_order() {
    let folder = scenes();
    let cloud = Cloud::two_boxes(0.0);
    folder.write("in/deeper/still/Last.PCD", &cloud.to_pcd());
    folder.write("in/notes.txt", b"no point cloud");
    let run = folder.run("segment in/scene3.pcd in ./in/../in/scene3.pcd --out out", 0);
    let frames: Vec<&str> = run.stdout.lines().map(|line| line.split(": ").next().unwrap()).collect();
    let order =
        ["in/scene3.pcd", "in/deeper/still/Last.PCD", "in/scene1.pcd", "in/scene2.pcd", "in/scene10.pcd"];
    assert_eq!(frames, order, "each once");
    assert_eq!(run.stderr, "5 of 5 frames done\n");
    assert_eq!(folder.names("out").len(), 10);
}

#[test]
fn frames_are_selected_by_their_number() {
    let folder = scenes();
    let run = folder.run("segment in --out out --write labels --frames 1..:2", 0);
    assert_eq!(folder.names("out"), ["scene10.labels.png", "scene2.labels.png"], "{}", run.stdout);
    folder.refuses(
        "segment in --out none --frames 700..",
        "there is no frame in --frames 700..: no input has more than ",
    );
    // A regression: seconds were asked for, and frames were told.
    folder.run("synth --video empty --fps 5 --size 160x120 --out video", 0);
    let has = "18 frames, numbered from 0, at times from 0 to 3.400 s";
    folder.refuses(
        "segment video/empty0 --out none --time 100..",
        &format!("there is no frame in --time 100..: the longest input has {has}"),
    );
    folder.run("convert in --to tum --frames 2 --out short", 0);
    let run = folder.run("segment short video/empty0 --out part --time 0.05..", 0);
    let said = "short: it has no frame in --time 0.05.., but 1 frame, numbered from 0";
    assert!(run.stderr.contains(said), "{}", run.stderr);
    folder.refuses("segment in --out out --frames 5..2", "`5..2` is not a range of frames: write first..end");
    folder.refuses("segment in --out out --time soon", "`soon` is not a range of times");
    let run = folder.run("segment in --out out --time 1..2", 1);
    assert!(
        run.errors()[0].contains("the frame has no time")
            && run.errors()[0].ends_with("use --frames instead of --time")
    );
}

/// The error named --range, --roi and --mask, also those that were not given.
#[test]
fn a_frame_that_an_option_empties_fails_alone_and_the_option_is_named() {
    let folder = scenes();
    folder.write("in/scene2.pcd", &Cloud::two_boxes(0.0).map(|point| point.xyz_m[2] += 9.0).to_binary_pcd());
    let run = folder.run(
        "segment in --out out --write labels --camera 262.5,262.5,159.5,119.5 --range ..5 --roi 0,0,320,240",
        1,
    );
    assert_eq!(run.errors().len(), 1);
    let error = run.errors()[0];
    assert!(error.starts_with("error: in/scene2.pcd: none of the "), "{error}");
    assert!(error.ends_with(" lies within the range of depths: widen --range"), "{error}");
    assert!(run.stderr.ends_with("3 of 4 frames done, 1 failed\n"), "{}", run.stderr);
    assert_eq!(folder.names("out"), ["scene1.labels.png", "scene10.labels.png", "scene3.labels.png"]);
}

/// The error led to `points`: of a video it is called `pictures`.
#[test]
fn pictures_are_overlays() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.run("segment a.pcd --out out --write pictures", 0);
    assert_eq!(folder.names("out"), ["a.overlay.png"]);
}

#[test]
fn equal_stems_are_refused_or_kept_apart() {
    let folder = Folder::new();
    for (k, name) in ["left/a.pcd", "right/a.pcd", "right/deep/a.pcd", "right/deep/b.pcd"].iter().enumerate()
    {
        folder.write(name, &Cloud::two_boxes(0.02 * k as f64).to_binary_pcd());
    }
    for inputs in ["left right", "left/a.pcd right/a.pcd", "left ./right/deep/a.pcd", "right"] {
        let run = folder.run(&format!("segment {inputs} --out out"), 2);
        assert_eq!(run.errors().len(), 1);
        assert_eq!(run.stderr.matches("a.pcd").count(), 2, "both are named: {}", run.stderr);
        assert!(run.stderr.contains("--keep-tree"), "{}", run.stderr);
        assert!(!folder.path().join("out").exists());
    }
    let written = |inputs: &str, out: &str| {
        folder.run(&format!("segment {inputs} --out {out} --keep-tree --write labels"), 0);
        folder.names(out)
    };
    assert_eq!(written("right", "one"), ["a.labels.png", "deep/a.labels.png", "deep/b.labels.png"]);
    assert_eq!(
        written("left right", "two"),
        ["left/a.labels.png", "right/a.labels.png", "right/deep/a.labels.png", "right/deep/b.labels.png"]
    );
    assert_eq!(
        written("left/a.pcd right/deep/a.pcd", "files"),
        ["left/a.labels.png", "right/deep/a.labels.png"]
    );

    folder.write("right/a.PCD", &Cloud::two_boxes(0.0).to_binary_pcd());
    if folder.names("right").len() == 4 {
        let run = folder.run("segment right/a.pcd right/a.PCD --out out --keep-tree", 2);
        assert!(run.stderr.contains("rename"), "{}", run.stderr);
    }
}

#[test]
fn a_log_tells_the_time_of_every_stage() {
    let folder = scenes();
    let run = folder.run("segment in -v --out out", 0);
    for stage in
        ["reading", "normals", "superpixels", "facets", "shapes", "support", "objects", "encoding", "writing"]
    {
        assert_eq!(run.stderr.matches(&format!("{stage} ")).count(), 4, "{stage}: {}", run.stderr);
    }
}

#[test]
fn a_closed_pipe_does_not_keep_frames_from_being_written() {
    let folder = scenes();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_objecthood"));
    command.current_dir(folder.path()).args(["segment", "in", "--out", "out"]);
    let mut child = command.stdout(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert_eq!(folder.names("out").len(), 8);
}

#[test]
#[cfg(target_os = "linux")]
fn names_need_not_be_unicode() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    let good = folder.write("good.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let odd = folder.path().join(OsStr::from_bytes(b"in/\xff\xfe.pcd"));
    std::fs::create_dir(folder.path().join("in")).unwrap();
    std::fs::rename(good, &odd).unwrap();
    let out = OsStr::from_bytes(b"out\xfd");
    common::command().current_dir(folder.path()).args(["segment", "in", "--out"]).arg(out).assert().success();
    for suffix in [b".json" as &[u8], b".labels.png"] {
        assert!(folder.path().join(out).join(OsStr::from_bytes(&[b"\xff\xfe", suffix].concat())).is_file());
    }
}

/// `camera.json` beside `camera-depth.png` became its scene file.
#[test]
fn outputs_do_not_replace_what_is_read() {
    let folder = Folder::new();
    let cloud = Cloud::two_boxes(0.0);
    let (depth, color) = (png(&cloud.depth(1000.0)), png(&cloud.color()));
    folder.write("camera-depth.png", &depth);
    folder.write("camera.labels.png", &color);
    folder.write(
        "camera.json",
        br#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5, "depth_scale": 1000}"#,
    );
    folder.write("cloud.json", &cloud.to_binary_pcd());
    folder.write("tum/depth/camera.png", &depth);
    folder.write("tum/rgb/camera.png", &color);
    folder.write("tum/rgb.txt", b"0 rgb/camera.png\n");
    folder.write("tum/depth.txt", b"0 depth/camera.png\n");
    folder.write(
        "tum/camera.json",
        br#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5, "depth_scale": 1000}"#,
    );
    let before = folder.files("");

    let images = "--depth camera-depth.png --color camera.labels.png --camera camera.json";
    for (arguments, replaced) in [
        (format!("{images} --out ."), "./camera.labels.png"),
        (format!("{images} --out . --write json"), "./camera.json"),
        (format!("{images} --out tum/.. --mask camera.labels.png"), "tum/../camera.labels.png"),
        ("cloud.json --out .".to_owned(), "./cloud.json"),
        ("tum --out tum".to_owned(), "tum/camera.json"),
    ] {
        let run = folder.run(&format!("segment {arguments}"), 2);
        let said = format!("error: {replaced} is read, so it cannot be written too: choose another --out\n");
        assert_eq!(run.stderr, said, "{arguments}");
        assert!(folder.files("") == before, "{arguments}");
    }
    folder.run(&format!("segment {images} --out . --write panels"), 0);
    folder.run("segment tum --out tum --write labels", 0);
}
