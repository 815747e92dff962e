//! A plane fitted in disparity to the window around every pixel (docs/CONTEXT.md 0.3).

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::raster::Raster;
use crate::simd::vectorized;

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

/// The plane around every pixel; each of its numbers in an image of its own, so that many are read and written at once.
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

/// A window with a smaller share of measured pixels has no fit.
const LEAST_FILL: f64 = 0.4;
/// Nor has one whose pixels lie in a line: determinant of their second moments (px^4).
const LEAST_SPREAD: f64 = 1e-3;

/// Windows have at most this half size r (px): of a larger one the sum of the squares of whole numbers, (2 r + 1)^2 r (r + 1) / 3, does
/// not fit 31 bits.
const MOST_RADIUS_PX: usize = 199;

/// Width and height of the tiles that are fitted one by one: what their sums need stays in the first cache. Fixed, so
/// that rounding does not depend on the number of threads.
const TILE: usize = 64;
/// Windows that are fitted side by side.
const LANES: usize = 16;
/// Of each of them a sum of disparities times whole numbers ...
type Sum = [f64; LANES];
/// ... or of whole numbers alone.
type Count = [i32; LANES];

/// Least-squares plane through the disparities (quanta, `NaN` = none) in the square window of half size `radius_px`
/// around every measured pixel; from 199 px on they grow no more.
///
/// The residual is noise estimate, edge detector and watershed relief at once. In disparity and not in z, where the
/// tolerance of the same fit would have to grow with z^2 and slanted planes would be biased. Sums over the parts of rows
/// that lie in windows are taken term by term, for many windows side by side; those over windows slide down the rows.
/// O(pixels · radius); differences of sums from the row's start would not depend on the radius, but each of those waits
/// for the one before, and at a radius of 3 px that takes twice as long. Memory beside the result: for a tile only.
pub fn plane_fits(disparity: &Raster<f32>, radius_px: usize) -> PlaneFits {
    let (width, height) = disparity.size();
    let side = 2.0 * radius_px as f64 + 1.0;
    let PlaneFit { value, slope: [a, b], residual } = PlaneFit::NONE;
    let none = [value, a, b, residual];
    let mut fits = none.map(|none| Buffer::stale(disparity.len(), none));
    if LEAST_FILL * side * side > disparity.len() as f64 {
        // Not even the whole image would fill a window.
        fits.iter_mut().zip(none).for_each(|(image, none)| image.fill(none));
    } else {
        let radius_px = radius_px.min(MOST_RADIUS_PX);
        let mut windows = Buffer::stale(height.div_ceil(TILE), Windows::default());
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
    windows: &mut Windows,
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

/// The sums over the windows around the pixels of one row of a tile.
///
/// Counts are whole numbers. The others but dd are exact, in any order, at radii up to 80 px: disparities of a frame, a factor of
/// 200 apart at most, are whole multiples below 2^32 of one number, and no sum is 2^21 times as large.
#[derive(Clone, Debug, Default)]
struct Windows {
    radius: usize,
    /// In blocks, with x and y counted from the window's own middle.
    sums: [Sums; TILE / LANES],
    /// What each of the last 2 radius + 1 rows gave to them.
    rows: Vec<[RowSums; TILE / LANES]>,
    /// The row that enters, from where the first window starts to where the last one ends: 1 and disparity where it is
    /// measured, else 0.
    measured: Vec<i32>,
    disparity: Vec<f64>,
}

/// Sums over windows.
#[derive(Clone, Debug, Default)]
struct Sums {
    /// 1, x, y, xx, xy, yy.
    counts: [Count; 6],
    /// d, dx, dy, dd.
    disparities: [Sum; 4],
}

/// Sums over what of a row lies in windows.
#[derive(Clone, Copy, Debug, Default)]
struct RowSums {
    /// 1, x, xx.
    counts: [Count; 3],
    /// d, dx, dd.
    disparities: [Sum; 3],
}

impl Windows {
    /// Makes them empty.
    #[inline(always)]
    fn clear(&mut self, radius: usize) {
        self.radius = radius;
        self.sums = Default::default();
        self.rows.clear();
        self.rows.resize(2 * radius + 1, Default::default());
        self.measured.resize(TILE + 2 * radius, 0);
        self.disparity.resize(TILE + 2 * radius, 0.0);
    }

    /// Moves the windows so far down that row `v`, empty below the image, is their last.
    #[inline(always)]
    fn slide_down(&mut self, v: usize, row: &[f32], left: usize) {
        self.read(row, left);
        let side = 2 * self.radius + 1;
        for (b, (sums, last)) in self.sums.iter_mut().zip(&mut self.rows[v % side]).enumerate() {
            let part = b * LANES..b * LANES + LANES - 1 + side;
            let entering = RowSums::of(&self.measured[part.clone()], &self.disparity[part], self.radius);
            sums.slide_down(last, &entering, self.radius);
            *last = entering;
        }
    }

    /// Takes in what of a row lies in windows of the tile; nothing is measured beside the image.
    #[inline(always)]
    fn read(&mut self, row: &[f32], left: usize) {
        let first = left.saturating_sub(self.radius).min(row.len());
        let row = &row[first..row.len().min(left + TILE + self.radius)];
        let inside = (first + self.radius).saturating_sub(left)..;
        self.measured.fill(0);
        self.disparity.fill(0.0);
        let read = self.measured[inside.clone()].iter_mut().zip(&mut self.disparity[inside]);
        for ((measured, disparity), d) in read.zip(row) {
            (*measured, *disparity) = if d.is_nan() { (0, 0.0) } else { (1, f64::from(*d)) };
        }
    }

    /// Fits the windows around the measured pixels of a row of the tile.
    #[inline(always)]
    fn fit(&self, disparity: &[f32], mut fits: [&mut [f32]; 4]) {
        let side = (2 * self.radius + 1) as f64;
        let PlaneFit { value, slope: [a, b], residual } = PlaneFit::NONE;
        for (block, (sums, disparity)) in self.sums.iter().zip(disparity.chunks(LANES)).enumerate() {
            let planes = sums.planes(LEAST_FILL * side * side);
            for ((image, plane), none) in fits.iter_mut().zip(&planes).zip([value, a, b, residual]) {
                let image = &mut image[block * LANES..];
                for ((fit, plane), d) in image.iter_mut().zip(plane).zip(disparity) {
                    *fit = if d.is_nan() { none } else { *plane };
                }
            }
        }
    }
}

impl RowSums {
    /// Of parts of a row that start one pixel after the other.
    ///
    /// From the last pixel to the first, sums of the sums are the moments about the pixel before the first.
    #[inline(always)]
    fn of(measured: &[i32], disparity: &[f64], radius: usize) -> Self {
        let mut row = Self::default();
        let Self { counts: [n, x, xx], disparities: [d, dx, dd] } = &mut row;
        for (measured, disparity) in measured.windows(LANES).zip(disparity.windows(LANES)).rev() {
            for lane in 0..LANES {
                n[lane] += measured[lane];
                x[lane] += n[lane];
                xx[lane] += x[lane];
            }
            for lane in 0..LANES {
                d[lane] += disparity[lane];
                dx[lane] += d[lane];
                dd[lane] += disparity[lane] * disparity[lane];
            }
        }
        let middle = radius as i32 + 1;
        for lane in 0..LANES {
            // So far a pixel at x counts x (x + 1) / 2.
            xx[lane] = 2 * xx[lane] - (2 * middle + 1) * x[lane] + middle * middle * n[lane];
            x[lane] -= middle * n[lane];
            dx[lane] -= f64::from(middle) * d[lane];
        }
        row
    }
}

impl Sums {
    /// Moves the windows down by one row.
    #[inline(always)]
    fn slide_down(&mut self, leaving: &RowSums, entering: &RowSums, radius: usize) {
        let [ns, xs, ys, xxs, xys, yys] = &mut self.counts;
        let [[n, x, xx], [n_in, x_in, xx_in]] = [&leaving.counts, &entering.counts];
        let (y, y_in) = (-(radius as i32) - 1, radius as i32);
        for lane in 0..LANES {
            // All that was in the windows is one row higher now.
            yys[lane] += ns[lane] - 2 * ys[lane] + n_in[lane] * (y_in * y_in) - n[lane] * (y * y);
            ys[lane] += n_in[lane] * y_in - n[lane] * y - ns[lane];
            xys[lane] += x_in[lane] * y_in - x[lane] * y - xs[lane];
            ns[lane] += n_in[lane] - n[lane];
            xs[lane] += x_in[lane] - x[lane];
            xxs[lane] += xx_in[lane] - xx[lane];
        }
        let [ds, dxs, dys, dds] = &mut self.disparities;
        let [[d, dx, dd], [d_in, dx_in, dd_in]] = [&leaving.disparities, &entering.disparities];
        let (y, y_in) = (f64::from(y), f64::from(y_in));
        for lane in 0..LANES {
            dys[lane] += d_in[lane] * y_in - d[lane] * y - ds[lane];
            ds[lane] += d_in[lane] - d[lane];
            dxs[lane] += dx_in[lane] - dx[lane];
            dds[lane] += dd_in[lane] - dd[lane];
        }
    }

    /// The least-squares planes of the windows with at least so many pixels: value in the middle, slope along u and v,
    /// residual.
    ///
    /// With n times the moments about the mean, so that one division serves all.
    #[inline(always)]
    fn planes(&self, least: f64) -> [[f32; LANES]; 4] {
        let mut planes = [[0.0; LANES]; 4];
        let [ns, xs, ys, xxs, xys, yys] = &self.counts;
        let [ds, dxs, dys, dds] = &self.disparities;
        for lane in 0..LANES {
            let [n, x, y] = [ns[lane], xs[lane], ys[lane]].map(f64::from);
            let [xx, xy, yy] = [xxs[lane], xys[lane], yys[lane]].map(f64::from);
            let [d, dx, dy, dd] = [ds[lane], dxs[lane], dys[lane], dds[lane]];
            let [xx, xy, yy] = [n * xx - x * x, n * xy - x * y, n * yy - y * y];
            let [dx, dy, dd] = [n * dx - d * x, n * dy - d * y, n * dd - d * d];
            let spread = xx * yy - xy * xy;
            let freedom = n * (n - 3.0);
            let inverse = 1.0 / (spread * freedom);
            let a = (dx * yy - dy * xy) * (freedom * inverse);
            let b = (dy * xx - dx * xy) * (freedom * inverse);
            let value = (d - a * x - b * y) * (spread * (n - 3.0) * inverse);
            let variance = (dd - a * dx - b * dy).max(0.0) * (spread * inverse);
            let is_fit = (n >= least) & (spread >= LEAST_SPREAD * (n * n) * (n * n)) & (n > 3.0);
            let or = |some: f64, none: f32| if is_fit { some as f32 } else { none };
            planes[0][lane] = or(value, PlaneFit::NONE.value);
            planes[1][lane] = or(a, PlaneFit::NONE.slope[0]);
            planes[2][lane] = or(b, PlaneFit::NONE.slope[1]);
            planes[3][lane] = or(variance, PlaneFit::NONE.residual).sqrt();
        }
        planes
    }
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

    /// Small images, and such as are higher or wider than a tile.
    fn size() -> impl Strategy<Value = (usize, usize)> {
        let (short, long) = (4_usize..9, TILE - 4..2 * TILE + 9);
        prop_oneof![3 => small_size(), 1 => (short.clone(), long.clone()), 1 => (long, short)]
    }

    proptest! {
        #[test]
        fn sliding_sums_give_the_planes_of_single_windows(
            disparity in size().prop_flat_map(|size| {
                raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
            }),
            radius in 1_usize..=5,
        ) {
            let fits = plane_fits(&disparity, radius);
            for i in 0..disparity.len() {
                let (got, expected) = (fits.at(i), naive(&disparity, i, radius));
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
            disparity in (1_usize..90, 1_usize..90).prop_flat_map(|size| {
                raster(size, prop_oneof![1 => Just(f32::NAN), 4 => 20.0_f32..700.0])
            }),
            radius in 1_usize..=5,
        ) {
            let mut scalar = [0; 4].map(|_| vec![f32::NAN; disparity.len()]);
            let pixels: Vec<usize> = (0..disparity.len()).collect();
            for (band, pixels) in pixels.chunks(TILE * disparity.width()).enumerate() {
                let fits = scalar.each_mut().map(|image| &mut image[pixels[0]..][..pixels.len()]);
                fit_band(&disparity, band * TILE, radius, &mut Windows::default(), fits);
            }
            let PlaneFits { value, slope: [a, b], residual } =
                plane_fits(&disparity, radius);
            let bits = |image: Vec<f32>| image.into_iter().map(f32::to_bits).collect::<Vec<_>>();
            let got = [value, a, b, residual].map(|image| bits(image.into_vec()));
            prop_assert_eq!(got, scalar.map(bits));
        }
    }

    /// Sums of whole numbers that were rounded gave a flat surface a residual.
    #[test]
    fn wide_windows_round_nothing_away() {
        let plane = |i: usize| 250.0 + 0.5 * (i % 200) as f32 - 0.25 * (i / 200) as f32;
        let disparity = Raster::from_vec(200, 200, (0..200 * 200).map(plane).collect()).unwrap();
        let fit = plane_fits(&disparity, 90).at(100 * 200 + 100);
        assert!(fit.residual < 1e-3 && fit.slope == [0.5, -0.25], "{fit:?}");
    }

    /// Sums of squares must not run over, whatever the radius.
    #[test]
    fn windows_grow_to_a_limit() {
        let side = 420;
        let plane = |i: usize| 450.0 + 0.5 * (i % side) as f32 - 0.25 * (i / side) as f32;
        let disparity = Raster::from_vec(side, side, (0..side * side).map(plane).collect()).unwrap();
        let [largest, larger] =
            [MOST_RADIUS_PX, MOST_RADIUS_PX + 50].map(|radius_px| plane_fits(&disparity, radius_px));
        let fit = larger.at(side * side / 2);
        assert!(fit.residual < 1e-2 && fit.slope.map(|s| (s * 1e3).round()) == [500.0, -250.0], "{fit:?}");
        assert_eq!(larger.images(), largest.images());
    }

    #[test]
    fn a_plane_is_its_own_fit() {
        let plane = |i: usize| 250.0 + 0.5 * (i % 20) as f32 - 0.25 * (i / 20) as f32;
        let disparity = Raster::from_vec(20, 16, (0..320).map(plane).collect()).unwrap();
        let fits = plane_fits(&disparity, 3);
        for (i, fit) in (0..320).map(|i| fits.at(i)).enumerate() {
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
