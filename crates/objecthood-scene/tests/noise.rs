//! The noise that a frame is estimated to have, against the noise that its sensor put there.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "what fails and what was measured is reported so"
)]

use objecthood::surface::blocks::measure_waves;
use objecthood::surface::disparity::DisparitySpace;
use objecthood::surface::surfaces::find_surfaces;
use objecthood::{Frame, Params, Raster};
use objecthood_scene::{Exposure, Family, Holes, Sensor, generate};

const SENSORS: [Sensor; 5] =
    [Sensor::Kinect, Sensor::Stereo, Sensor::Tof, Sensor::Phone, Sensor::StructuredLight];
const FAMILIES: [Family; 8] = [
    Family::Tabletop,
    Family::Stacked,
    Family::Occluded,
    Family::Vessels,
    Family::Clutter,
    Family::Room,
    Family::Shelf,
    Family::Bin,
];
/// The first of other scenes than those on which the rules were made.
const FIRST_SEED: u64 = 2000;
/// Scenes of each family.
const SCENES: u64 = 2;
/// The mean estimate is right within this share.
const WITHIN: f64 = 0.15;

/// The disagreement of blocks of 16 px (quanta) that is estimated from a frame, as it is before what counts as a Kinect becomes one, over that of the
/// noise alone: measured minus true disparity of the same pixels.
fn estimate_over_noise(frame: &Frame, exact: &Frame) -> f64 {
    let Params { sensor, local_fit, .. } = Params::default();
    let space = DisparitySpace::new(frame.camera(), &sensor);
    let [measured, truth] = [frame, exact].map(|frame| space.disparity(frame.depth_m()));
    let pixels = measured.as_slice().iter().zip(truth.as_slice());
    let (width, height) = frame.size();
    let noise =
        Raster::from_vec(width, height, pixels.map(|(measured, truth)| measured - truth).collect()).unwrap();
    let noise_quanta = measure_waves(&noise, &space)[1].unwrap().value;
    find_surfaces(frame, &sensor, &local_fit).space.noise().blocks_quanta[1] / noise_quanta
}

#[test]
fn the_noise_that_a_frame_shows_is_that_of_its_sensor() {
    let mut ratios = SENSORS.map(|_| Vec::new());
    let scenes = (FIRST_SEED..FIRST_SEED + SCENES).flat_map(|seed| FAMILIES.map(|family| (family, seed)));
    for (family, seed) in scenes {
        let world = generate(family, seed);
        let exposure = Exposure::of(&world).unwrap();
        let seen_by = |sensor| exposure.seen_by(sensor, Holes::None).unwrap().frame;
        let exact = seen_by(Sensor::Ideal);
        for (ratios, sensor) in ratios.iter_mut().zip(SENSORS) {
            ratios.push(estimate_over_noise(&seen_by(sensor), &exact));
        }
    }
    let mut means = Vec::new();
    for (ratios, sensor) in ratios.iter().zip(SENSORS) {
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let most = ratios.iter().copied().fold(0.0, f64::max);
        println!("{sensor}: {mean:.3}, between {least:.3} and {most:.3} in {} frames", ratios.len());
        means.push(mean);
    }
    assert!(means.iter().all(|mean| (mean - 1.0).abs() < WITHIN), "{means:?}");
}
