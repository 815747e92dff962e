//! A plane fitted in disparity to the window around every pixel (docs/CONTEXT.md 0.3).

mod sliding;

use rayon::prelude::*;

use self::sliding::{LEAST_FILL, NO_PLANE, SlidingWindows, TILE};
use crate::buffers::Buffer;
use crate::raster::Raster;
use crate::simd::vectorized;

/// A plane in disparity around one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneFit {
    /// Its value at the pixel (quanta).
    pub value: f32,
    /// Its slope along u and v (quanta/px).
    pub slope: [f32; 2],
    /// Standard deviation of the window's disparities from the plane (quanta); infinite when there is no fit.
    pub residual: f32,
}

impl PlaneFit {
    /// No plane: the pixel has no depth, or its window has too few pixels with depth, or these lie almost in a line.
    pub const NONE: Self =
        Self { value: NO_PLANE[0], slope: [NO_PLANE[1], NO_PLANE[2]], residual: NO_PLANE[3] };

    /// Whether there is a plane.
    #[inline]
    pub fn is_some(&self) -> bool {
        self.residual.is_finite()
    }
}

/// The plane fitted around every pixel. Each number has its own image, so that vector units read and write many at once.
#[derive(Clone, Debug)]
pub struct PlaneFits {
    /// As [`PlaneFit::value`].
    pub value: Raster<f32>,
    /// As [`PlaneFit::slope`]: along u, along v.
    pub slope: [Raster<f32>; 2],
    /// As [`PlaneFit::residual`].
    pub residual: Raster<f32>,
}

impl PlaneFits {
    /// The plane around the pixel with index `i`.
    #[inline]
    pub fn at(&self, i: usize) -> PlaneFit {
        let slope = [self.slope[0][i], self.slope[1][i]];
        PlaneFit { value: self.value[i], slope, residual: self.residual[i] }
    }

    /// Value, slope along u and v, residual.
    #[inline(always)]
    pub(crate) fn images(&self) -> [&Raster<f32>; 4] {
        [&self.value, &self.slope[0], &self.slope[1], &self.residual]
    }
}

/// The largest half size r of a window (px): the sum of x^2 over a larger one, (2 r + 1)^2 r (r + 1) / 3, does not fit 31 bits.
const MOST_RADIUS_PX: usize = 199;

/// Fits the least-squares plane through the disparities (quanta, `NaN` = none) in the square window of half size `radius_px`
/// around every measured pixel. A half size beyond 199 px counts as 199 px.
///
/// The residual estimates the noise, detects edges, and is the relief of the watershed. The fit is in disparity because the noise
/// is constant there; in z the tolerance would have to grow with z^2, and slanted planes would be biased.
///
/// Windows slide down the rows of a tile, many side by side. The part of a row that enters a window is summed pixel by pixel:
/// O(pixels · radius). Differences of running sums along the row would cost O(pixels), but each sum would wait for the one
/// before; at a radius of 3 px that takes twice as long. Extra memory: the sums of one tile for each band of rows.
pub fn fit_planes(disparity: &Raster<f32>, radius_px: usize) -> PlaneFits {
    let (width, height) = disparity.size();
    let side = 2.0 * radius_px as f64 + 1.0;
    let mut fits = NO_PLANE.map(|none| Buffer::stale(disparity.len(), none));
    if LEAST_FILL * side * side > disparity.len() as f64 {
        // The whole image has fewer pixels than the least fill of a window.
        fits.iter_mut().zip(NO_PLANE).for_each(|(image, none)| image.fill(none));
    } else {
        let radius_px = radius_px.min(MOST_RADIUS_PX);
        let mut windows = Buffer::stale(height.div_ceil(TILE), SlidingWindows::default());
        let [values, a, b, residuals] = fits.each_mut().map(|image| image.par_chunks_mut(TILE * width));
        let bands = values.zip(a).zip(b.zip(residuals)).zip(&mut *windows);
        bands.enumerate().for_each(|(band, (((values, a), (b, residuals)), windows))| {
            vectorized(
                #[inline(always)]
                || fit_band(disparity, band * TILE, radius_px, windows, [values, a, b, residuals]),
            );
        });
    }
    let [value, a, b, residual] = fits.map(|image| disparity.with_data(image));
    PlaneFits { value, slope: [a, b], residual }
}

/// Fits the windows of the rows from `top` on, tile by tile.
#[inline(always)]
fn fit_band(
    disparity: &Raster<f32>,
    top: usize,
    radius: usize,
    windows: &mut SlidingWindows,
    mut fits: [&mut [f32]; 4],
) {
    let (width, height) = disparity.size();
    let row = |v: usize| if v < height { &disparity.as_slice()[v * width..][..width] } else { &[] };
    for left in (0..width).step_by(TILE) {
        let tile = left..width.min(left + TILE);
        windows.clear(radius);
        for v in top.saturating_sub(radius)..top + radius {
            windows.slide_down(v, row(v), left);
        }
        for (k, v) in (top..height.min(top + TILE)).enumerate() {
            windows.slide_down(v + radius, row(v + radius), left);
            let place = k * width + tile.start..k * width + tile.end;
            windows.fit(&row(v)[tile.clone()], fits.each_mut().map(|image| &mut image[place.clone()]));
        }
    }
}

#[cfg(test)]
mod tests;
