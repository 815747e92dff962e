//! `objecthood explain`: text, JSON and picture of one pixel.

#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

mod common;

use common::Folder;
use common::scene::Cloud;
use serde_json::Value;

/// How the images of a synthetic scene are named on the command line.
const STACKED: &str = "--color in/stacked2-color.png --depth in/stacked2-depth.png --camera in/camera.json";

/// A synthetic scene: two books and a box on them, and a second stack beside.
fn stacked() -> Folder {
    let folder = Folder::new();
    folder.run("synth --out in --scenes 1 --seed 2 --family stacked", 0);
    folder
}

fn two_boxes() -> Folder {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    folder
}

/// When a change is meant to alter it: `INSTA_UPDATE=always cargo test -p objecthood-cli --test explain`.
#[test]
fn the_text_of_an_object_and_of_the_table() {
    let folder = stacked();
    let run = folder.run(&format!("explain {STACKED} --at 239,146"), 0);
    assert_eq!(run.stderr, "");
    insta::assert_snapshot!("object", run.stdout);
    insta::assert_snapshot!("table", folder.run(&format!("explain {STACKED} --at 320,400"), 0).stdout);
    let again = folder.run(&format!("explain {STACKED} --at 239,146 --threads 1"), 0);
    assert_eq!(again.stdout, run.stdout, "whatever the number of threads");
}

#[test]
fn what_it_says_of_a_parameter_is_true() {
    let folder = stacked();
    let run = folder.run(&format!("explain {STACKED} --object 1"), 0);
    let setting = run.stdout.split_once("would change with --set ").unwrap().1;
    let setting = setting.split_whitespace().next().unwrap();
    let pixel = run.stdout.split_once(": pixel ").unwrap().1.split_whitespace().next().unwrap();
    // The first that is said is why it is an object at all.
    assert!(run.stdout.starts_with("This pixel belongs to object 1: "), "{}", run.stdout);
    assert!(run.stdout.contains("Is it an object?\n  yes: "));
    let other = folder.run(&format!("explain {STACKED} --at {pixel} --set {setting}"), 0);
    assert!(other.stdout.contains("Is it an object?\n  no: "), "{setting}: {}", other.stdout);
}

#[test]
fn json_holds_the_same() {
    let folder = stacked();
    let json: Value =
        serde_json::from_str(&folder.run(&format!("explain {STACKED} --object 1 --json"), 0).stdout).unwrap();
    assert_eq!(json["explanation_version"], 1);
    assert_eq!(json["input"], "in/stacked2-depth.png");
    assert_eq!(json["parameters_fingerprint"].as_str().unwrap().len(), 64);
    assert_eq!((&json["outcome"]["kind"], &json["outcome"]["object"]), (&"object".into(), &1.into()));
    let facet = json["facet"]["facet"].as_u64().unwrap();
    assert!(json["object"]["facets"].as_array().unwrap().iter().any(|own| own.as_u64() == Some(facet)));
    assert!(json["object"]["parts"].as_array().unwrap().iter().all(|part| part["value"].is_number()));
    assert!(json["kept"]["yes"].as_bool().unwrap());
    check_decision(&json["kept"]);
    let lists = ["way", "near_misses"].iter().flat_map(|key| json[key].as_array().unwrap());
    lists.for_each(check_decision);
    let borders = json["borders"].as_array().unwrap();
    assert!(!borders.is_empty());
    for border in borders {
        for key in ["gap_quanta", "gap_mm", "folded_mm", "stepped_mm", "facet"] {
            assert!(border[key].is_number(), "{key} {border}");
        }
        assert_eq!(border["vote_mm"].is_number(), border["structure_plane"].is_null(), "{border}");
        if let Some(decision) = border.get("decision") {
            check_decision(decision);
        }
    }
}

fn check_decision(decision: &Value) {
    assert!(decision["question"]["kind"].is_string() && decision["yes"].is_boolean(), "{decision}");
    assert!(decision["reason"].is_string(), "{decision}");
    for check in decision["checks"].as_array().unwrap() {
        assert!(check["measured"].is_number() && check["limit"].is_number(), "{check}");
        assert!(
            check["what"].is_string() && check["bound"].is_string() && check["holds"].is_boolean(),
            "{check}"
        );
    }
    match decision["flip"]["kind"].as_str().unwrap() {
        "at" => {
            let (to, parameter) = (&decision["flip"]["to"], decision["flip"]["parameter"].as_str().unwrap());
            assert!(to.is_number() && (to.is_i64() || !parameter.ends_with("size_px")), "{decision}");
        }
        "nowhere" => assert!(decision["flip"]["tried"].is_array()),
        kind => assert_eq!(kind, "not_sought"),
    }
}

#[test]
fn a_picture_is_written_and_named() {
    let folder = two_boxes();
    let run = folder.run("explain a.pcd --at 100,120 --out new/out", 0);
    assert!(run.stdout.ends_with("\nnew/out/a.explain.png\n"), "{}", run.stdout);
    assert_eq!(folder.names("new/out"), ["a.explain.png"]);
    let picture = image::load_from_memory(&folder.files("new/out")["a.explain.png"]).unwrap();
    assert!(picture.width() > 2 * 320 && picture.height() > 240);
    let json = folder.run("explain a.pcd --at 100,120 --out out --json", 0).stdout;
    assert!(serde_json::from_str::<Value>(&json).is_ok(), "nothing but JSON is printed: {json}");
    assert_eq!(folder.names("out"), ["a.explain.png"]);
}

#[test]
fn where_nothing_was_measured_it_says_so() {
    let folder = Folder::new();
    let mut hole = Cloud::two_boxes(0.0);
    hole.points[10 * hole.width..][..40].iter_mut().for_each(|point| point.xyz_m = [f32::NAN; 3]);
    folder.write("a.pcd", &hole.to_binary_pcd());
    let text = folder.run("explain a.pcd --at 10,10", 0).stdout;
    assert!(text.contains("no depth here") && !text.contains("facet "), "{text}");
    let json: Value = serde_json::from_str(&folder.run("explain a.pcd --at 10,10 --json", 0).stdout).unwrap();
    assert_eq!(json["outcome"]["kind"], "no_depth");
    assert!(json.get("facet").is_none() && json.get("depth_m").is_none());
    folder.run("explain a.pcd --at 10,10 --out out", 0);
    assert_eq!(folder.names("out"), ["a.explain.png"], "there is a picture of that too");
}

#[test]
fn every_parameter_is_tried_for_a_repair() {
    let folder = two_boxes();
    let text = folder.run("explain a.pcd --object 1 --repair", 0).stdout;
    assert!(
        text.starts_with("a.pcd: pixel ") && text.contains(" is in object 1.\nWhat makes it no object, of "),
        "{text}"
    );
    let setting = text.split_once("\n  --set ").unwrap().1.split_whitespace().next().unwrap();
    let pixel = text.split_once(": pixel ").unwrap().1.split_whitespace().next().unwrap();
    let other = folder.run(&format!("explain a.pcd --at {pixel} --set {setting}"), 0).stdout;
    assert!(other.starts_with("This pixel belongs to no object"), "{setting}: {other}");

    let asked = format!("explain a.pcd --at {pixel} --with 2,2 --repair");
    let text = folder.run(&asked, 0).stdout;
    assert!(text.contains("is in object 1, and pixel 2,2 in no object.\n"), "{text}");
    assert!(text.contains(" makes them one object"), "{text}");
    let json: Value = serde_json::from_str(&folder.run(&format!("{asked} --json"), 0).stdout).unwrap();
    assert_eq!((&json["repair_version"], &json["now"]["kind"]), (&1.into(), &"not_both".into()));
    assert_eq!((&json["with"], &json["left"]), (&serde_json::json!([2, 2]), &serde_json::json!([])));
    assert!(json["tried"].as_u64().unwrap() > 50, "{json}");

    let asked = format!("explain a.pcd --at {pixel} --repair --json");
    let json: Value = serde_json::from_str(&folder.run(&asked, 0).stdout).unwrap();
    assert!(!json["found"].as_array().unwrap().is_empty(), "{json}");
    for repair in json["found"].as_array().unwrap() {
        assert!(repair["parameter"].is_string() && repair["to"] != repair["from"], "{repair}");
        assert!(repair["others"]["came"].is_u64() && repair["change"].is_number(), "{repair}");
    }
}

#[test]
fn questions_that_cannot_be_answered_are_refused() {
    let folder = two_boxes();
    folder.write("b.pcd", &Cloud::two_boxes(0.01).to_binary_pcd());
    folder.refuses("explain a.pcd --at 320,10", "320,10 lies outside the image of 320 x 240 pixels");
    folder.refuses("explain a.pcd --at 10,240", "a row up to 239");
    for at in ["10", "10,x", "1.5,2", ",", "10,20,30", "99999999999999999999,1"] {
        folder.refuses(&format!("explain a.pcd --at {at}"), "give a column and a row");
    }
    folder.refuses("explain a.pcd --object 3", "the objects of this frame are 1 to 2");
    folder.refuses("explain a.pcd --object 0", "give a whole number from 1 to 65535");
    folder.refuses("explain a.pcd", "--at <X,Y>");
    folder.refuses("explain a.pcd --at 1,1 --object 1", "cannot be used with");
    folder.refuses("explain a.pcd --at 1,1 --with 2,2", "--repair");
    folder.refuses("explain a.pcd --at 1,1 --with 320,2 --repair", "320,2 lies outside");
    folder.refuses("explain a.pcd --at 1,1 --repair --out out", "cannot be used with");
    folder.refuses("explain a.pcd b.pcd --at 1,1", "2 frames are named");
    folder.refuses("explain a.pcd --at 1,1 --method paper", "only the decisions of `context`");
    folder.refuses("explain a.pcd --at 1,1 --out a.pcd", "is a file");
    folder.refuses("explain a.pcd --at 1,1 --set height.min_top_m=99", "outside its range");
    let run = folder.run("explain none.pcd --at 1,1", 1);
    assert!(run.errors().len() == 1 && run.stderr.contains("none.pcd"), "{}", run.stderr);
    assert!(folder.names("out").is_empty());
}
