//! Active stereo: RealSense D4xx, with depth registered to the colour camera.
//!
//! | effect | model | source |
//! |---|---|---|
//! | noise | normal in disparity: z² · subpixel / (f · baseline) with 0.05 px, f = 383 px, 50 mm | Intel, *Tuning depth cameras for best performance* (Grunnet-Jepsen, Sweetser, Woodfill 2018); D435 at 640 x 480 |
//! | steps | depth in whole millimetres | default depth unit of librealsense |
//! | half occlusion | no depth where the left imager (15 mm to the right of the colour camera) or the right one (65 mm) does not see the surface | layout of the D435; Keselman et al. 2017 |
//! | waves | a second, wider field of noise, 0.85 of the first, correlated over 20 px: bumps of 20 to 40 px | ours, fitted to recordings of a RealSense: neighbouring blocks of 32 x 32 px disagree 2.7 to 7.8 times as much as a Kinect's (`tests/waves.rs`) |
//! | edges | the nearer surface grows by 1 to 3 px, as the window of correlation prefers it | Keselman et al. 2017 |
//! | smooth surfaces | noise is correlated over several px: bumps | Intel, as above ("bumpy" noise of the window and filters) |
//! | range | nothing below 0.28 m or beyond 6 m | data sheet: minimum distance of the D435 |

use rayon::prelude::*;

use super::{Measured, continued_depth, displaced, facing, seen_from, window};
use crate::noise;
use crate::view::View;
use crate::world::World;

const QUANTUM_PER_M: f64 = 0.05 / (383.0 * 0.050);
const IMAGERS_M: [f64; 2] = [0.015, 0.065];
const UNIT_M: f64 = 0.001;
const RANGE_M: std::ops::Range<f64> = 0.28..6.0;
const NOISE_WIDTH_PX: f64 = 3.5;
/// Deviation over that of the narrow noise; width.
const WAVES: f64 = 0.85;
const WAVES_WIDTH_PX: f64 = 10.0;
const JITTER_PX: f64 = 0.7;
const FATTENING_PX: usize = 2;
const SEEN_SHARE: f64 = 0.55;
const STEEPEST: f64 = 0.1;

pub(super) fn measure(world: &World, view: &View) -> Vec<Measured> {
    let (width, height, seed) = (view.width, view.height, world.noise_seed());
    let usable: Vec<bool> = view
        .sights
        .par_iter()
        .map(|sight| {
            sight.as_ref().is_some_and(|sight| {
                RANGE_M.contains(&sight.t)
                    && facing(world, sight) > STEEPEST
                    && IMAGERS_M.iter().all(|&imager| seen_from(world, sight, imager))
            })
        })
        .collect();
    let smooth = |stream, sigma_px| noise::smooth(seed, stream, width, height, sigma_px);
    let (jitter_u, jitter_v) = (smooth(31, 2.0), smooth(32, 2.0));
    let disparity_noise = smooth(33, NOISE_WIDTH_PX);
    let appetite = smooth(34, 3.0);
    let waves = smooth(35, WAVES_WIDTH_PX);

    let pixel = |i: usize| {
        let (u, v) = (i % width, i / width);
        let at = displaced(view, (u, v), (jitter_u[i] * JITTER_PX, jitter_v[i] * JITTER_PX));
        let radius = (FATTENING_PX as f64 + appetite[i]).round().clamp(0.0, 3.0) as usize;
        let (mut all, mut seen) = (0.0, 0.0);
        let mut nearest: Option<(f64, usize)> = None;
        for k in window(view, at.0, at.1, radius) {
            all += 1.0;
            if let Some(sight) = view.sights[k].filter(|_| usable[k]) {
                seen += 1.0;
                if nearest.is_none_or(|(depth, _)| sight.t < depth) {
                    nearest = Some((sight.t, k));
                }
            }
        }
        let (Some((_, source)), Some(own)) = (nearest, view.sights[i]) else { return Measured::NONE };
        if seen < SEEN_SHARE * all {
            return Measured::NONE;
        }
        let Some(sight) = view.sights[source] else { return Measured::NONE };
        let ray = world.viewpoint().ray(u as f64, v as f64);
        let (depth, source) = if own.surface == sight.surface {
            (own.t, i)
        } else {
            // Only a nearer surface grows; one that the own surface meets without a step does not.
            let grown = continued_depth(ray, &sight);
            if grown < own.t - 0.01 { (grown, source) } else { (own.t, i) }
        };
        if !usable[source] {
            return Measured::NONE;
        }
        let disparity = 1.0 / depth + QUANTUM_PER_M * (disparity_noise[i] + WAVES * waves[i]);
        let depth = (1.0 / disparity / UNIT_M).round() * UNIT_M;
        Measured { depth_m: depth as f32, source }
    };
    (0..width * height).into_par_iter().map(pixel).collect()
}
