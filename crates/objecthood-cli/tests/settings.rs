//! What every subcommand takes, `params`, and how the program answers mistakes.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::Folder;
use common::scene::Cloud;

#[test]
fn every_parameter_is_printed_with_unit_default_range_source_and_meaning() {
    let folder = Folder::new();
    let json: serde_json::Value = serde_json::from_str(&folder.run("params --json", 0).stdout).unwrap();
    let parameters = json["parameters"].as_array().unwrap();
    assert!(parameters.len() > 20);
    let table = folder.run("params", 0).stdout;
    for parameter in parameters {
        for key in ["name", "default", "range", "unit", "meaning", "source"] {
            let text = parameter[key].as_str().unwrap();
            assert!(!text.is_empty() && table.contains(text), "{key} {text}");
        }
        assert!(!parameter["value"].is_null(), "{parameter}");
    }
    assert!(!table.contains("(default "), "every value is its default:\n{table}");
}

#[test]
fn the_printed_file_gives_the_same_parameters() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let changed = "--set curvature.threshold=0.1 --set graph.channels=depth --set objectness.min_size_px=150";
    for settings in ["", changed] {
        let file = folder.run(&format!("params --toml {settings}"), 0).stdout;
        folder.write("again.toml", file.as_bytes());
        assert_eq!(folder.run("params --toml --config again.toml", 0).stdout, file);

        folder.run(&format!("segment a.pcd --out direct {settings}"), 0);
        folder.run("segment a.pcd --out again --config again.toml", 0);
        assert_eq!(folder.files("direct"), folder.files("again"), "fingerprint included");
    }
}

#[test]
fn the_last_setting_wins_over_the_file() {
    let folder = Folder::new();
    folder.write("c.toml", b"method = \"paper\"\n[curvature]\nthreshold = 0.2\noffset_px = 3\n");
    let value = |settings: &str| {
        let text = folder.run(&format!("params --json {settings}"), 0).stdout;
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let of = |name: &str| {
            json["parameters"].as_array().unwrap().iter().find(|p| p["name"] == name).unwrap()["value"]
                .clone()
        };
        (of("curvature.threshold"), of("curvature.offset_px"))
    };
    assert_eq!(value(""), (0.14.into(), 2.into()));
    assert_eq!(value("--config c.toml"), (0.2.into(), 3.into()));
    assert_eq!(
        value("--set curvature.threshold=0.3 --config c.toml --set curvature.threshold=1"),
        (1.0.into(), 3.into())
    );
    let table = folder.run("params --config c.toml", 0).stdout;
    assert!(table.contains("(default 0.14)"), "{table}");
}

#[test]
fn a_profile_brings_its_sideways_noise_unless_that_is_given() {
    let folder = Folder::new();
    let sensor = |options: &str| {
        let toml = folder.run(&format!("params --toml {options}"), 0).stdout;
        let table: toml::Table = toml.parse().unwrap();
        (table["sensor"]["profile"].to_string(), table["sensor"]["lateral_noise_px"].to_string())
    };
    let expected = |profile: &str, lateral: &str| (format!("\"{profile}\""), lateral.to_owned());
    assert_eq!(sensor(""), expected("none", "0.8"));
    assert_eq!(sensor("--profile stereo"), expected("stereo", "0.7"));
    assert_eq!(sensor("--set sensor.profile=tof"), expected("tof", "0.29"));
    assert_eq!(sensor("--profile tof --set sensor.lateral_noise_px=0.5"), expected("tof", "0.5"));
    folder.refuses("params --profile lidar", "stereo");
}

#[test]
fn mistakes_in_settings_are_explained_and_nothing_is_done() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.write("syntax.toml", b"[curvature]\nthreshold = = 3\n");
    folder.write("unknown.toml", b"[curvature]\nthresold = 0.1\n");
    folder.write("flat.toml", b"threshold = 0.1\n");
    folder.write("range.toml", b"[graph]\ncolor_weight = 7\n");
    folder.write("no_method.toml", b"method = \"magic\"\n");
    for (settings, said) in [
        ("--set curvature.thresold=0.1", &["`curvature.thresold`", "`curvature.threshold`"] as &[&str]),
        ("--set threshold=0.1", &["`curvature.threshold`", "`objectness.threshold`"]),
        ("--set curvatur.threshold=0.1", &["`curvature.threshold`"]),
        ("--set CURVATURE.THRESOLD=0.1", &["`CURVATURE.THRESOLD`", "did you mean `curvature.threshold`?"]),
        ("--set objectness.foo=1", &["of the group objectness are min_side_m, "]),
        ("--set z=1", &["there is no parameter `z`: `objecthood params` lists all"]),
        ("--set curvature.threshold", &["group.parameter=value"]),
        (
            "--set curvature.threshold=high",
            &["curvature.threshold = \"high\"", "it takes a number in 0 ..= 2"],
        ),
        ("--set curvature.threshold=3", &["curvature.threshold = 3", "0 ..= 2"]),
        ("--set curvature.threshold=nan", &["curvature.threshold", "0 ..= 2"]),
        ("--set curvature.threshold=[0.1]", &["curvature.threshold", "0 ..= 2"]),
        ("--set curvature.enabled=yes", &["it takes one of true | false"]),
        ("--set graph.channels=infrared", &["color | depth | both"]),
        (
            "--set graph.min_size_px=1.5",
            &["graph.min_size_px = 1.5", "it takes a whole number in 0 ..= 1000000"],
        ),
        ("--set graph.min_size_px=-1", &["graph.min_size_px", "0 ..= 1000000"]),
        ("--set method=paper", &["--method"]),
        ("--config missing.toml", &["missing.toml"]),
        ("--config syntax.toml", &["syntax.toml", "line 2"]),
        ("--config unknown.toml", &["unknown.toml", "`curvature.threshold`"]),
        ("--config flat.toml", &["`threshold`", "group"]),
        ("--config range.toml", &["range.toml", "graph.color_weight = 7", "0 ..= 1"]),
        ("--config no_method.toml", &["`magic`", "`paper`", "`context`"]),
        ("--method magic", &["paper"]),
        ("--threads 0", &["--threads", "give a whole number from 1 to 1024"]),
        ("--threads many", &["--threads", "give a whole number from 1 to 1024"]),
        ("--threads -3", &["'-3' for '--threads", "give a whole number from 1 to 1024"]),
        ("--write labels,photos", &["panels"]),
        ("--camera 1,2,3", &["--camera"]),
        ("--camera 0,525,319.5,239.5", &["--camera"]),
    ] {
        let run = folder.run(&format!("segment a.pcd --out out {settings}"), 2);
        assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
        for words in said {
            assert!(run.stderr.contains(words), "{settings}: no {words} in\n{}", run.stderr);
        }
        for parser_word in ["f32", "f64", "u32", "usize", "invalid type", "digit"] {
            assert!(!run.stderr.contains(parser_word), "{settings}: {parser_word} in\n{}", run.stderr);
        }
        assert!(!folder.path().join("out").exists(), "{settings}");
    }
}

/// The README's own example did nothing and said nothing.
#[test]
fn parameters_that_the_method_does_not_read_are_named() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.write("c.toml", b"[curvature]\nthreshold = 0.2\n[graph]\ncolor_weight = 0.1\n");
    folder.write("defaults.toml", folder.run("params --toml", 0).stdout.as_bytes());
    let one = "note: curvature.threshold has no effect on the method context: only paper reads it (--method paper)\n";
    let two = "note: curvature.threshold, graph.color_weight have no effect on the method context: only paper reads them \
               (--method paper)\n";
    let other = "note: height.min_top_m has no effect on the method paper: only context reads it (--method context)\n";
    for (settings, said) in [
        ("--set curvature.threshold=0.2", one),
        ("--config c.toml --set graph.color_weight=0.3", two),
        ("--config c.toml", two),
        ("--config c.toml --method paper", ""),
        ("--set height.min_top_m=0.02 --method paper", other),
        ("--set height.min_top_m=0.02", ""),
        ("--config defaults.toml", ""),
        ("--all", ""),
    ] {
        for command in ["segment a.pcd --out out", "explain a.pcd --at 100,100"] {
            if command.starts_with("explain") && settings.contains("paper") {
                continue;
            }
            assert_eq!(folder.run(&format!("{command} {settings}"), 0).stderr, said, "{command} {settings}");
        }
    }
    assert_eq!(folder.run("params --config c.toml", 0).stderr, "", "no method runs");
}

/// clap proposed `-- -3`.
#[test]
fn options_explain_themselves_what_is_wrong_with_a_negative_value() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    for (arguments, said) in [
        ("segment a.pcd --out out --threads -3", "give a whole number from 1 to 1024"),
        ("segment a.pcd --out out --camera -1,2,3,4", "fx -1 fy 2 cx 3 cy 4 is not a camera"),
        ("segment a.pcd --out out --roi -1,2,3,4", "`-1,2,3,4` is not a region"),
        ("segment a.pcd --out out --range -1..x", "`-1..x` is not a range"),
        ("segment a.pcd --out out --max-pixels -1", "give a whole number from 1 to 268435456"),
        ("segment --out out --depth a.png --depth-scale -5", "give a positive number"),
        ("segment a.pcd --out out --set -1", "group.parameter=value"),
        ("explain a.pcd --at -1,2", "give a column and a row"),
        ("explain a.pcd --object -1", "give a whole number from 1 to 65535"),
        ("demo --seed -1", "give a whole number from 0 to 4294967295"),
        ("eval --family bin --scenes -2", "give a whole number from 1 to 1000000"),
        ("synth --out out --scenes -2", "give a whole number from 1 to 1000000"),
        ("synth --out out --scenes 1 --family -1", "tabletop"),
        ("eval . --composites -1", "give a whole number from 0 to 4294967295"),
        ("eval --support -1", "give a whole number from 1 to 1000000"),
    ] {
        folder.refuses(arguments, said);
        let stderr = folder.run(arguments, 2).stderr;
        assert!(!stderr.contains("tip:") && !stderr.contains("digit"), "{arguments}: {stderr}");
    }
    // An option that takes a path leaves the next option alone.
    folder.refuses("segment a.pcd --out --keep-tree", "a value is required for '--out <DIR>'");
    assert_eq!(folder.names(""), ["a.pcd"]);
}

/// A frame took a minute.
#[test]
fn a_thousand_threads_are_as_many_as_there_are_cores() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let cores = std::thread::available_parallelism().unwrap().get();
    let run = folder.run("segment a.pcd --out out --threads 1000", 0);
    assert!(
        cores >= 1000 || run.stderr.starts_with("note: --threads 1000: this machine has "),
        "{}",
        run.stderr
    );
    assert_eq!(folder.run("segment a.pcd --out out --threads 1", 0).stderr, "");
}

#[test]
fn help_tells_the_exit_codes() {
    let folder = Folder::new();
    for command in ["--help", "segment --help", "eval --help", "params --help"] {
        assert!(folder.run(command, 0).stdout.contains("Exit codes:"), "{command}");
    }
    assert!(folder.run("--version", 0).stdout.starts_with("objecthood "));
    folder.run("", 2);
    folder.run("dance", 2);
    folder.run("segment", 2);
    folder.run("segment a.pcd", 2);
}

#[test]
fn a_reader_that_closes_the_pipe_has_read_enough() {
    use std::process::Stdio;

    for arguments in [&["params"] as &[&str], &["--help"]] {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_objecthood"));
        let mut child =
            command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && stderr.is_empty(), "{stderr}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_stdout_is_an_error() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_objecthood"));
    let output = command.arg("params").stdout(full).output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr.starts_with("error: cannot write to the standard output"), "{stderr}");
}

/// `context` was refused as "not there yet"; both ways of naming it give it, and the flag wins.
#[test]
fn a_method_is_named_by_flag_or_file() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder.write("method.toml", b"method = \"paper\"\n");
    for (settings, method) in [
        ("", "context"),
        ("--method paper", "paper"),
        ("--config method.toml", "paper"),
        ("--config method.toml --method context", "context"),
    ] {
        folder.run(&format!("segment a.pcd --out out {settings} --write json,structure"), 0);
        let scene: serde_json::Value = serde_json::from_slice(&folder.files("out")["a.json"]).unwrap();
        assert_eq!(scene["method"], method, "{settings}");
        assert_eq!(scene["objects"].as_array().unwrap().len(), 2, "{settings}");
    }
}
