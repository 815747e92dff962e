//! Depths that no sensor measures, and disparity instead of depth.

use super::doubt::Doubt;
use super::sample::{Sample, whole};
use crate::raster::Raster;

/// The depth of a scene jumps between fewer than this share of the neighbours.
const MOST_JUMPS: f64 = 0.2;

/// In images with scrambled rows, jumps within rows are fewer than across them by this factor.
const ALONG_ROWS: f64 = 0.4;

/// With the bytes the right way round, neighbours differ less by at least this factor.
const SMOOTHER: f64 = 4.0;

/// A greatest depth that at least this share of the pixels has may stand for "none" ..
const SATURATED: f64 = 0.03;

/// .. if all others are nearer than this share of it.
const BEHIND: f32 = 0.9;

/// Without noise the greatest depth may be a floor seen straight from above, with things on it up to half as
/// high as the camera. Then the others are nearer than this share of it.
const FAR_BEHIND: f32 = 0.5;

/// No sensor has less noise over depth squared (1/m) than this.
const NOISELESS_PER_M: f64 = 1e-4;

/// A surface is measured at three places, apart by this share of the width.
const BASELINE: f64 = 1.0 / 12.0;

/// The ratio of the depths at the outer places lies between these; otherwise the surface hardly slopes, or
/// the places lie on no one surface.
const SLOPES: std::ops::Range<f64> = 1.05..1.65;

/// A place is decided if the better model misses by less than this share of the difference of the two models.
const TELLS: f64 = 0.25;

/// At least this many places have to be decided.
const FEWEST_PLACES: usize = 100;

/// In disparity, surfaces are flat in the numbers themselves at more than this share of the places.
const MOST_EVEN: f64 = 0.65;

/// Whether neighbouring depths fit each other, and the greatest is a real depth.
pub(super) fn doubt(depth_m: &Raster<f32>, sample: &Sample) -> Option<Doubt> {
    let depths = &sample.depths_m;
    let [along, across] = sample.jumps;
    if let Some(ratio) = sample.is_fine.then(|| smoother_swapped(depth_m, sample)).flatten() {
        return Some(Doubt::BytesSwapped { ratio });
    }
    if along > MOST_JUMPS {
        return Some(Doubt::DepthScrambled { share: along });
    }
    if across > MOST_JUMPS && along < ALONG_ROWS * across {
        return Some(Doubt::RowsScrambled { share: across });
    }
    let greatest = *depths.last()?;
    let others = depths.partition_point(|&z| z < greatest);
    let share = (depths.len() - others) as f64 / depths.len() as f64;
    // A floor seen straight from above is at one depth where there is no noise.
    let is_noiseless = sample.is_fine && sample.noise_per_m < NOISELESS_PER_M;
    let behind = if is_noiseless { FAR_BEHIND } else { BEHIND };
    let is_apart = others > 0 && depths[others - 1] < behind * greatest;
    (share > SATURATED && is_apart).then_some(Doubt::DepthSaturated { depth_m: f64::from(greatest), share })
}

/// How much less neighbours differ with the two bytes of each number exchanged. `None` if hardly less, or if
/// depths are no whole numbers of a usual unit.
fn smoother_swapped(depth_m: &Raster<f32>, sample: &Sample) -> Option<f64> {
    let per_m = sample.units_per_m?;
    let depths = depth_m.as_slice();
    let (mut plain, mut swapped) = (0_u64, 0_u64);
    for row in depths.chunks_exact(depth_m.width()).step_by(sample.grid_px) {
        for pair in row.windows(2).step_by(sample.grid_px) {
            if let (Some(a), Some(b)) = (whole(pair[0], per_m), whole(pair[1], per_m)) {
                plain += u64::from(a.abs_diff(b));
                swapped += u64::from(a.swap_bytes().abs_diff(b.swap_bytes()));
            }
        }
    }
    let ratio = plain as f64 / swapped.max(1) as f64;
    (ratio > SMOOTHER).then_some(ratio)
}

/// Whether surfaces are flat in depth instead of in its inverse.
///
/// Along a line of the image a plane has depth 1/(a + b u): its inverse is affine and it is not. At three places at equal distances,
/// the middle one is the harmonic mean of the outer ones in depth, and the arithmetic mean in disparity.
pub(super) fn disparity_doubt(depth_m: &Raster<f32>, sample: &Sample) -> Option<Doubt> {
    let (width, height) = depth_m.size();
    let depths = depth_m.as_slice();
    let baseline = ((width as f64 * BASELINE) as usize).max(2);
    let grid_px = sample.grid_px;
    let (mut even, mut places) = (0_usize, 0_usize);
    // The grid is slanted. In an image enlarged by repeating its pixels, a straight grid would meet every
    // pixel at the same place, and read the same bend everywhere.
    for (row, down) in (baseline..height.saturating_sub(baseline + grid_px)).step_by(grid_px).enumerate() {
        for (column, across) in
            (baseline..width.saturating_sub(baseline + grid_px)).step_by(grid_px).enumerate()
        {
            let (u, v) = (across + row % grid_px, down + column % grid_px);
            let i = v * width + u;
            for step in [1, width] {
                let at = |shift: usize| f64::from(depths[i + shift * step - baseline * step]);
                if let Some(is_even) = is_even_in_depth([at(0), at(baseline), at(2 * baseline)]) {
                    places += 1;
                    even += usize::from(is_even);
                }
            }
        }
    }
    let share = even as f64 / places.max(1) as f64;
    (places >= FEWEST_PLACES && share > MOST_EVEN).then_some(Doubt::DisparityAsDepth { share })
}

/// Whether the arithmetic mean of the outer depths is nearer to the middle one than the harmonic mean; `None`
/// if the two cannot be distinguished.
fn is_even_in_depth([before, middle, after]: [f64; 3]) -> Option<bool> {
    if !SLOPES.contains(&(before / after).max(after / before)) {
        return None;
    }
    let arithmetic = (before + after) / 2.0;
    let harmonic = before * after / arithmetic;
    let apart = arithmetic - harmonic;
    let [in_depth, in_disparity] = [arithmetic, harmonic].map(|mean| (middle - mean).abs());
    (in_depth.min(in_disparity) < TELLS * apart).then_some(in_depth < in_disparity)
}
