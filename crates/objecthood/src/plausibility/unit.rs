//! The unit of depth: how far depth cameras reach, and how noise and steps grow with distance.

use super::doubt::Doubt;
use super::sample::Sample;
use super::steps::disparity_step_per_m;
use crate::raster::Raster;

/// "Hardly anything" means this share of the depths.
const FEW: f64 = 0.05;

/// With hardly anything nearer (m) there is nothing to grasp.
const NEAR_M: f64 = 3.5;

/// Hardly anything is farther (m): no depth camera for rooms reaches beyond.
const FAR_M: f64 = 10.0;

/// Most depth cameras see nothing nearer (m).
const NEAREST_M: f64 = 0.2;

/// No sensor has more noise of second differences over depth squared (1/m) than this ..
const MOST_NOISE_PER_M: f64 = 0.009;

/// .. or over depth, where that allows more: time of flight has such noise at half a metre.
const MOST_NOISE_SHARE: f64 = 0.005;

/// No sensor has larger steps of inverse depth (1/m). Kinect v1 and Xtion, the coarsest, have 0.0029.
const COARSEST_STEP_PER_M: f64 = 0.0045;

/// Ratios of usual units: 1, 100, 1000, 5000 and 10000 units a metre.
const RATIOS: [f64; 9] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0, 5000.0, 10_000.0];

/// The most frequent median depth of scenes (m).
const USUAL_M: f64 = 0.85;

/// The usual noise over depth squared (1/m); many sensors have less, few have more.
const USUAL_NOISE_PER_M: f64 = 0.0028;

/// Weight of noise in the choice of the unit, compared with the median depth.
const NOISE_WEIGHT: f64 = 0.5;

/// Whether depths are in another unit.
///
/// A sensor that measures disparity has noise and steps that grow with the square of depth. If depths are
/// taken k times too small, their noise and steps are k times too large for their distance.
pub(super) fn doubt(depth_m: &Raster<f32>, sample: &Sample) -> Option<Doubt> {
    let [near_m, median_m, far_m] = [FEW, 0.5, 1.0 - FEW].map(|share| sample.quantile_m(share));
    let noise_per_m = sample.noise_per_m;
    if near_m > NEAR_M || far_m > FAR_M {
        let times = likely(median_m, noise_per_m, f64::recip);
        return Some(Doubt::TooFar { range_m: [near_m, far_m], times });
    }
    // Steps show as noise too: where there is less, none are that coarse.
    let has_coarse_steps = || {
        noise_per_m > COARSEST_STEP_PER_M
            && disparity_step_per_m(depth_m).is_some_and(|step| step > COARSEST_STEP_PER_M)
    };
    let most_noise_per_m = MOST_NOISE_PER_M.max(MOST_NOISE_SHARE / median_m);
    if median_m < NEAREST_M || noise_per_m > most_noise_per_m || has_coarse_steps() {
        let times = likely(median_m, noise_per_m, |times| times);
        return Some(Doubt::TooNear { median_m, noise_m: noise_per_m * median_m * median_m, times });
    }
    None
}

/// The ratio with which the median depth comes nearest to the usual one while noise is not too high. `factor`
/// converts a ratio to what depths are multiplied by.
fn likely(median_m: f64, noise_per_m: f64, factor: impl Fn(f64) -> f64) -> f64 {
    let miss = |times: &f64| {
        let factor = factor(*times);
        let depth = libm::log(median_m * factor / USUAL_M);
        let noise = libm::log((noise_per_m / factor / USUAL_NOISE_PER_M).max(1.0));
        depth * depth + NOISE_WEIGHT * noise * noise
    };
    RATIOS.into_iter().min_by(|a, b| miss(a).total_cmp(&miss(b))).unwrap_or(1.0)
}
