//! A plane fitted in disparity to the window around every pixel (METHOD 3.1).

use rayon::prelude::*;

use crate::raster::Raster;

/// A plane in disparity around one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneFit {
    /// Its value at the pixel (quanta).
    pub value: f32,
    /// Its change along u and v (quanta/px).
    pub slope: [f32; 2],
    /// Standard deviation of the window's disparities from it (quanta); infinite when there is no fit.
    pub residual: f32,
}

impl PlaneFit {
    /// What a pixel has that is not measured or whose window is too empty.
    pub const NONE: Self = Self { value: 0.0, slope: [0.0; 2], residual: f32::INFINITY };

    /// Whether there is a plane.
    #[inline]
    pub fn is_some(&self) -> bool {
        self.residual.is_finite()
    }
}

/// A window with a smaller share of measured pixels has no fit.
const LEAST_FILL: f64 = 0.4;
/// Nor has one whose pixels lie in a line: determinant of their second moments (px^4).
const LEAST_SPREAD: f64 = 1e-3;
/// Rows that are summed up together. Fixed, so that rounding does not depend on the number of threads.
const BAND: usize = 64;

/// 1, u, v, uu, uv, vv, d, du, dv, dd.
type Sums = [f64; 10];

/// Least-squares plane through the disparities (quanta, `NaN` = none) in the square window of half size `radius_px`
/// around every measured pixel.
///
/// The residual is noise estimate, edge detector and watershed relief at once. In disparity and not in z, where the
/// tolerance of the same fit would have to grow with z^2 and slanted planes would be biased. Sliding sums, first down
/// the columns, then along the rows: O(pixels), whatever the radius.
pub fn plane_fits(disparity: &Raster<f32>, radius_px: usize) -> Raster<PlaneFit> {
    let (width, height) = disparity.size();
    let mut fits = vec![PlaneFit::NONE; disparity.len()];
    fits.par_chunks_mut(BAND * width).enumerate().for_each(|(band, fits)| {
        let first = band * BAND;
        let mut columns = vec![[0.0; 10]; width];
        for v in first.saturating_sub(radius_px)..(first + radius_px).min(height) {
            slide_down(&mut columns, disparity, v, 1.0);
        }
        for (row, fits) in fits.chunks_mut(width).enumerate() {
            let v = first + row;
            if v + radius_px < height {
                slide_down(&mut columns, disparity, v + radius_px, 1.0);
            }
            fit_row(&columns, disparity, v, radius_px, fits);
            if v >= radius_px {
                slide_down(&mut columns, disparity, v - radius_px, -1.0);
            }
        }
    });
    disparity.with_data(fits)
}

/// Adds row `v` to the sums of the columns (sign 1), or takes it away (sign -1).
fn slide_down(columns: &mut [Sums], disparity: &Raster<f32>, v: usize, sign: f64) {
    let (width, height) = disparity.size();
    let row = &disparity.as_slice()[v * width..][..width];
    // From the middle of the image, to keep the sums small.
    let y = v as f64 - (height / 2) as f64;
    for (u, (sums, &d)) in columns.iter_mut().zip(row).enumerate() {
        if d.is_nan() {
            continue;
        }
        let (x, d) = (u as f64 - (width / 2) as f64, f64::from(d));
        let terms = [1.0, x, y, x * x, x * y, y * y, d, d * x, d * y, d * d];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += sign * term);
    }
}

/// Fits the windows of row `v`, the sums of whose columns are given.
fn fit_row(columns: &[Sums], disparity: &Raster<f32>, v: usize, radius: usize, fits: &mut [PlaneFit]) {
    let (width, height) = disparity.size();
    let y = v as f64 - (height / 2) as f64;
    let side = 2 * radius + 1;
    let least = LEAST_FILL * (side * side) as f64;
    let mut window = [0.0; 10];
    let mut slide = |column: &Sums, sign: f64| {
        window.iter_mut().zip(column).for_each(|(sum, term)| *sum += sign * term);
        window
    };
    for column in &columns[..radius.min(width)] {
        slide(column, 1.0);
    }
    for (u, fit) in fits.iter_mut().enumerate() {
        let entering = columns.get(u + radius).unwrap_or(&[0.0; 10]);
        let sums = slide(entering, 1.0);
        if !disparity[v * width + u].is_nan() && sums[0] >= least {
            *fit = plane(&sums, u as f64 - (width / 2) as f64, y);
        }
        if u >= radius {
            slide(&columns[u - radius], -1.0);
        }
    }
}

/// The least-squares plane of a window with these sums, at the pixel (x, y).
fn plane(&[n, x_sum, y_sum, xx, xy, yy, d, dx, dy, dd]: &Sums, x: f64, y: f64) -> PlaneFit {
    let (mx, my, md) = (x_sum / n, y_sum / n, d / n);
    let (xx, xy, yy) = (xx / n - mx * mx, xy / n - mx * my, yy / n - my * my);
    let (dx, dy, dd) = (dx / n - md * mx, dy / n - md * my, dd / n - md * md);
    let spread = xx * yy - xy * xy;
    if spread < LEAST_SPREAD || n <= 3.0 {
        return PlaneFit::NONE;
    }
    let a = (dx * yy - dy * xy) / spread;
    let b = (dy * xx - dx * xy) / spread;
    let variance = (dd - a * dx - b * dy).max(0.0) * n / (n - 3.0);
    PlaneFit {
        value: (md + a * (x - mx) + b * (y - my)) as f32,
        slope: [a as f32, b as f32],
        residual: variance.sqrt() as f32,
    }
}
