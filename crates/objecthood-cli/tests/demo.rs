//! `objecthood demo` and `objecthood completions`: what needs no input.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::{Folder, Run, workspace};
use serde_json::Value;

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

/// The commands that a run proposes.
fn next_commands(run: &Run) -> Vec<&str> {
    run.stdout.lines().skip_while(|line| *line != "next:").skip(1).map(str::trim).collect()
}

/// What to do next was printed as `objecthood ..`, which runs only where the program is on the path.
#[cfg(unix)]
#[test]
fn the_next_commands_run_as_printed() {
    let folder = Folder::new();
    // Commands that take long are not run to the end here, but in `eval_of_families_is_eval_of_their_files`.
    let small = |command: &str| command.replace("--scenes 20", "--scenes 1");
    let run_all = |run: &Run, expected: usize| {
        let commands = next_commands(run);
        assert_eq!(commands.len(), expected, "{}", run.stdout);
        for command in commands {
            let shell = std::process::Command::new("sh")
                .current_dir(folder.path())
                .args(["-c", &small(command)])
                .output()
                .unwrap();
            assert!(shell.status.success(), "{command}\n{}", String::from_utf8_lossy(&shell.stderr));
        }
    };
    run_all(&folder.run("demo --out it's", 0), 3);
    run_all(&folder.run("synth --out it's-more --scenes 1", 0), 3);
    assert!(folder.names("it's/again").contains(&"tabletop34.overlay.png".to_owned()));
}

#[test]
fn the_demo_of_a_video_shows_the_commands_that_it_runs_and_what_they_say() {
    let folder = Folder::new();
    let run = folder.run("demo --video=walker --seed 1 --out it", 0);
    let commands: Vec<&str> = run.stdout.lines().filter_map(|line| line.strip_prefix("$ ")).collect();
    let ends: Vec<&str> = commands.iter().map(|line| line.split_once("objecthood ").unwrap().1).collect();
    assert_eq!(
        ends,
        [
            "synth --video walker --seed 1 --out it",
            "track it/walker1 --out it/walker1-tracks --write pictures --summary",
            "eval --tracks it/walker1-tracks --truth it/walker1",
        ]
    );
    assert!(run.stdout.contains("| walker1 |"), "{}", run.stdout);
    assert!(run.stdout.ends_with("look at: it/walker1-tracks/pictures\n"), "{}", run.stdout);
    assert_eq!(folder.names("it/walker1-tracks/pictures").len(), folder.names("it/walker1/depth").len());
    let refused = folder.run("demo --video=pick --method paper", 2);
    assert!(refused.stderr.contains("--video"), "{}", refused.stderr);
}

#[test]
fn the_first_command_shows_what_the_program_does() {
    let folder = Folder::new();
    let run = folder.run("demo", 0);
    assert_eq!(run.stderr, "");
    let name = "objecthood-demo/tabletop34";
    assert!(run.stdout.starts_with("tabletop34, method "), "{}", run.stdout);
    assert!(run.stdout.contains(&format!("look at: {name}.panels.png\n")), "{}", run.stdout);
    assert!(run.stdout.contains("superpixels ") && run.stdout.contains(" ms"), "{}", run.stdout);
    let files = folder.files("objecthood-demo");
    let expected = [
        "camera.json",
        "tabletop/tabletop34.pcd",
        "tabletop34-color.png",
        "tabletop34-depth.png",
        "tabletop34-scene.json",
        "tabletop34-surfaces.png",
        "tabletop34-truth.png",
        "tabletop34.json",
        "tabletop34.labels.png",
        "tabletop34.panels.png",
    ];
    assert_eq!(files.keys().collect::<Vec<_>>(), expected);
    let schema = std::fs::read(workspace().join("docs/scene.schema.json")).unwrap();
    let found = json(&files["tabletop34.json"]);
    jsonschema::validate(&json(&schema), &found).unwrap();

    // The table has a line for every object of the truth that is seen, in its order.
    let scene = json(&files["tabletop34-scene.json"]);
    let solids = scene["solids"].as_array().unwrap().iter();
    let objects: Vec<&Value> = solids.filter(|s| s["role"] == "object" && s["size_px"] != 0).collect();
    let rows: Vec<Vec<&str>> = run
        .stdout
        .lines()
        .skip_while(|line| !line.starts_with("  id  object"))
        .skip(1)
        .take_while(|line| !line.is_empty())
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert_eq!(rows.len(), objects.len());
    for (row, object) in rows.iter().zip(&objects) {
        assert_eq!(
            (row[1], row[2].parse::<u64>().ok()),
            (object["kind"].as_str().unwrap(), object["size_px"].as_u64())
        );
    }
    let correct = rows.iter().filter(|row| row[6] == "correct").count();
    assert!(run.stdout.contains(&format!("{correct} of {} objects correct", rows.len())), "{}", run.stdout);

    // A regression: rows could not be matched with the numbers in the picture.
    let most_of = |kind: &str, file: &str| {
        let label_image = |name: &str| image::load_from_memory(&files[name]).unwrap().into_luma16();
        let (truth, found) = (label_image("tabletop34-truth.png"), label_image(file));
        let of_kind = objects.iter().find(|object| object["kind"] == kind).unwrap();
        let own = truth.pixels().zip(found.pixels()).filter(|(t, _)| of_kind["instance"] == t.0[0]);
        let mut numbers: Vec<u16> = own.map(|(_, f)| f.0[0]).collect();
        numbers.sort_unstable();
        numbers[numbers.len() / 2].to_string()
    };
    for kind in ["ball", "cone"] {
        let row = rows.iter().find(|row| row[1] == kind).unwrap();
        assert_eq!(row[0], most_of(kind, "tabletop34.labels.png"), "{kind}");
    }

    // What it proposes gives the same bytes from the files.
    let again = next_commands(&run)[1].split_once(" segment ").unwrap().1;
    folder.run(&format!("segment {again}"), 0);
    for name in ["tabletop34.json", "tabletop34.labels.png"] {
        assert!(folder.files("objecthood-demo/again")[name] == files[name], "{name}");
    }
    folder.run("eval objecthood-demo", 0);
}

#[test]
fn the_same_number_is_the_same_demo() {
    let folder = Folder::new();
    folder.run("demo --seed 7 --threads 1", 0);
    let first = folder.files("objecthood-demo");
    std::fs::rename(folder.path().join("objecthood-demo"), folder.path().join("first")).unwrap();
    folder.run("demo --seed 7 --threads 3", 0);
    assert!(folder.files("objecthood-demo") == first);
    // A scene of `synth` with the same name is the same scene.
    folder.run("synth --out synth --scenes 1 --seed 7 --family tabletop", 0);
    for (name, bytes) in folder.files("synth") {
        assert!(first[&name] == bytes, "{name}");
    }
    folder.run("demo --seed 8 --out other --set objectness.max_side_m=0.01", 0);
    assert!(folder.names("other").contains(&"tabletop8.labels.png".to_owned()));
}

#[test]
fn mistakes_are_explained_and_nothing_is_done() {
    let folder = Folder::new();
    folder.write("file", b"content");
    for (arguments, said) in [
        ("--out file", "--out file is a file: name a folder"),
        ("--seed x", "x"),
        ("--set curvature.thresold=0.1", "`curvature.threshold`"),
        ("--method magic", "paper"),
    ] {
        folder.refuses(&format!("demo {arguments}"), said);
    }
    std::fs::create_dir_all(folder.path().join("out/tabletop34.json")).unwrap();
    let run = folder.run("demo --out out", 1);
    assert!(run.errors()[0].contains("tabletop34.json"), "{}", run.stderr);
    assert_eq!(folder.names(""), ["file"]);
}

#[test]
fn shells_complete_the_command_line() {
    let folder = Folder::new();
    for (shell, sign) in [
        ("bash", "complete -F"),
        ("zsh", "#compdef objecthood"),
        ("fish", "complete -c objecthood"),
        ("powershell", "Register-ArgumentCompleter"),
        ("elvish", "edit:completion"),
    ] {
        let script = folder.run(&format!("completions {shell}"), 0).stdout;
        assert!(script.contains(sign), "{shell}");
        for word in ["segment", "demo", "synth", "completions", "depth-scale"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let run = folder.run("completions tcsh", 2);
    assert!(run.stderr.contains("bash, elvish, fish, powershell, zsh"), "{}", run.stderr);
}
