//! Gravity: given or taken from poses, it decides what is up; without it a notice says where the ground is in doubt.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::PathBuf;

use common::scene::Cloud;
use common::{Folder, mosd, workspace};
use objecthood::discovery::UpSource;
use objecthood::{Discovery, Notice, Params, Pipeline};
use objecthood_io::{Given, Source, open_frame};

#[test]
fn given_gravity_is_up_and_what_does_not_face_it_is_no_ground() {
    let folder = Folder::new();
    folder.write("a.pcd", &Cloud::two_boxes(0.0).to_binary_pcd());
    let up = |options: &str| {
        folder.run(&format!("segment --out out {options} a.pcd"), 0);
        let json = std::fs::read(folder.path().join("out/a.json")).unwrap();
        let scene: serde_json::Value = serde_json::from_slice(&json).unwrap();
        (scene["up"].clone(), scene["notices"].to_string())
    };
    let (found, _) = up("");
    assert_eq!(found["source"], "plane");
    let down: Vec<String> = found["direction"]
        .as_array()
        .unwrap()
        .iter()
        .map(|x| (-9.81 * x.as_f64().unwrap()).to_string())
        .collect();
    let (given, notices) = up(&format!("--gravity {}", down.join(",")));
    assert_eq!(given["source"], "measured");
    assert!(!notices.contains("gravity"), "{notices}");
    let opposite: Vec<String> = down.iter().map(|x| (-x.parse::<f64>().unwrap()).to_string()).collect();
    let (_, notices) = up(&format!("--gravity {}", opposite.join(",")));
    assert!(notices.contains("180 degrees") && notices.contains("sign exchanged"), "{notices}");
    let (_, notices) = up("--gravity 1,0,0");
    assert!(notices.contains("no surface faces up"), "{notices}");
    folder.run("explain a.pcd --at 10,10 --gravity 1,0,0", 0);
    let run = folder.run("segment --out out --gravity poses a.pcd", 1);
    assert!(run.stderr.contains("no pose"), "{}", run.stderr);
    folder.refuses("segment --out out --gravity 0,0,0 a.pcd", "things fall");
}

/// The angle (degrees) between two directions.
fn angle_deg(a: [f32; 3], b: [f32; 3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>().clamp(-1.0, 1.0).acos().to_degrees()
}

/// The poses of the TUM benchmark and the plane that is found agree on what is up.
#[test]
fn the_ground_of_a_recording_faces_the_up_of_its_poses() {
    let data =
        std::env::var_os("OBJECTHOOD_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    let folder = data.join("video/tum-fr1-rpy");
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return;
    }
    let (mut pipeline, params) = (Pipeline::default(), Params::default());
    let mut estimates = None;
    for frame in Source::open(&folder, &Given::default()).unwrap() {
        let capture = frame.unwrap().read().unwrap();
        let measured = capture.pose.unwrap().up();
        let found = pipeline.discover(&capture.frame, &params).unwrap();
        let angle = angle_deg(found.up.direction, measured);
        assert!(angle < 8.0 || is_noted(found), "{angle:.1} degrees apart");
        let after = pipeline.discover(&capture.frame.clone().with_estimates(estimates), &params).unwrap();
        estimates = after.estimates;
        let angle_after = angle_deg(after.up.direction, measured);
        println!("{angle:.1} degrees apart alone, {angle_after:.1} after the frames before it");
        assert!(angle_after < 8.0, "{angle_after:.1} degrees apart");
        let told = pipeline.discover(&capture.frame.with_up(measured).unwrap(), &params).unwrap();
        assert_eq!(
            (told.up.source, angle_deg(told.up.direction, measured) < 0.1),
            (UpSource::Measured, true)
        );
        assert!(!is_noted(told), "{:?}", told.notices);
    }
}

fn is_noted(found: &Discovery) -> bool {
    found.notices.iter().any(|notice| matches!(notice, Notice::Turned { .. } | Notice::GroundInDoubt { .. }))
}

/// Tables with things on them: nothing is in doubt.
#[test]
fn clear_tables_get_no_notice() {
    let Some(mosd) = mosd() else { return };
    let (mut pipeline, params) = (Pipeline::default(), Params::default());
    let mut noted = Vec::new();
    for k in 0..67 {
        let path = mosd.join(format!("learn/learn{k}.pcd"));
        if !path.is_file() {
            continue;
        }
        let frame = open_frame(&path, &Given::default()).unwrap().frame;
        if is_noted(pipeline.discover(&frame, &params).unwrap()) {
            noted.push(k);
        }
    }
    assert!(noted.is_empty(), "{noted:?}");
}
