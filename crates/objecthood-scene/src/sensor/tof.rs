//! Time of flight: Kinect v2, Azure Kinect, with depth registered to the colour camera.
//!
//! | effect | model | source |
//! |---|---|---|
//! | noise | normal in range, white, deviation 0.7 mm at 1 m of a white surface, growing with the square root of the light that does not return: z / sqrt(albedo · cos θ) | Tölgyessy et al. 2021 (Azure Kinect: below 2 mm up to 3.5 m); shot noise |
//! | wiggling | a periodic error of 1.5 mm over 1.5 m | Lindner et al. 2010; Azure Kinect specification: systematic error below 11 mm + 0.1 % |
//! | flying pixels | where a pixel's 3 x 3 neighbourhood spans more than 2 cm in range, the mean of what it sees weighted by returned light; a third of these is rejected | Sarbolandi, Lefloch and Kolb 2015 |
//! | several paths | light that comes by way of one other surface lengthens the depth: mm to cm near concave corners | Fuchs 2010 (*Multipath interference compensation in time-of-flight camera images*); Jiménez et al. 2014; geometry in `tof/multipath.rs` |
//! | weak return | nothing where albedo · cos θ / z² < 0.02 or beyond 5 m | Azure Kinect specification: low-signal invalidation |
//! | steps | depth in whole millimetres | both devices' drivers |
//!
//! The lamp sits beside the lens, so that there is no shadow. Dark surfaces return little light, so they are noisy by the
//! first row: at an albedo of 5 % four times as much as at 80 %.

mod multipath;

use rayon::prelude::*;

use super::{Measured, facing, window};
use crate::random::Field;
use crate::view::View;
use crate::world::{Sight, World};

const NOISE_M: f64 = 0.0007;
const WIGGLE_M: f64 = 0.0015;
const WIGGLE_PERIOD_M: f64 = 1.5;
const STEP_M: f64 = 0.02;
const REJECTED_SHARE: f64 = 1.0 / 3.0;
const WEAKEST: f64 = 0.02;
const RANGE_M: std::ops::Range<f64> = 0.25..5.0;
const UNIT_M: f64 = 0.001;

pub(super) fn measure(world: &World, view: &View) -> Vec<Measured> {
    let (noise, rejection) = (Field::new(world.noise_seed(), 41), Field::new(world.noise_seed(), 42));
    let returned: Vec<f64> = view
        .sights
        .par_iter()
        .map(|sight| sight.as_ref().map_or(0.0, |s| returned_light(world, s)))
        .collect();

    let longer_m = multipath::errors_m(world, view);

    let pixel = |i: usize| {
        let (u, v) = (i % view.width, i / view.width);
        let at = (u as i64, v as i64);
        let Some(own) = view.sights[i] else { return Measured::NONE };
        let (mut light, mut weighted, mut low, mut high) = (0.0, 0.0, f64::INFINITY, 0.0_f64);
        for k in window(view, u, v, 1) {
            if let Some(sight) = view.sights[k] {
                // Half of the light that reaches a pixel is its own.
                let share = returned[k] * if k == i { 8.0 } else { 1.0 };
                light += share;
                weighted += share * (sight.t + longer_m[k]);
                (low, high) = (low.min(sight.t), high.max(sight.t));
            }
        }
        let flies = high - low > STEP_M;
        let signal = if flies { light / 16.0 } else { returned[i] };
        if signal < WEAKEST
            || !RANGE_M.contains(&own.t)
            || (flies && rejection.unit(at.0, at.1) < REJECTED_SHARE)
        {
            return Measured::NONE;
        }
        let mean = if flies { weighted / light } else { own.t + longer_m[i] };
        let wiggle = WIGGLE_M * libm::sin(std::f64::consts::TAU * mean / WIGGLE_PERIOD_M);
        let depth = mean + wiggle + NOISE_M / signal.sqrt() * noise.normal(at.0, at.1);
        Measured { depth_m: ((depth / UNIT_M).round() * UNIT_M) as f32, source: i }
    };
    (0..view.sights.len()).into_par_iter().map(pixel).collect()
}

/// Light that returns, 1 from a white surface that faces the camera at 1 m.
fn returned_light(world: &World, sight: &Sight) -> f64 {
    let albedo = world.albedo(sight).iter().sum::<f64>() / 3.0;
    albedo * facing(world, sight) / (sight.t * sight.t)
}
