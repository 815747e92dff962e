//! Dense structured light as in industry: a projector of stripes beside one camera.
//!
//! | effect | model | source |
//! |---|---|---|
//! | noise | white, normal in disparity, 0.1 mm at 0.65 m, growing with the square of the distance | Photoneo, data sheet of the `PhoXi` 3D Scanner M: temporal noise; the square is triangulation |
//! | steps | 1/z in whole steps of 0.00015 1/m (0.06 mm at 0.65 m) | ours, because codes of stripes are whole numbers; fine enough to stay below the noise |
//! | shadow | no depth where the projector, 0.12 m to the right of the camera, does not see the surface: one side only | ours: heads for robots are 0.1 to 0.4 m wide |
//! | edges | no depth beside a step of more than 1 % of the depth: mixed pixels are recognised by their weak code and taken out | ours, because the point clouds of these devices come without flying pixels |
//! | dropouts | none on surfaces turned away by more than 75 degrees or darker than 2 % | ours, the code is too weak there |
//! | range | 0.4 to 3.8 m | the same series, from the nearest of model M to the farthest of model XL |
//!
//! Lateral resolution is that of the image: no jitter, no window.

use rayon::prelude::*;

use super::{Measured, facing, seen_from, window};
use crate::random::Field;
use crate::view::View;
use crate::world::{Sight, World};

/// Deviation of 1/z (1/m): 0.1 mm over the square of 0.65 m.
const NOISE_PER_M: f64 = 0.0001 / (0.65 * 0.65);
const QUANTUM_PER_M: f64 = 0.000_15;
const PROJECTOR_M: f64 = 0.12;
/// Of the depth.
const STEP_SHARE: f64 = 0.01;
/// The cosine of 75 degrees.
const GRAZING: f64 = 0.259;
const BLACK: f64 = 0.02;
const RANGE_M: std::ops::Range<f64> = 0.4..3.8;

pub(super) fn measure(world: &World, view: &View) -> Vec<Measured> {
    let noise = Field::new(world.noise_seed(), 71);
    let pixel = |i: usize| {
        let (u, v) = (i % view.width, i / view.width);
        let Some(sight) = view.sights[i].filter(|sight| is_coded(world, sight)) else {
            return Measured::NONE;
        };
        let is_step = |k: usize| {
            let other = view.sights[k].filter(|other| other.surface != sight.surface);
            other.is_some_and(|other| (other.t - sight.t).abs() > STEP_SHARE * sight.t)
        };
        if window(view, u, v, 1).any(is_step) {
            return Measured::NONE;
        }
        let disparity = 1.0 / sight.t + NOISE_PER_M * noise.normal(u as i64, v as i64);
        let depth = 1.0 / ((disparity / QUANTUM_PER_M).round() * QUANTUM_PER_M);
        Measured { depth_m: depth as f32, source: i }
    };
    (0..view.sights.len()).into_par_iter().map(pixel).collect()
}

/// Whether enough of the projector's light comes back.
fn is_coded(world: &World, sight: &Sight) -> bool {
    RANGE_M.contains(&sight.t)
        && facing(world, sight) > GRAZING
        && world.albedo(sight).iter().sum::<f64>() / 3.0 > BLACK
        && seen_from(world, sight, PROJECTOR_M)
}
