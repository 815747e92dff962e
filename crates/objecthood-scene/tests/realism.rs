//! The synthetic Kinect against the real one.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails is reported so")]

mod common;

use common::statistics::Statistics;
use objecthood_scene::{Family, Sensor, export, generate, render};

/// The families that mOSD learn has, in about its shares.
const SCENES: [(Family, u64); 4] =
    [(Family::Tabletop, 8), (Family::Stacked, 4), (Family::Occluded, 4), (Family::Vessels, 4)];

fn synthetic() -> Statistics {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("learn");
    std::fs::create_dir(&folder).unwrap();
    for (family, count) in SCENES {
        for seed in 0..count {
            let world = generate(family, seed);
            let rendered = render(&world, Sensor::Kinect).unwrap();
            std::fs::write(folder.join(format!("{family}{seed}.pcd")), export::pcd(&world, &rendered, true))
                .unwrap();
        }
    }
    Statistics::of_learn(root.path())
}

/// Issue 3, "what it must show".
#[test]
fn the_synthetic_kinect_is_like_the_real_one() {
    let ours = synthetic();
    let real = common::mosd().map(|root| Statistics::of_learn(&root));
    println!("synthetic {ours:?}\nmOSD learn {real:?}");
    assert!((ours.fit_residual - 0.525).abs() < 0.05, "{ours:?}");
    assert!((1.0..1.3).contains(&ours.table_residual), "{ours:?}");

    let Some(real) = real else { return };
    assert!((real.fit_residual - 0.525).abs() < 0.005, "{real:?}");
    assert!((1.0..1.3).contains(&real.table_residual), "{real:?}");
    let ratio = ours.missing_at_borders / real.missing_at_borders;
    assert!((0.7..1.3).contains(&ratio), "{ours:?} {real:?}");
}
