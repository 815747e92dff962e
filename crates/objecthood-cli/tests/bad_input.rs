//! Whatever is wrong with a frame: one clear line, nothing written for it, and the others done.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::Folder;
use common::scene::{Cloud, header};

const OUTPUTS: [&str; 3] = ["good.json", "good.labels.png", "good.panels.png"];

/// Runs `good.pcd` together with bad inputs, and expects one line for each of them.
#[track_caller]
fn only_the_good_one_is_done(folder: &Folder, bad: &[&str]) {
    folder.write("good.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let arguments = format!("segment {} good.pcd --out out --write labels,json,panels", bad.join(" "));
    let run = folder.run(&arguments, 1);
    assert_eq!(folder.names("out"), OUTPUTS, "nothing else, no temporary file either");
    let errors = run.errors();
    for name in bad {
        let own: Vec<_> =
            errors.iter().filter(|line| line.starts_with(&format!("error: {name}: "))).collect();
        assert_eq!(own.len(), 1, "one line for {name}: {errors:#?}");
        assert!(own[0].matches(": ").count() >= 3, "path, what is wrong, what to do: {}", own[0]);
    }
    assert_eq!(errors.len(), bad.len(), "{errors:#?}");
    let total = bad.len() + 1;
    assert_eq!(run.stderr.lines().last(), Some(&*format!("1 of {total} frames done, {} failed", bad.len())));
}

#[test]
fn files_that_are_no_point_cloud() {
    let folder = Folder::new();
    folder.write("empty.pcd", b"");
    folder.write("text.pcd", b"Dear reader,\nthis is no point cloud.\n");
    let mut state = 1_u32;
    let noise: Vec<u8> = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    })
    .take(100_000)
    .collect();
    folder.write("noise.pcd", &noise);
    folder.write("header.pcd", &[header(320, 240, "binary").as_bytes(), &noise[..1000]].concat());
    std::fs::create_dir(folder.path().join("folder.pcd")).unwrap();
    only_the_good_one_is_done(
        &folder,
        &[
            "missing.pcd",
            "empty.pcd",
            "text.pcd",
            "noise.pcd",
            "header.pcd",
            "folder.pcd",
            "good.pcd/below.pcd",
        ],
    );
}

#[test]
fn files_cut_short_anywhere() {
    let folder = Folder::new();
    let compressed = [header(320, 240, "binary_compressed").as_bytes(), &[1, 0]].concat();
    folder.write("cut_sizes.pcd", &compressed);
    let binary = Cloud::two_boxes(0.0).to_binary_pcd();
    folder.write("cut_binary.pcd", &binary[..binary.len() - 1]);
    folder.write("cut_header.pcd", &binary[..100]);
    let ascii = Cloud::two_boxes(0.0).to_pcd();
    folder.write("cut_ascii.pcd", &ascii[..ascii.len() / 2]);
    only_the_good_one_is_done(
        &folder,
        &["cut_sizes.pcd", "cut_binary.pcd", "cut_header.pcd", "cut_ascii.pcd"],
    );
}

#[test]
fn claims_beyond_the_file() {
    let folder = Folder::new();
    let with = |header: String, data: &[u8]| [header.as_bytes(), data].concat();
    let billions = u32::MAX as usize;
    folder.write("wide.pcd", &with(header(billions, 1, "binary"), &[0; 4096]));
    folder.write("large.pcd", &with(header(65_536, 65_536, "binary"), &[0; 4096]));
    folder.write("endless.pcd", &with(header(usize::MAX, usize::MAX, "ascii"), b"1 1 1 0 0\n"));
    folder.write("more.pcd", &with(header(10_000, 100, "binary"), &[0; 20_000]));
    let sizes = [u32::MAX.to_le_bytes(), u32::MAX.to_le_bytes()].concat();
    folder.write("packed.pcd", &with(header(billions, 1, "binary_compressed"), &sizes));
    let sizes = [8_u32.to_le_bytes(), u32::MAX.to_le_bytes()].concat();
    let packed = [&sizes[..], &[0x1f; 8]].concat();
    folder.write("unpacked.pcd", &with(header(65_536, 3276, "binary_compressed"), &packed));
    only_the_good_one_is_done(
        &folder,
        &["wide.pcd", "large.pcd", "endless.pcd", "more.pcd", "packed.pcd", "unpacked.pcd"],
    );
}

#[test]
fn contents_that_contradict_themselves() {
    let folder = Folder::new();
    let edited = |from: &str, to: &str| {
        let text = String::from_utf8(Cloud::two_boxes(0.0).to_pcd()).unwrap();
        assert!(text.contains(from));
        text.replacen(from, to, 1).into_bytes()
    };
    folder.write("sizes.pcd", &edited("SIZE 4 4 4 4 4", "SIZE 4 4 3 4 4"));
    folder.write("types.pcd", &edited("TYPE F F F U U", "TYPE F F Q U U"));
    folder.write("fewer.pcd", &edited("SIZE 4 4 4 4 4", "SIZE 4 4 4"));
    folder.write("zero.pcd", &edited("WIDTH 320", "WIDTH 0"));
    folder.write("points.pcd", &edited("POINTS 76800", "POINTS 76801"));
    folder.write("no_z.pcd", &edited("FIELDS x y z", "FIELDS x y w"));
    folder.write("data.pcd", &edited("DATA ascii", "DATA morse"));
    // A back-reference to before the beginning.
    let sizes = [4_u32.to_le_bytes(), (320 * 240 * 20_u32).to_le_bytes()].concat();
    let packed = [header(320, 240, "binary_compressed").as_bytes(), &sizes, &[0xff; 4]].concat();
    folder.write("lzf.pcd", &packed);
    only_the_good_one_is_done(
        &folder,
        &["sizes.pcd", "types.pcd", "fewer.pcd", "zero.pcd", "points.pcd", "no_z.pcd", "data.pcd", "lzf.pcd"],
    );
}

/// A cloud on both sides of its origin.
fn half_behind(cloud: Cloud) -> Cloud {
    cloud.map(|p| {
        if p.xyz_m[0] < 0.0 {
            p.xyz_m[2] *= -1.0;
        }
    })
}

#[test]
fn clouds_that_show_nothing() {
    let folder = Folder::new();
    let cloud = || Cloud::two_boxes(0.0);
    folder.write("nan.pcd", &cloud().map(|p| p.xyz_m = [f32::NAN; 3]).to_binary_pcd());
    folder.write("zero.pcd", &cloud().map(|p| p.xyz_m = [0.0; 3]).to_binary_pcd());
    folder.write("behind.pcd", &cloud().map(|p| p.xyz_m[2] *= -1.0).to_binary_pcd());
    folder.write("infinite.pcd", &cloud().map(|p| p.xyz_m = [f32::INFINITY; 3]).to_binary_pcd());
    // Every pixel at its place, but not on the ray that a pinhole camera would have there.
    folder.write("bent.pcd", &cloud().map(|p| p.xyz_m[0] += p.xyz_m[1].powi(2) * 3.0).to_binary_pcd());
    let flat = Cloud { width: 320 * 240, height: 1, points: cloud().points };
    folder.write("around.pcd", &half_behind(flat).to_binary_pcd());
    only_the_good_one_is_done(
        &folder,
        &["nan.pcd", "zero.pcd", "behind.pcd", "infinite.pcd", "bent.pcd", "around.pcd"],
    );
}

#[test]
#[cfg(unix)]
fn a_file_without_permission() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new();
    let locked = folder.write("locked.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::File::open(&locked).is_ok() {
        println!("skipped: a file without permission, because this user may read everything");
        return;
    }
    only_the_good_one_is_done(&folder, &["locked.pcd"]);
}

#[test]
fn a_folder_with_nothing_in_it_and_a_folder_with_something() {
    let folder = Folder::new();
    folder.write("hollow/readme.txt", b"nothing here");
    only_the_good_one_is_done(&folder, &["hollow"]);

    let run = folder.run("segment hollow --out other", 1);
    assert_eq!(run.errors().len(), 1);
    assert!(run.stderr.contains("hollow: no point cloud (.pcd"), "{}", run.stderr);
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.write("b.pcd", &Cloud::two_boxes(0.1).to_binary_pcd());

    // The label image of `a` is written before its scene file cannot be.
    std::fs::create_dir_all(folder.path().join("out/a.json")).unwrap();
    let run = folder.run("segment a.pcd b.pcd --out out", 1);
    assert_eq!(folder.names("out"), ["b.json", "b.labels.png"]);
    assert_eq!(run.errors().len(), 1, "{}", run.stderr);
    assert!(
        run.errors()[0].starts_with("error: a.pcd: ") && run.errors()[0].contains("a.json"),
        "{}",
        run.stderr
    );

    folder.write("file", b"");
    let run = folder.run("segment a.pcd --out file", 2);
    assert!(run.stderr.contains("--out file is a file: name a folder"), "{}", run.stderr);
    let run = folder.run("segment a.pcd --out file/below", 1);
    assert!(run.stderr.contains("cannot make the folder file/below"), "{}", run.stderr);
    if cfg!(target_os = "linux") {
        let run = folder.run("segment a.pcd --out /proc/objecthood", 1);
        assert!(run.stderr.contains("/proc/objecthood"), "{}", run.stderr);
    }
}

/// The shell ends every file at a number of bytes, as a full disk would.
#[test]
#[cfg(unix)]
fn an_output_that_is_full() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.run("segment a.pcd --out whole", 0);
    let whole = folder.files("whole");
    // There is room for the label image but not for the scene file after it.
    let blocks = whole["a.labels.png"].len().div_ceil(512);
    assert!(whole["a.json"].len() > 512 * blocks);

    for (out, blocks) in [("none", 0), ("one", blocks)] {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
        let output = std::process::Command::new("sh")
            .current_dir(folder.path())
            .args(["-c", &script, "sh", env!("CARGO_BIN_EXE_objecthood"), "segment", "a.pcd", "--out", out])
            .output()
            .unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        let file = if blocks == 0 { "a.labels.png" } else { "a.json" };
        assert!(stderr.starts_with(&format!("error: a.pcd: {out}/{file}: cannot be written")), "{stderr}");
        assert_eq!(stderr.lines().count(), 2, "{stderr}");
        assert!(folder.names(out).is_empty(), "{:?}", folder.names(out));
    }
}

/// A name could colour the terminal, or write a line of its own.
#[test]
fn names_are_told_without_what_would_command_the_terminal() {
    let folder = Folder::new();
    let run = folder.run("segment \u{1b}[31mred\u{7}.pcd --out out", 1);
    assert!(run.stderr.starts_with("error:  [31mred .pcd: cannot be read"), "{:?}", run.stderr);
    assert!(!run.stderr.replace('\n', "").contains(char::is_control), "{:?}", run.stderr);
}

/// A bag begins with `#` as a comment of PCD does, and its second line was called a bad PCD header.
#[test]
fn a_bag_gets_no_advice_about_pcd() {
    let folder = Folder::new();
    for (name, head, kind) in [
        (
            "a.bag",
            &b"#ROSBAG V1.2\nE\0\0\0"[..],
            "a ROS 1 bag of version 1: save its depth and colour as images",
        ),
        ("a.mkv", b"\x1a\x45\xdf\xa3", "a Matroska video: extract the depth of an Azure Kinect with `ffmpeg"),
    ] {
        folder.write(name, head);
        let run = folder.run(&format!("segment {name} --out out"), 1);
        let said = run.errors()[0];
        assert!(
            said.starts_with(&format!("error: {name}: not a file that objecthood reads, but {kind}")),
            "{said}"
        );
        assert!(!said.to_lowercase().contains("pcd"), "{said}");
    }
    for (name, head, problem) in [
        (
            "b.bag",
            &b"#ROSBAG V2.0\nE\0\0\0"[..],
            "no depth image and no point cloud is in the recording: it is empty",
        ),
        (
            "b.mcap",
            b"\x89MCAP0\r\n\x01",
            "no depth image and no point cloud is in the recording: it is empty",
        ),
        ("b.db3", b"SQLite format 3\0", "the recording ends in the middle, at byte 16"),
    ] {
        folder.write(name, head);
        let run = folder.run(&format!("segment {name} --out out"), 1);
        assert!(run.errors()[0].starts_with(&format!("error: {name}: {problem}")), "{}", run.errors()[0]);
    }
}

/// "which is no F4" and "invalid digit found in string" are the words of programs.
#[test]
fn a_word_that_is_no_number_is_said_so() {
    let folder = Folder::new();
    let text = String::from_utf8(Cloud::two_boxes(0.0).to_pcd()).unwrap();
    let (header, data) = text.split_once("DATA ascii\n").unwrap();
    for (word, field, said) in [
        ("tree", 2, "z is `tree`, which is no F4 (a number)"),
        ("-1", 4, "label is `-1`, which is no U4 (a whole number from 0 to 4294967295)"),
    ] {
        let mut words: Vec<&str> = data.lines().next().unwrap().split(' ').collect();
        words[field] = word;
        let rest = data.split_once('\n').unwrap().1;
        folder.write("a.pcd", format!("{header}DATA ascii\n{}\n{rest}", words.join(" ")).as_bytes());
        let run = folder.run("segment a.pcd --out out", 1);
        assert!(
            run.errors()[0].contains(&format!("line 12 of the PCD file is no point: {said}")),
            "{}",
            run.stderr
        );
    }
}

/// The advice that names an option is the program's, for every error that an option helps against.
#[test]
fn what_an_option_helps_against_names_it() {
    let folder = Folder::new();
    let cloud = Cloud::two_boxes(0.0);
    let flat = Cloud { width: 320 * 240, height: 1, points: Cloud::two_boxes(0.0).points };
    folder.write("good.pcd", &cloud.to_binary_pcd());
    folder.write("flat.pcd", &flat.to_binary_pcd());
    folder.write("around.pcd", &half_behind(flat).to_binary_pcd());
    folder.write(
        "bent.pcd",
        &Cloud::two_boxes(0.0).map(|p| p.xyz_m[0] += p.xyz_m[1].powi(2) * 3.0).to_binary_pcd(),
    );
    folder.write("mirrored.pcd", &Cloud::two_boxes(0.0).map(|p| p.xyz_m[0] *= -1.0).to_binary_pcd());
    for (arguments, advice) in [
        ("around.pcd", ": give the camera, --camera fx,fy,cx,cy"),
        ("flat.pcd --camera 262,262,-500,119", ": write --camera fx,fy,cx,cy,width,height"),
        ("bent.pcd", ": give the camera, --camera fx,fy,cx,cy"),
        ("mirrored.pcd", ": convert them to it, or give the camera, --camera"),
        ("good.pcd --max-pixels 9", ": give a smaller image, or more than --max-pixels 9"),
        ("good.pcd --range 5..6", "lies within the range of depths: widen --range"),
    ] {
        for command in ["segment", "explain --at 1,1"] {
            let run = folder.run(&format!("{command} {arguments} --out out"), 1);
            let said = run.errors()[0];
            assert!(said.contains(advice), "{command} {arguments}: {said}");
            assert_eq!(said.matches(advice).count(), 1, "{said}");
        }
    }
}
