//! Up, as `context` tells it from a frame alone, in scenes whose wall, shelf or bin is larger than the ground.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "what fails and what was measured is reported so"
)]

use objecthood::{Discovery, Notice, Params, discover};
use objecthood_scene::{Family, Sensor, Viewpoint, World, generate, render};
use rayon::prelude::*;

const FAMILIES: [Family; 3] = [Family::Room, Family::Shelf, Family::Bin];
/// The first of other scenes than those on which the rules were made.
const FIRST_SEED: u64 = 2000;
/// Up is right within this angle (degrees).
const RIGHT_DEG: f64 = 5.0;

/// What was found in the scene by a camera that is turned clockwise about its axis, and the error of up (degrees).
fn seen(world: &World, roll_deg: f64) -> (Discovery, f64) {
    let Viewpoint { camera, size_px, pose } = *world.viewpoint();
    let pose = pose.turned(2, roll_deg);
    let rolled = world.with_viewpoint(Viewpoint { camera, size_px, pose }).unwrap();
    let found = discover(&render(&rolled, Sensor::Kinect).unwrap().frame, &Params::default()).unwrap();
    let up = glam::DQuat::from_array(pose.rotation_xyzw()).inverse() * glam::DVec3::Z;
    let error = up.angle_between(glam::Vec3::from(found.up.direction).as_dvec3()).to_degrees();
    (found, error)
}

fn is_told(found: &Discovery) -> bool {
    let told = |notice: &Notice| matches!(notice, Notice::Turned { .. } | Notice::GroundInDoubt { .. });
    found.notices.iter().any(told)
}

/// Of each family as many scenes as `OBJECTHOOD_MANY` says, or so few that the test is quick. Up has to be right in 49 of 50 frames (all but one of fewer), and
/// right or announced in as many that are turned by 90 degrees. Of those turned by 180 degrees one in ten may fail: a few bins and shelves do.
#[test]
fn up_is_right_where_walls_shelves_and_bins_are_larger_than_the_ground() {
    let scenes: u64 = std::env::var("OBJECTHOOD_MANY").map_or(4, |text| text.parse().unwrap());
    let mut worlds: Vec<(Family, u64)> = Vec::new();
    for family in FAMILIES {
        worlds.extend((FIRST_SEED..FIRST_SEED + scenes).map(|seed| (family, seed)));
    }
    let all = worlds.len();
    let rows: Vec<[bool; 4]> = worlds
        .into_par_iter()
        .map(|(family, seed)| {
            let world = generate(family, seed);
            let (upright, error) = seen(&world, 0.0);
            let turned = |roll_deg: f64| {
                let (found, error) = seen(&world, roll_deg);
                if error > RIGHT_DEG {
                    println!(
                        "{family:?} {seed} turned by {roll_deg}: {error:.1} degrees, {:?}",
                        found.notices
                    );
                }
                error <= RIGHT_DEG || is_told(&found)
            };
            if error > RIGHT_DEG || is_told(&upright) {
                println!("{family:?} {seed}: {error:.1} degrees, {:?}", upright.notices);
            }
            [error <= RIGHT_DEG, is_told(&upright), turned(90.0), turned(180.0)]
        })
        .collect();
    let count = |column: usize| rows.iter().filter(|row| row[column]).count();
    let [right, doubted, quarter, half] = [0, 1, 2, 3].map(count);
    println!(
        "{all} frames: up is right in {right}, doubted in {doubted}; turned by 90 and 180 degrees right or announced in {quarter} and {half}"
    );
    let [few, more] = [all / 50, all / 10].map(|share| share.max(1));
    assert!(right + few >= all && quarter + few >= all && half + more >= all);
}
