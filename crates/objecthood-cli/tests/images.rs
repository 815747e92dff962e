//! `objecthood segment` on images.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::photo::{camera, encoded, png};
use common::scene::Cloud;
use common::{Folder, Run};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};

/// Three pairs in one folder, with an image that is neither.
fn stills() -> Folder {
    let folder = Folder::new();
    for k in [1, 2, 10] {
        folder.write_pair("in", &k.to_string(), &Cloud::two_boxes(0.01 * f64::from(k)));
    }
    folder.write("in/1-label.png", &png(&ImageBuffer::from_pixel(9, 9, Luma([0_u8])).into()));
    folder
}

/// Camera and unit of [`stills`].
fn how() -> String {
    format!("--camera {} --depth-scale 10000", camera())
}

fn labels(bytes: &[u8]) -> Vec<u16> {
    match image::load_from_memory(bytes).unwrap() {
        DynamicImage::ImageLuma16(labels) => labels.into_raw(),
        other => panic!("not 16-bit grey: {:?}", other.color()),
    }
}

/// Nothing was found and nothing was said.
#[test]
fn a_depth_scale_against_that_of_the_camera_file_is_pointed_out() {
    let folder = stills();
    let [fx, fy, cx, cy] = [0, 1, 2, 3].map(|k| camera().split(',').nth(k).unwrap().to_owned());
    let json = format!(r#"{{"fx": {fx}, "fy": {fy}, "cx": {cx}, "cy": {cy}, "depth_scale": 10000}}"#);
    folder.write("camera.json", json.as_bytes());
    let said = |scale: &str| {
        let run = format!("segment --depth in/1-depth.png --camera camera.json {scale} --out out");
        folder.run(&run, 0).stderr
    };
    let note = said("--depth-scale 5000");
    assert!(
        note.starts_with("note: --depth-scale 5000 replaces the depth scale 10000 of camera.json"),
        "{note}"
    );
    assert!(note.contains("2 times as far away"), "{note}");
    assert!(!said("--depth-scale 10000").contains("replaces") && !said("").contains("replaces"));
}

/// What stdout says of every frame.
fn counts(run: &Run) -> Vec<(&str, &str)> {
    let lines = run.stdout.lines().filter(|line| line.contains(" objects -> "));
    lines.map(|line| line.split(" -> ").next().unwrap().split_once(": ").unwrap()).collect()
}

#[test]
fn one_pair_is_one_frame() {
    let folder = stills();
    let run = folder.run(
        &format!(
            "segment --color in/1-color.png --depth in/1-depth.png {} --out out --write labels,json,panels",
            how()
        ),
        0,
    );
    assert!(run.stdout.starts_with("in/1-depth.png: 2 objects\n"), "{}", run.stdout);
    assert_eq!(run.stderr, "");
    assert_eq!(folder.names("out"), ["1.json", "1.labels.png", "1.panels.png"]);
    let scene: serde_json::Value = serde_json::from_slice(&folder.files("out")["1.json"]).unwrap();
    assert_eq!(scene["input"], "in/1-depth.png");
    assert_eq!(scene["camera"]["fx_px"], 262.5);
    assert!(scene["camera"].get("fit_residual_px").is_none());
    // Any two files are a pair, named by the depth.
    folder.write("left.png", &folder.files("in")["1-color.png"]);
    folder.run(&format!("segment --color left.png --depth in/1-depth.png {} --out pair", how()), 0);
    assert_eq!(folder.files("pair")["1.labels.png"], folder.files("out")["1.labels.png"]);
}

#[test]
fn folders_and_patterns_are_the_same_pairs() {
    let folder = stills();
    folder.run(&format!("segment --color in --depth in {} --out all", how()), 0);
    let all = folder.files("all");
    assert_eq!(
        all.keys().collect::<Vec<_>>(),
        ["1.json", "1.labels.png", "10.json", "10.labels.png", "2.json", "2.labels.png"]
    );
    for (k, arguments) in [
        // Not the shell but the program expands these, because it is not started by a shell.
        "--color in/*-color.png --depth in/*-depth.png",
        "--color in --depth in/?-depth.png in/10-depth.png",
        "--color in/10-color.png in/1-color.png in/2-color.png --depth in",
        "--depth in/*depth* --color in/*color*",
    ]
    .iter()
    .enumerate()
    {
        let run = folder.run(&format!("segment {arguments} {} --out out{k}", how()), 0);
        let two = "2 objects";
        assert_eq!(
            counts(&run),
            [("in/1-depth.png", two), ("in/2-depth.png", two), ("in/10-depth.png", two)],
            "{}",
            run.stderr
        );
        assert!(folder.files(&format!("out{k}")) == all, "{arguments}");
    }
    // In two folders the names are equal, and colour may be a JPEG.
    for k in [1, 2, 10] {
        let cloud = Cloud::two_boxes(0.01 * f64::from(k));
        folder.write(&format!("rgb/{k}.jpg"), &encoded(&cloud.color(), ImageFormat::Jpeg));
        folder.write(&format!("depth/{k}.png"), &png(&cloud.depth(10_000.0)));
    }
    let run = folder.run(&format!("segment --color rgb --depth depth {} --out two", how()), 0);
    assert_eq!(counts(&run).len(), 3);
    assert_eq!(folder.names("two"), all.keys().cloned().collect::<Vec<_>>());
}

#[test]
fn equal_keys_in_two_folders_are_kept_apart() {
    let folder = Folder::new();
    for place in ["a", "b"] {
        folder.write_pair(place, "1", &Cloud::two_boxes(0.0));
    }
    let run = folder.run(&format!("segment --depth a b {} --out out", how()), 2);
    assert!(run.stderr.contains("--keep-tree"), "{}", run.stderr);
    folder.run(&format!("segment --depth a b {} --out out --keep-tree --write labels", how()), 0);
    assert_eq!(folder.names("out"), ["a/1.labels.png", "b/1.labels.png"]);
    let run = folder.run(&format!("segment --depth a --color a b {} --out no", how()), 2);
    assert!(run.stderr.contains("a/1-color.png and b/1-color.png are both the color image of `1`"));
}

#[test]
fn depth_alone_is_a_frame() {
    let folder = stills();
    let run = folder.run(&format!("segment --depth in {} --out out", how()), 0);
    assert_eq!(counts(&run).len(), 3);
    assert_eq!(folder.names("out").len(), 6);
}

/// The label images and panels of the first run were depth images to the second.
#[test]
fn a_second_run_into_the_folder_of_the_images_does_the_same() {
    let folder = Folder::new();
    for k in [1, 2] {
        folder.write(&format!("in/{k}.png"), &png(&Cloud::two_boxes(0.01 * f64::from(k)).depth(10_000.0)));
    }
    let again =
        || folder.run(&format!("segment --depth in {} --out in --write labels,structure,panels", how()), 0);
    let first = again();
    assert_eq!(counts(&first).len(), 2);
    let files = folder.files("in");
    assert_eq!(again().stdout, first.stdout);
    assert!(folder.files("in") == files);
}

/// `--camera <(..)` was no file.
#[cfg(target_os = "linux")]
#[test]
fn a_camera_may_come_through_a_pipe() {
    let folder = stills();
    let json = r#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5, "depth_scale": 10000}"#;
    let piped = |json: &str| {
        let mut command = common::command();
        command.current_dir(folder.path()).args(["segment", "--depth", "in/1-depth.png", "--out", "out"]);
        command.args(["--camera", "/dev/stdin"]).write_stdin(json).output().unwrap()
    };
    assert_eq!(piped(json).status.code(), Some(0));
    let refused = piped("\0\0\0\0");
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(said.starts_with("error: --camera /dev/stdin: not a camera file"), "{said}");
}

#[test]
fn camera_files_are_read() {
    let folder = stills();
    let with_numbers = format!("segment --depth in/1-depth.png {} --out numbers", how());
    folder.run(&with_numbers, 0);
    let expected = &folder.files("numbers");
    let focal = "\"fx\": 262.5, \"fy\": 262.5";
    folder.write("ours.json", format!("{{{focal}, \"cx\": 159.5, \"cy\": 119.5, \"width\": 320, \"height\": 240, \"depth_scale\": 10000}}").as_bytes());
    folder.write("theirs", format!("{{{focal}, \"x_offset\": 159.5, \"y_offset\": 119.5}}").as_bytes());
    folder.run("segment --depth in/1-depth.png --camera ours.json --out ours", 0);
    assert!(folder.files("ours") == *expected);
    folder.run("segment --depth in/1-depth.png --camera theirs --depth-scale 10000 --out theirs.out", 0);
    assert!(folder.files("theirs.out") == *expected);
    // Point clouds take the same file.
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.run("segment a.pcd --camera ours.json --out cloud", 0);
    // The command line comes before the file.
    let run = folder.run("segment --depth in/1-depth.png --camera ours.json --depth-scale 1 --out no", 1);
    assert!(run.stderr.contains("--depth-scale 10000"), "{}", run.stderr);
}

/// A folder as the TUM benchmark has them, with its own clock for depth.
fn tum(lists: [&str; 2]) -> Folder {
    let folder = Folder::new();
    for k in 0..3 {
        let cloud = Cloud::two_boxes(0.02 * f64::from(k));
        folder.write(&format!("tum/rgb/{k}.0.png"), &png(&cloud.color()));
        folder.write(&format!("tum/depth/{k}.01.png"), &png(&cloud.depth(5000.0)));
    }
    folder.write("tum/rgb.txt", lists[0].as_bytes());
    folder.write("tum/depth.txt", lists[1].as_bytes());
    folder
}

const RGB: &str = "# color images\n0.0 rgb/0.0.png\n1.0 rgb/1.0.png\n2.0 rgb/2.0.png\n";
const DEPTH: &str = "# depth\n0.01 depth/0.01.png\n1.01 depth/1.01.png\n2.01 depth/2.01.png\n";

#[test]
fn tum_folders_are_read() {
    let folder = tum([RGB, DEPTH]);
    let run = folder.run(&format!("segment tum --camera {} --out out", camera()), 0);
    let two = "2 objects";
    assert_eq!(
        counts(&run),
        [("tum/depth/0.01.png", two), ("tum/depth/1.01.png", two), ("tum/depth/2.01.png", two)]
    );
    assert_eq!(run.stderr, "3 of 3 frames done\n");
    assert_eq!(folder.names("out")[..2], ["0.01.json", "0.01.labels.png"]);

    let run = folder.run("segment tum --out none", 1);
    assert_eq!(
        run.errors(),
        ["error: tum: the folder has no camera.json: add one, or give the camera by --camera"]
    );
    folder.write("tum/camera.json", br#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5}"#);
    folder.run("segment tum --out own", 0);
    assert!(folder.files("own") == folder.files("out"));
    let run = folder.run("segment tum --depth-scale 50 --out wrong", 1);
    assert_eq!(run.errors().len(), 3, "{}", run.stderr);
}

#[test]
fn tum_frames_without_a_partner_are_told_and_no_error() {
    let folder = tum([RGB, &DEPTH.replace("1.01 depth", "1.021 depth")]);
    let run = folder.run(&format!("segment tum --camera {} --out out", camera()), 0);
    assert_eq!(counts(&run).len(), 2);
    let note = "note: tum: 2 frames; 1 colour and 1 depth images have no partner within 20 ms";
    assert_eq!(run.stderr.lines().next(), Some(note));

    let folder = tum([RGB, ""]);
    let run = folder.run(&format!("segment tum --camera {} --out out", camera()), 1);
    assert!(run.errors()[0].contains("none of its 3 colour and 0 depth images"), "{}", run.stderr);
    let folder = tum([RGB, "now depth/0.01.png\n"]);
    let run = folder.run(&format!("segment tum --camera {} --out out", camera()), 1);
    assert!(
        run.errors()[0].starts_with("error: tum/depth.txt: line 1: `now depth/0.01.png`"),
        "{}",
        run.stderr
    );
    assert!(folder.names("out").is_empty());
}

#[test]
fn limits_act_on_frames_of_every_kind() {
    let folder = stills();
    let cloud = Cloud::two_boxes(0.01);
    folder.write("1.pcd", &cloud.to_binary_pcd());
    let left = ImageBuffer::from_fn(320, 240, |u, _| Luma([if u < 160 { 1_u8 } else { 0 }]));
    folder.write("left.png", &png(&left.into()));
    for (k, input) in ["1.pcd".to_owned(), format!("--color in/1-color.png --depth in/1-depth.png {}", how())]
        .iter()
        .enumerate()
    {
        for (name, limit) in [("mask", "--mask left.png"), ("roi", "--roi 0,0,160,240")] {
            let out = format!("{name}{k}");
            let run = folder.run(&format!("segment {input} {limit} --out {out}"), 0);
            assert!(run.stdout.contains(": 1 object\n"), "{limit}: {}", run.stdout);
            let labels = labels(&folder.files(&out)["1.labels.png"]);
            assert!(labels.iter().enumerate().all(|(i, &label)| label == 0 || i % 320 < 160));
        }
        assert!(folder.files(&format!("mask{k}")) == folder.files(&format!("roi{k}")));
        let out = format!("range{k}");
        folder.run(&format!("segment {input} --range 0.3..0.95 --out {out}"), 0);
        let labels = labels(&folder.files(&out)["1.labels.png"]);
        assert!(labels.iter().zip(&cloud.points).all(|(&label, point)| label == 0 || point.xyz_m[2] < 0.951));
        let run = folder.run(&format!("segment {input} --range 5..6 --out far"), 1);
        assert!(run.errors()[0].contains("widen --range"), "{}", run.stderr);
    }
    assert!(folder.names("far").is_empty());
}

/// Runs with good frames beside a bad one: a line for the bad one, nothing written for it.
#[track_caller]
fn refused(folder: &Folder, arguments: &str, said: &[&str]) {
    let out = format!("out{}", folder.names("").len());
    let run = folder.run(&format!("segment {arguments} --out {out}"), 1);
    let errors = run.errors();
    assert_eq!(errors.len(), 1, "{}", run.stderr);
    for part in said {
        assert!(errors[0].contains(part), "{}", errors[0]);
    }
    assert_eq!(folder.names(&out), Vec::<String>::new());
}

#[test]
fn bad_images_are_refused_in_one_line() {
    let folder = stills();
    let grey = |value: u8| png(&ImageBuffer::from_pixel(320, 240, Luma([value])).into());
    folder.write("eight.png", &grey(200));
    folder.write("text.png", b"this is no image\n");
    folder.write("empty.png", b"");
    folder.write("rgb.png", &png(&Cloud::two_boxes(0.0).color()));
    folder.write("small.png", &png(&ImageBuffer::from_pixel(64, 48, Rgb([9_u8; 3])).into()));
    folder.write("deep.png", &png(&Cloud::two_boxes(0.0).depth(1000.0)));
    let mut cut = png(&Cloud::two_boxes(0.0).depth(1000.0));
    cut.truncate(cut.len() / 2);
    folder.write("cut.png", &cut);
    let mm = format!("--camera {} --depth-scale 1000", camera());
    refused(&folder, &format!("--depth eight.png {mm}"), &["error: eight.png: ", "8 bits", "16-bit"]);
    refused(&folder, &format!("--depth text.png {mm}"), &["error: text.png: ", "not that of a PNG"]);
    refused(&folder, &format!("--depth empty.png {mm}"), &["error: empty.png: the file is empty"]);
    refused(&folder, &format!("--depth missing.png {mm}"), &["error: missing.png: cannot be read"]);
    refused(&folder, &format!("--depth cut.png {mm}"), &["error: cut.png: ", "not a usable PNG"]);
    refused(&folder, &format!("--depth rgb.png {mm}"), &["error: rgb.png: ", "one channel", "has 3"]);
    refused(&folder, &format!("--color deep.png --depth deep.png {mm}"), &["error: deep.png: ", "swapped"]);
    refused(&folder, &format!("--color text.png --depth deep.png {mm}"), &["error: text.png: "]);
    refused(&folder, &format!("--color small.png --depth deep.png {mm}"), &["64x48", "320x240"]);
    refused(
        &folder,
        &format!("--depth deep.png --camera {},640,480 --depth-scale 1000", camera()),
        &["640x480", "320x240"],
    );
    refused(
        &folder,
        &format!("--depth deep.png --camera {} --depth-scale 1", camera()),
        &["beyond 50 m", "--depth-scale 1000"],
    );
    refused(
        &folder,
        &format!("--depth deep.png --camera {} --depth-scale 100000", camera()),
        &["below 0.05 m", "--depth-scale 1000"],
    );
    refused(
        &folder,
        &format!("--depth deep.png {mm} --max-pixels 76799"),
        &["320x240", "--max-pixels 76799"],
    );
    refused(&folder, &format!("--depth deep.png {mm} --roi 300,0,21,10"), &["300,0,21,10", "320x240"]);
    refused(&folder, &format!("--depth deep.png {mm} --mask small.png"), &["64x48", "320x240"]);
    std::fs::create_dir(folder.path().join("hollow")).unwrap();
    refused(&folder, &format!("--depth hollow {mm}"), &["error: hollow: no depth image"]);
    refused(&folder, &format!("--depth hollow/*.png {mm}"), &["error: hollow/*.png: no depth image"]);
    refused(&folder, "hollow", &["error: hollow: no point cloud"]);
    folder.write("cloud.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    refused(&folder, "cloud.pcd --max-pixels 1000", &["error: cloud.pcd: ", "--max-pixels 1000"]);
    let cloud = Cloud::two_boxes(0.0);
    let flat = Cloud { width: cloud.width * cloud.height, height: 1, ..cloud };
    folder.write("flat.pcd", &flat.to_binary_pcd());
    refused(
        &folder,
        &format!("flat.pcd --camera {},16384,16384", camera()),
        &["16384x16384", "--max-pixels"],
    );
    refused(&folder, "rgb.png", &["error: rgb.png: ", "--color and --depth"]);
}

#[test]
fn images_without_a_partner_are_named_and_the_others_done() {
    let folder = stills();
    folder.write_pair("in", "7", &Cloud::two_boxes(0.0));
    folder.write_pair("in", "8", &Cloud::two_boxes(0.0));
    std::fs::remove_file(folder.path().join("in/7-color.png")).unwrap();
    std::fs::remove_file(folder.path().join("in/8-depth.png")).unwrap();
    let run = folder.run(&format!("segment --color in --depth in {} --out out --write labels", how()), 1);
    assert_eq!(folder.names("out"), ["1.labels.png", "10.labels.png", "2.labels.png"]);
    let errors = run.errors();
    assert_eq!(errors.len(), 2);
    assert!(
        errors[0].starts_with("error: in/7-depth.png: no color image has `7` in its name"),
        "{}",
        errors[0]
    );
    assert!(
        errors[1].starts_with("error: in/8-color.png: no depth image has `8` in its name"),
        "{}",
        errors[1]
    );
    assert!(run.stderr.ends_with("3 of 5 frames done, 2 failed\n"), "{}", run.stderr);
}

#[test]
fn a_command_line_that_says_too_little_or_too_much() {
    let folder = stills();
    folder.write("broken.json", b"{\"fx\": 1}");
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let depth = "--depth in/1-depth.png";
    let camera = format!("--camera {}", camera());
    for (arguments, said) in [
        (depth.to_owned(), "--camera"),
        (
            format!("{depth} {camera}"),
            "the unit of integer depth is not known: say how many units are a metre, --depth-scale",
        ),
        (format!("{depth} {camera} --depth-scale 0"), "positive number"),
        (format!("{depth} {camera} --depth-scale mm"), "positive number"),
        (format!("{depth} --camera broken.json --depth-scale 1"), "--camera broken.json: not a camera file"),
        (format!("{depth} --camera missing.json --depth-scale 1"), "--camera missing.json: cannot be read"),
        (format!("{depth} --camera 1,2,3 --depth-scale 1"), "is not a camera"),
        (format!("--color in/1-color.png {camera}"), "--depth"),
        (format!("{depth} {camera} --depth-scale 10000 --mask broken.json"), "--mask broken.json: "),
        (format!("{depth} {camera} --depth-scale 10000 --range 2"), "not a range of depths"),
        (format!("{depth} {camera} --depth-scale 10000 --roi 1,2"), "not a region"),
        (format!("a.pcd {depth} {camera} --depth-scale 10000"), "cannot be used with"),
        ("a.pcd --depth-scale 10000".to_owned(), "--depth-scale is for depth images"),
        (String::new(), "required"),
    ] {
        let run = folder.run(&format!("segment {arguments} --out out"), 2);
        assert!(run.stderr.contains(said), "{arguments}: {}", run.stderr);
        assert!(!folder.path().join("out").exists());
    }
}

/// `**` was taken for the name of a folder.
#[test]
fn two_stars_in_a_pattern_are_any_folders() {
    let folder = Folder::new();
    for (k, place) in ["in", "in/deep", "in/deep/er"].iter().enumerate() {
        folder.write_pair(place, &k.to_string(), &Cloud::two_boxes(0.01));
    }
    let run = folder.run(
        &format!(
            "segment --color in/**/*-color.png --depth in/**/*-depth.png {} --out out --write labels",
            how()
        ),
        0,
    );
    assert_eq!(counts(&run).len(), 3, "{}{}", run.stdout, run.stderr);
    assert_eq!(folder.names("out"), ["0.labels.png", "1.labels.png", "2.labels.png"]);
}

/// Two such names were one and the same with replacement characters, and refused.
#[cfg(target_os = "linux")]
#[test]
fn image_names_that_are_not_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("in")).unwrap();
    for (k, letter) in [0xe8_u8, 0xe9].into_iter().enumerate() {
        let cloud = Cloud::two_boxes(0.01 * k as f64);
        for (role, image) in [("color", cloud.color()), ("depth", cloud.depth(10_000.0))] {
            let name = [&[letter], b"-", role.as_bytes(), b".png"].concat();
            std::fs::write(folder.path().join("in").join(OsStr::from_bytes(&name)), png(&image)).unwrap();
        }
    }
    let run = folder.run(&format!("segment --color in --depth in {} --out out --write labels", how()), 0);
    assert_eq!(counts(&run).len(), 2, "{}{}", run.stdout, run.stderr);
    let mut names: Vec<Vec<u8>> = std::fs::read_dir(folder.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().as_bytes().to_vec())
        .collect();
    names.sort();
    assert_eq!(names, [b"\xe8-depth.labels.png", b"\xe9-depth.labels.png"]);
    let run = folder.run(&format!("segment --color in/*color* --depth in/*depth* {} --out out2", how()), 0);
    assert_eq!(counts(&run).len(), 2, "{}{}", run.stdout, run.stderr);
}

/// A picture of which most is beyond the reach of 16 bits was refused as one in other units.
#[test]
fn saturated_depth_is_no_sign_of_a_wrong_scale() {
    let folder = Folder::new();
    let cloud = Cloud::two_boxes(0.0);
    let DynamicImage::ImageLuma16(mut depth) = cloud.depth(1000.0) else { panic!("16 bits") };
    // The boxes stay; most of what is around them is out of reach.
    depth.enumerate_pixels_mut().filter(|(u, v, _)| *u < 20 || *v < 60).for_each(|(.., z)| z.0[0] = u16::MAX);
    depth
        .enumerate_pixels_mut()
        .filter(|(u, v, _)| *u > 300 || *v > 130)
        .for_each(|(.., z)| z.0[0] = u16::MAX);
    let saturated = depth.pixels().filter(|z| z.0[0] == u16::MAX).count();
    assert!(2 * saturated > depth.len(), "{saturated}");
    folder.write("depth.png", &png(&depth.into()));
    folder.run(&format!("segment --depth depth.png --camera {} --depth-scale 1000 --out out", camera()), 0);
    assert_eq!(folder.names("out"), ["depth.json", "depth.labels.png"]);
}

/// The mark that editors of Windows put before UTF-8 made the file none.
#[test]
fn a_camera_file_with_a_byte_order_mark() {
    let folder = stills();
    let json = r#"{"fx": 262.5, "fy": 262.5, "cx": 159.5, "cy": 119.5, "depth_scale": 10000}"#;
    folder.write("camera.json", format!("\u{feff}{json}").as_bytes());
    folder.run("segment --depth in/1-depth.png --camera camera.json --out out", 0);
}

/// Poses are optional, and other data sets have other columns in a file of that name.
#[test]
fn a_tum_folder_with_poses_that_are_none_is_read_with_a_note() {
    let folder = tum([RGB, DEPTH]);
    folder.write("tum/groundtruth.txt", b"0.0 1 2 3\n");
    let run = folder.run(&format!("segment tum --camera {} --out out", camera()), 0);
    assert_eq!(counts(&run).len(), 3);
    let note = run.stderr.lines().next().unwrap();
    assert!(note.starts_with("note: tum/groundtruth.txt: line 1: `0.0 1 2 3` is not a time"), "{note}");
}

/// "invalid digit found in string" told nobody what to write.
#[test]
fn a_number_of_pixels_that_is_none() {
    let folder = stills();
    for text in ["many", "0", "-1", "1e6", "999999999999"] {
        let run = folder.run(&format!("segment in/1.pcd --max-pixels={text} --out out"), 2);
        assert!(run.stderr.contains("give a whole number from 1 to 268435456"), "{}", run.stderr);
    }
}
