//! How far neighbouring blocks of a surface disagree: what tells the waves of stereo from the noise of single pixels.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails is reported so")]

mod common;

use common::waves::disagreement;
use objecthood_scene::{Exposure, Family, Holes, Sensor, generate};

/// What a real Kinect has for blocks of 16 and of 32 px (quanta): 23 frames of mOSD learn.
const KINECT: [f64; 2] = [0.21, 0.15];

/// Recordings of a RealSense have 1.95 to 4.5 times the Kinect's at 16 px, and 2.7 to 7.8 times at 32 px.
#[test]
fn stereo_waves_are_as_long_as_those_of_a_real_one() {
    let families = [Family::Tabletop, Family::Stacked, Family::Occluded, Family::Clutter];
    let mut ratios = [[0.0; 2]; 2];
    for (family, seed) in families.into_iter().zip(3..) {
        let world = generate(family, seed);
        let exposure = Exposure::of(&world).unwrap();
        for (sum, sensor) in ratios.iter_mut().zip([Sensor::Stereo, Sensor::Kinect]) {
            let seen = exposure.seen_by(sensor, Holes::None).unwrap();
            for (k, side) in [16, 32].into_iter().enumerate() {
                sum[k] += disagreement(seen.frame.depth_m(), side).unwrap() / KINECT[k] / 4.0;
            }
        }
    }
    let [stereo, kinect] = ratios;
    println!("stereo {stereo:?}, kinect {kinect:?}");
    assert!((2.0..3.2).contains(&stereo[0]) && (3.4..4.1).contains(&stereo[1]), "{stereo:?}");
    assert!(kinect.iter().all(|ratio| (0.8..1.5).contains(ratio)), "{kinect:?}");
}
