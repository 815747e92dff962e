//! A plane fitted in disparity to the window around every pixel (METHOD 3.1).

use rayon::prelude::*;

use crate::raster::Raster;
use crate::simd::vectorized;
use crate::workspace::Workspace;

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

/// Windows that are fitted side by side.
const LANES: usize = 16;
/// One value for each of them.
type Lanes = [f64; LANES];
/// Sums over what of a row lies in the windows: 1, x, xx, d, dx, dd.
type RowSums = [Lanes; 6];

/// Least-squares plane through the disparities (quanta, `NaN` = none) in the square window of half size `radius_px`
/// around every measured pixel.
///
/// The residual is noise estimate, edge detector and watershed relief at once. In disparity and not in z, where the
/// tolerance of the same fit would have to grow with z^2 and slanted planes would be biased. Sums over parts of rows are
/// differences of sums from the row's start; those over windows slide down the rows: O(pixels · (1 + radius / 32)),
/// because each band of 64 rows starts anew. Memory beside the result: 2 radius + 1 rows of such sums a thread.
pub fn plane_fits(disparity: &Raster<f32>, radius_px: usize, workspace: &mut Workspace) -> Raster<PlaneFit> {
    let (width, height) = disparity.size();
    let mut fits = workspace.stale(disparity.len(), PlaneFit::NONE);
    workspace.windows.resize_with(height.div_ceil(BAND), Windows::default);
    let bands = fits.par_chunks_mut(BAND * width).zip(&mut workspace.windows);
    bands.enumerate().for_each(|(band, (fits, windows))| {
        vectorized(
            #[inline(always)]
            || fit_band(disparity, band * BAND, radius_px, windows, fits),
        );
    });
    disparity.with_data(fits)
}

/// Fits the windows of the rows from `first` on.
#[inline(always)]
fn fit_band(
    disparity: &Raster<f32>,
    first: usize,
    radius: usize,
    windows: &mut Windows,
    fits: &mut [PlaneFit],
) {
    let width = disparity.width();
    windows.clear(disparity.size(), radius);
    let row = |v: usize| disparity.as_slice().get(v * width..(v + 1) * width);
    for v in first.saturating_sub(radius)..first + radius {
        windows.slide_down(v, row(v));
    }
    for (v, fits) in (first..).zip(fits.chunks_mut(width)) {
        windows.slide_down(v + radius, row(v + radius));
        let measured = row(v).unwrap_or_default();
        windows.fit(v, measured, fits);
    }
}

/// The sums over the windows around the pixels of one row, in blocks.
#[derive(Debug, Default)]
pub(crate) struct Windows {
    radius: usize,
    /// Whence x and y are counted, to keep the sums small (px).
    middle: [f64; 2],
    /// 1, x, y, xx, xy, yy, d, dx, dy, dd.
    sums: Vec<[Lanes; 10]>,
    /// What the last 2 radius + 1 rows gave, one after the other.
    rows: Vec<Vec<RowSums>>,
    /// Of a row: what is left of the window, from the first that is not outside on.
    before: [Vec<f64>; 6],
}

impl Windows {
    /// Makes them empty, of an image of this size.
    fn clear(&mut self, (width, height): (usize, usize), radius: usize) {
        let blocks = width.div_ceil(LANES);
        self.radius = radius;
        self.middle = [width, height].map(|side| (side / 2) as f64);
        refill(&mut self.sums, blocks, [[0.0; LANES]; 10]);
        self.rows.resize_with(2 * radius + 1, Vec::new);
        self.rows.iter_mut().for_each(|row| refill(row, blocks, [[0.0; LANES]; 6]));
        self.before.iter_mut().for_each(|before| refill(before, blocks * LANES + 2 * radius + 1, 0.0));
    }

    /// Moves the windows so far down that row `v`, `None` below the image, is their last.
    #[inline(always)]
    fn slide_down(&mut self, v: usize, row: Option<&[f32]>) {
        let side = 2 * self.radius + 1;
        self.sum_along(row.unwrap_or_default());
        let entering_y = v as f64 - self.middle[1];
        let leaving_y = entering_y - side as f64;
        let rows = self.sums.iter_mut().zip(&mut self.rows[v % side]);
        for (b, (sums, [n, x, xx, d, dx, dd])) in rows.enumerate() {
            let [ns, xs, ys, xxs, xys, yys, ds, dxs, dys, dds] = sums;
            let entering = self.before.each_ref().map(|before| {
                let part: &[f64; LANES] = before[b * LANES..][..LANES].try_into().expect("so long");
                let next: &[f64; LANES] = before[b * LANES + side..][..LANES].try_into().expect("so long");
                (part, next)
            });
            for lane in 0..LANES {
                let part = |k: usize| entering[k].1[lane] - entering[k].0[lane];
                let [n_in, x_in, xx_in] = [part(0), part(1), part(2)];
                let [d_in, dx_in, dd_in] = [part(3), part(4), part(5)];
                let [y_in, y_out] = [entering_y, leaving_y];
                ns[lane] += n_in - n[lane];
                xs[lane] += x_in - x[lane];
                ys[lane] += n_in * y_in - n[lane] * y_out;
                xxs[lane] += xx_in - xx[lane];
                xys[lane] += x_in * y_in - x[lane] * y_out;
                yys[lane] += n_in * (y_in * y_in) - n[lane] * (y_out * y_out);
                ds[lane] += d_in - d[lane];
                dxs[lane] += dx_in - dx[lane];
                dys[lane] += d_in * y_in - d[lane] * y_out;
                dds[lane] += dd_in - dd[lane];
                [n[lane], x[lane], xx[lane]] = [n_in, x_in, xx_in];
                [d[lane], dx[lane], dd[lane]] = [d_in, dx_in, dd_in];
            }
        }
    }

    /// Sums up a row from its start on.
    #[inline(always)]
    fn sum_along(&mut self, row: &[f32]) {
        let first = self.radius + 1;
        let mut sums = [0.0; 6];
        let [n, x, xx, d, dx, dd] = self.before.each_mut().map(|before| &mut before[first..][..row.len()]);
        for (u, &disparity) in row.iter().enumerate() {
            if !disparity.is_nan() {
                let (at, disparity) = (u as f64 - self.middle[0], f64::from(disparity));
                let terms = [1.0, at, at * at, disparity, disparity * at, disparity * disparity];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            [n[u], x[u], xx[u], d[u], dx[u], dd[u]] = sums;
        }
        for (before, sum) in self.before.iter_mut().zip(sums) {
            before[first + row.len()..].fill(sum);
        }
    }

    /// Fits the windows around the measured pixels of row `v`.
    #[inline(always)]
    fn fit(&self, v: usize, measured: &[f32], fits: &mut [PlaneFit]) {
        let side = (2 * self.radius + 1) as f64;
        let y = v as f64 - self.middle[1];
        let blocks = self.sums.iter().zip(measured.chunks(LANES).zip(fits.chunks_mut(LANES)));
        for (b, (sums, (measured, fits))) in blocks.enumerate() {
            fits.fill(PlaneFit::NONE);
            if measured.iter().all(|d| d.is_nan()) {
                continue;
            }
            let x = (b * LANES) as f64 - self.middle[0];
            let [value, a, b, residual] = planes(sums, x, y, LEAST_FILL * side * side);
            for (lane, (fit, d)) in fits.iter_mut().zip(measured).enumerate() {
                if !d.is_nan() {
                    *fit =
                        PlaneFit { value: value[lane], slope: [a[lane], b[lane]], residual: residual[lane] };
                }
            }
        }
    }
}

/// Makes `list` hold `len` times `value`.
fn refill<T: Copy>(list: &mut Vec<T>, len: usize, value: T) {
    list.clear();
    list.resize(len, value);
}

/// The least-squares planes of windows with these sums and at least so many pixels, at the pixels from (x, y) on: value,
/// slope along u and v, residual.
#[inline(always)]
fn planes(sums: &[Lanes; 10], x: f64, y: f64, least: f64) -> [[f32; LANES]; 4] {
    let mut planes = [[0.0; LANES]; 4];
    for lane in 0..LANES {
        let [n, x_sum, y_sum, xx, xy, yy, d, dx, dy, dd] = sums.each_ref().map(|sums| sums[lane]);
        let (x, share) = (x + lane as f64, 1.0 / n);
        let (mx, my, md) = (x_sum * share, y_sum * share, d * share);
        let (xx, xy, yy) = (xx * share - mx * mx, xy * share - mx * my, yy * share - my * my);
        let (dx, dy, dd) = (dx * share - md * mx, dy * share - md * my, dd * share - md * md);
        let spread = xx * yy - xy * xy;
        let a = (dx * yy - dy * xy) / spread;
        let b = (dy * xx - dx * xy) / spread;
        let variance = (dd - a * dx - b * dy).max(0.0) * n / (n - 3.0);
        let is_fit = (n >= least) & (spread >= LEAST_SPREAD) & (n > 3.0);
        let or = |some: f64, none: f32| if is_fit { some as f32 } else { none };
        planes[0][lane] = or(md + a * (x - mx) + b * (y - my), PlaneFit::NONE.value);
        planes[1][lane] = or(a, PlaneFit::NONE.slope[0]);
        planes[2][lane] = or(b, PlaneFit::NONE.slope[1]);
        planes[3][lane] = or(variance.sqrt(), PlaneFit::NONE.residual);
    }
    planes
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{raster, small_size};

    /// The plane in the window around pixel `i`, from its pixels.
    fn naive(disparity: &Raster<f32>, i: usize, radius: usize) -> PlaneFit {
        let width = disparity.width();
        let (u, v) = (i % width, i / width);
        let window: Vec<[f64; 3]> = (0..disparity.len())
            .filter(|&j| (j % width).abs_diff(u) <= radius && (j / width).abs_diff(v) <= radius)
            .filter(|&j| !disparity[j].is_nan())
            .map(|j| [(j % width) as f64 - u as f64, (j / width) as f64 - v as f64, f64::from(disparity[j])])
            .collect();
        let n = window.len() as f64;
        if disparity[i].is_nan() || n < 0.4 * ((2 * radius + 1) * (2 * radius + 1)) as f64 {
            return PlaneFit::NONE;
        }
        let mean = [0, 1, 2].map(|k| window.iter().map(|p| p[k]).sum::<f64>() / n);
        let moment =
            |j: usize, k: usize| window.iter().map(|p| (p[j] - mean[j]) * (p[k] - mean[k])).sum::<f64>();
        // Cramer's rule.
        let spread = moment(0, 0) * moment(1, 1) - moment(0, 1) * moment(0, 1);
        let slope = [
            (moment(0, 2) * moment(1, 1) - moment(1, 2) * moment(0, 1)) / spread,
            (moment(1, 2) * moment(0, 0) - moment(0, 2) * moment(0, 1)) / spread,
        ];
        let at = |p: &[f64; 3]| mean[2] + slope[0] * (p[0] - mean[0]) + slope[1] * (p[1] - mean[1]);
        let squared: f64 = window.iter().map(|p| (p[2] - at(p)).powi(2)).sum();
        PlaneFit {
            value: at(&[0.0; 3]) as f32,
            slope: slope.map(|s| s as f32),
            residual: (squared / (n - 3.0)).sqrt() as f32,
        }
    }

    /// Narrow and low images, and such as are higher than a band of rows.
    fn size() -> impl Strategy<Value = (usize, usize)> {
        prop_oneof![3 => small_size(), 1 => (4_usize..9, BAND - 4..2 * BAND + 9)]
    }

    proptest! {
        #[test]
        fn sliding_sums_give_the_planes_of_single_windows(
            disparity in size().prop_flat_map(|size| {
                raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
            }),
            radius in 1_usize..=5,
        ) {
            let fits = plane_fits(&disparity, radius, &mut Workspace::default());
            for i in 0..disparity.len() {
                let (got, expected) = (fits[i], naive(&disparity, i, radius));
                prop_assert_eq!(got.is_some(), expected.is_some(), "{}", i);
                if expected.is_some() {
                    let off = [
                        got.value - expected.value,
                        got.slope[0] - expected.slope[0],
                        got.slope[1] - expected.slope[1],
                        got.residual - expected.residual,
                    ];
                    prop_assert!(off.iter().all(|off| off.abs() < 2e-3), "{}: {:?} {:?}", i, got, expected);
                }
            }
        }
    }

    proptest! {
        /// Whatever the machine has, and in bands of their own.
        #[test]
        fn vector_units_give_the_same_bits(
            disparity in (1_usize..40, 1_usize..90).prop_flat_map(|size| {
                raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
            }),
            radius in 1_usize..=5,
        ) {
            let mut scalar = vec![PlaneFit::NONE; disparity.len()];
            for (band, fits) in scalar.chunks_mut(BAND * disparity.width()).enumerate() {
                fit_band(&disparity, band * BAND, radius, &mut Windows::default(), fits);
            }
            prop_assert_eq!(plane_fits(&disparity, radius, &mut Workspace::default()).into_vec(), scalar);
        }
    }

    #[test]
    fn a_plane_is_its_own_fit() {
        let plane = |i: usize| 250.0 + 0.5 * (i % 20) as f32 - 0.25 * (i / 20) as f32;
        let disparity = Raster::from_vec(20, 16, (0..320).map(plane).collect()).unwrap();
        for (i, fit) in plane_fits(&disparity, 3, &mut Workspace::default()).as_slice().iter().enumerate() {
            // In a corner a window has 16 of its 49 pixels.
            let near_corner = [i % 20, 19 - i % 20].iter().min() == Some(&0)
                && [i / 20, 15 - i / 20].iter().min() == Some(&0);
            assert_eq!(fit.is_some(), !near_corner, "{i}");
            if fit.is_some() {
                assert!((fit.value - plane(i)).abs() < 1e-4 && fit.residual < 1e-4, "{i}: {fit:?}");
                assert!((fit.slope[0] - 0.5).abs() < 1e-5 && (fit.slope[1] + 0.25).abs() < 1e-5, "{i}");
            }
        }
    }
}
