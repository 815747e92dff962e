//! Which window speaks for a pixel: near an edge not the one around it, which mixes two surfaces (METHOD 3.2).

use rayon::prelude::*;

use crate::params;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::plane_fit::PlaneFit;

/// The surface at every pixel.
#[derive(Clone, Debug)]
pub struct Orientation {
    /// Change of disparity along u and v (quanta/px); zero where it is not known.
    pub slope: Raster<[f32; 2]>,
    /// Unit normals towards the camera; zero where there is none.
    pub normal: Raster<[f32; 3]>,
}

/// Weight of how far the pixel lies from a window's plane, against the window's residual.
const MISFIT_WEIGHT: f32 = 0.5;
/// The pixel's own window is preferred to another whose score is this much less.
const OWN_PREFERENCE: f32 = 0.8;

/// The orientation of every pixel from the best of nine windows that contain it (Kuwahara et al. 1976).
///
/// A pixel whose own window has a residual below `own_window_residual_quanta` keeps it; otherwise the window of least
/// residual and misfit wins. Without the choice normals bend round at edges. O(9 pixels).
pub fn orientation(
    disparity: &Raster<f32>,
    fits: &Raster<PlaneFit>,
    space: &DisparitySpace,
    params: &params::LocalFit,
) -> Orientation {
    let width = disparity.width();
    let reach = space.length_px(params.radius_px) as isize - 1;
    let (slope, normal) = (0..disparity.len())
        .into_par_iter()
        .map(|i| {
            let own = &fits[i];
            let chosen = if disparity[i].is_nan() {
                None
            } else if own.residual < params.own_window_residual_quanta {
                Some(i)
            } else {
                best_window(i, disparity, fits, reach)
            };
            let Some(j) = chosen else { return ([0.0; 2], [0.0; 3]) };
            let PlaneFit { value, slope, .. } = fits[j];
            let normal = space.normal(position(j, width), f64::from(value), slope.map(f64::from));
            (slope, normal.as_vec3().to_array())
        })
        .unzip();
    Orientation { slope: disparity.with_data(slope), normal: disparity.with_data(normal) }
}

/// The middle of the window whose plane passes nearest to pixel `i` and fits best; the first one on ties.
fn best_window(i: usize, disparity: &Raster<f32>, fits: &Raster<PlaneFit>, reach: isize) -> Option<usize> {
    let (width, height) = disparity.size();
    let (u, v) = ((i % width) as isize, (i / width) as isize);
    let mut best: Option<(f32, usize)> = None;
    for dv in [-reach, 0, reach] {
        for du in [-reach, 0, reach] {
            let (x, y) = (u + du, v + dv);
            if x < 0 || y < 0 || x >= width as isize || y >= height as isize {
                continue;
            }
            let j = y as usize * width + x as usize;
            let fit = &fits[j];
            if !fit.is_some() {
                continue;
            }
            let at_pixel = fit.value - fit.slope[0] * du as f32 - fit.slope[1] * dv as f32;
            let score = fit.residual + MISFIT_WEIGHT * (at_pixel - disparity[i]).abs();
            let score = if j == i { score * OWN_PREFERENCE } else { score };
            if best.is_none_or(|(least, _)| score < least) {
                best = Some((score, j));
            }
        }
    }
    best.map(|(_, j)| j)
}
