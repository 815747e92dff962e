//! Structured light: Kinect v1, Xtion, Carmine, with depth registered to the colour camera.
//!
//! | effect | model | source |
//! |---|---|---|
//! | disparity steps | 1/z in whole steps of 1/348 1/m: raw = 1091.5 - 348/z | docs/CONTEXT.md 0.2; Khoshelham and Elberink 2012 |
//! | projector's and camera's shadow | no depth where the projector, 50 mm to the right of the colour camera, or the infrared camera, 25 mm to its left, does not see the surface (75 mm baseline) | Khoshelham and Elberink 2012; layout of the device |
//! | window of correlation | no depth where less than half of a 7 x 7 window is seen by both (9 x 9 in the device, at 1280 x 1024) | Konolige and Mihelich 2010 |
//! | lateral jitter | borders of surfaces wander by 0.8 px, more where the surface is grazed | Nguyen, Izadi and Lovell 2012: 0.8 + 0.035 θ/(π/2 - θ) px |
//! | noise | normal in disparity, correlated over some px, and a slow warp of the whole image | figures fitted to mOSD learn, below |
//! | dropouts | no depth beyond about 80 degrees of incidence, on black, where two depths mix in the window, below 0.45 m, beyond 5 m | Nguyen et al. 2012 (no data beyond 80 degrees); share of the mixed fitted to mOSD learn |
//!
//! Fitted to the 45 scenes of mOSD learn: plane-fit residual over 7 x 7 px, residual of the table's plane, semivariance of the
//! latter (0.15, 0.22, 0.34, 0.52 quanta² at 1, 2, 4, 8 px along rows; 1.0 at 64 px), missing depth at borders.

use rayon::prelude::*;

use super::{Measured, continued_depth, displaced, facing, seen_from, window};
use crate::noise;
use crate::random::Field;
use crate::view::View;
use crate::world::World;

const QUANTUM_PER_M: f64 = 1.0 / 348.0;
const PROJECTOR_M: f64 = 0.050;
const INFRARED_M: f64 = -0.025;
const RANGE_M: std::ops::Range<f64> = 0.45..5.0;

const WINDOW_PX: usize = 3;
const SEEN_SHARE: f64 = 0.5;
/// Steps of disparity that the window cannot bridge.
const MIXED_QUANTA: f64 = 12.0;

/// How sure the match is (a normal value) must exceed this plus so much times the share of mixed pixels.
const DOUBT_FROM: f64 = -2.5;
const DOUBT_GROWTH: f64 = 5.0;

const JITTER_PX: f64 = 0.8;
const JITTER_WIDTH_PX: f64 = 2.0;
const NOISE_QUANTA: f64 = 0.74;
const NOISE_WIDTH_PX: f64 = 1.5;
const WARP_QUANTA: f64 = 1.05;
const WARP_CELL_PX: f64 = 70.0;

/// Below this cosine of incidence dropouts begin, below half of it nothing is left.
const GRAZING: f64 = 0.2;
const BLACK: f64 = 0.03;

pub(super) fn measure(world: &World, view: &View) -> Vec<Measured> {
    let (width, height, seed) = (view.width, view.height, world.noise_seed());
    let smooth = |stream, sigma_px| noise::smooth(seed, stream, width, height, sigma_px);
    let glare = smooth(26, JITTER_WIDTH_PX);
    let usable: Vec<bool> =
        (0..width * height).into_par_iter().map(|i| is_usable(world, view, i, glare[i])).collect();
    let (jitter_u, jitter_v) = (smooth(21, JITTER_WIDTH_PX), smooth(22, JITTER_WIDTH_PX));
    let disparity_noise = smooth(23, NOISE_WIDTH_PX);
    let luck = smooth(24, JITTER_WIDTH_PX);
    // The warp is one of the lens: it stays.
    let warp = Field::new(world.seed(), 25);

    let pixel = |i: usize| {
        let (u, v) = (i % width, i / width);
        let shift = (jitter_u[i] * JITTER_PX, jitter_v[i] * JITTER_PX);
        let (su, sv) = displaced(view, (u, v), shift);
        let source = sv * width + su;
        let Some(sight) = view.sights[source].filter(|_| usable[source]) else { return Measured::NONE };
        if !is_matched(view, &usable, (su, sv), source, luck[i]) {
            return Measured::NONE;
        }
        let depth = match view.sights[i] {
            Some(own) if own.surface == sight.surface => own.t,
            _ => continued_depth(world.viewpoint().ray(u as f64, v as f64), &sight),
        };
        let warp = WARP_QUANTA * warp.slow(u as f64, v as f64, WARP_CELL_PX);
        let quanta = 1.0 / (depth * QUANTUM_PER_M) + NOISE_QUANTA * disparity_noise[i] + warp;
        // The raw values are whole numbers, so that the disparities are halves.
        let raw = quanta.floor() + 0.5;
        Measured { depth_m: (1.0 / (raw * QUANTUM_PER_M)) as f32, source }
    };
    (0..width * height).into_par_iter().map(pixel).collect()
}

/// Whether both projector and infrared camera have a good view of what the pixel sees. `glare`, a normal value, decides
/// on what is grazed.
fn is_usable(world: &World, view: &View, i: usize, glare: f64) -> bool {
    let Some(sight) = &view.sights[i] else { return false };
    let steepness = (2.0 - 2.0 * facing(world, sight) / GRAZING).clamp(0.0, 1.0);
    let is_bright = world.albedo(sight).iter().sum::<f64>() / 3.0 > BLACK;
    RANGE_M.contains(&sight.t)
        && (steepness == 0.0 || glare > 6.0 * steepness - 3.0)
        && is_bright
        && seen_from(world, sight, PROJECTOR_M)
        && seen_from(world, sight, INFRARED_M)
}

/// Whether the pattern around a pixel can be found again: enough of the window is seen, and not at two depths.
fn is_matched(view: &View, usable: &[bool], (u, v): (usize, usize), source: usize, luck: f64) -> bool {
    let quanta = |i: usize| view.sights[i].map_or(0.0, |sight| 1.0 / (sight.t * QUANTUM_PER_M));
    let own = quanta(source);
    let (mut all, mut seen, mut mixed) = (0.0, 0.0, 0.0);
    for i in window(view, u, v, WINDOW_PX) {
        all += 1.0;
        if usable[i] {
            seen += 1.0;
            mixed += f64::from(u8::from((quanta(i) - own).abs() > MIXED_QUANTA));
        }
    }
    // Near a border the match is lost by chance, and for several pixels at once.
    let doubt = mixed / all;
    seen >= SEEN_SHARE * all && (doubt == 0.0 || luck > DOUBT_FROM + DOUBT_GROWTH * doubt)
}
