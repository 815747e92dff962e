//! The steps in which a sensor with structured light or stereo resolves disparity.

use crate::quantile::element_at;
use crate::raster::Raster;

/// Rows and columns are sampled at this distance.
const GRID_PX: [usize; 2] = [4, 3];

/// Steps of depth that are less than this many times the smallest may be those of the number's unit.
const COARSE: f64 = 2.5;

/// Depths that differ by a smaller share are equal, except for rounding to 32 bits.
const ROUNDING: f32 = 4.0 * f32::EPSILON;

/// Steps begin to be coarse at this quantile of the coarse ones; nearer ones are strays.
const FIRST: f64 = 0.1;

/// The quartiles of the steps.
const QUARTILES: [f64; 3] = [0.25, 0.5, 0.75];

/// At least this many steps are needed.
const FEWEST: usize = 40;

/// Steps are even if the upper quartile is at most this many times the lower one.
const EVEN: f64 = 1.4;

/// Of the steps beyond where they begin to be coarse, at least this share is coarse too.
const MOST: f64 = 0.8;

/// The even step of inverse depth (1/m) that the depths of an image have; `None` without one. O(m log m) for
/// m sampled pixels.
pub(super) fn disparity_step_per_m(depth_m: &Raster<f32>) -> Option<f64> {
    let rows = depth_m.as_slice().chunks_exact(depth_m.width()).step_by(GRID_PX[0]);
    let mut depths: Vec<f32> = rows.flat_map(|row| row.iter().step_by(GRID_PX[1])).copied().collect();
    depths.retain(|z| !z.is_nan());
    depths.sort_unstable_by(f32::total_cmp);
    depths.dedup_by(|a, b| *a - *b < ROUNDING * *a);
    let steps = || depths.windows(2).map(|pair| [f64::from(pair[0]), f64::from(pair[1])]);
    let unit_m = steps().map(|[near, far]| far - near).fold(f64::INFINITY, f64::min);
    let is_coarse = |[near, far]: &[f64; 2]| far - near > COARSE * unit_m;
    let mut coarse_m: Vec<f64> = steps().filter(is_coarse).map(|[near, _]| near).collect();
    if coarse_m.len() < FEWEST {
        return None;
    }
    let from_m = element_at(&mut coarse_m, FIRST);
    let beyond = || steps().filter(|[near, _]| *near >= from_m);
    let mut sizes: Vec<f64> =
        beyond().filter(is_coarse).map(|[near, far]| near.recip() - far.recip()).collect();
    let all = beyond().count();
    let [low, middle, high] = QUARTILES.map(|share| element_at(&mut sizes, share));
    (sizes.len() as f64 > MOST * all as f64 && high < EVEN * low).then_some(middle)
}
