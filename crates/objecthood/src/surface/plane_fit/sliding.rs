//! Sums over windows that slide down an image, and the planes fitted from them.

/// Value, slope along u and along v, residual of a window without a fit.
pub(super) const NO_PLANE: [f32; 4] = [0.0, 0.0, 0.0, f32::INFINITY];

/// Width and height (px) of the tiles that are fitted one by one: their sums stay in the first-level cache. Fixed, so that
/// rounding does not depend on the number of threads.
pub(super) const TILE: usize = 64;
/// A window with a smaller share of measured pixels has no fit.
pub(super) const LEAST_FILL: f64 = 0.4;
/// Least determinant of the second moments of a window's pixels (px^4): below it they lie almost in a line, and there is no fit.
const LEAST_SPREAD: f64 = 1e-3;

/// Windows of a block, which are fitted side by side.
const LANES: usize = 16;
/// Windows of a block whose sums of disparities are formed together: these stay in registers, even in the narrowest vectors.
const GROUP: usize = LANES / 2;
/// For each window of a block, a sum of disparities times whole numbers.
type Sum = [f64; LANES];
/// For each window of a block, a sum of whole numbers.
type Count = [i32; LANES];

/// The sums over the windows around the pixels of one row of a tile.
///
/// At radii up to 80 px all sums except dd are exact and so independent of the order: the disparities of a frame differ by a factor
/// of 200 at most, so all are multiples of one number by whole factors below 2^32, and no sum is 2^21 times as large.
#[derive(Clone, Debug, Default)]
pub(super) struct SlidingWindows {
    radius: usize,
    /// The sums in blocks of windows. x and y are counted from the middle of each window.
    sums: [WindowSums; TILE / LANES],
    /// The sums over each of the last 2 radius + 1 rows, and over the one before, which leaves the windows.
    rows: Vec<[RowSums; TILE / LANES]>,
    /// The entering row, from the start of the first window to the end of the last: 1 where it is measured, else 0.
    measured: Vec<i32>,
    /// Its disparity where it is measured, else 0.
    disparity: Vec<f64>,
}

/// Sums over a block of windows.
#[derive(Clone, Debug, Default)]
struct WindowSums {
    /// 1, x, y, xx, xy, yy.
    counts: [Count; 6],
    /// d, dx, dy, dd.
    disparities: [Sum; 4],
    /// The number of rows, up to the last one, in which all pixels of all windows are measured. When there are as many as a window has,
    /// the counts of all windows are the same, and remain so.
    full_rows: usize,
}

/// Sums over the parts of one row that lie in a block of windows.
#[derive(Clone, Copy, Debug, Default)]
struct RowSums {
    /// 1, x, xx.
    counts: [Count; 3],
    /// d, dx, dd.
    disparities: [Sum; 3],
    /// Whether all pixels are measured.
    is_full: bool,
}

impl SlidingWindows {
    /// Makes the windows empty.
    #[inline(always)]
    pub(super) fn clear(&mut self, radius: usize) {
        self.radius = radius;
        self.sums = Default::default();
        self.rows.clear();
        self.rows.resize(2 * radius + 2, Default::default());
        self.measured.resize(TILE + 2 * radius, 0);
        self.disparity.resize(TILE + 2 * radius, 0.0);
    }

    /// Moves the windows down by one row, so that row `v` is their last. A row below the image is empty.
    #[inline(always)]
    pub(super) fn slide_down(&mut self, v: usize, row: &[f32], left: usize) {
        self.read(row, left);
        let side = 2 * self.radius + 1;
        let places = [v % (side + 1), (v + 1) % (side + 1)];
        let Ok([entering, leaving]) = self.rows.get_disjoint_mut(places) else { return };
        let blocks = self.sums.iter_mut().zip(entering).zip(leaving);
        for (b, ((sums, entering), leaving)) in blocks.enumerate() {
            let part = b * LANES..b * LANES + LANES - 1 + side;
            entering.sum(&self.measured[part.clone()], &self.disparity[part], self.radius);
            sums.slide_down(leaving, entering, self.radius);
        }
    }

    /// Reads the part of a row that lies in windows of the tile. Outside the image nothing is measured.
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
    pub(super) fn fit(&self, disparity: &[f32], mut fits: [&mut [f32]; 4]) {
        let side = (2 * self.radius + 1) as f64;
        for (block, (sums, disparity)) in self.sums.iter().zip(disparity.chunks(LANES)).enumerate() {
            let place = block * LANES..block * LANES + disparity.len();
            let fits = fits.each_mut().map(|image| &mut image[place.clone()]);
            // A window of one pixel has no plane.
            if sums.full_rows > 2 * self.radius && self.radius > 0 {
                // Beyond the image nothing is measured, so these are as many as a block has.
                let fits = fits.into_iter().filter_map(|fits| fits.first_chunk_mut());
                fits.zip(sums.planes_of_full()).for_each(|(fits, planes)| *fits = planes);
                continue;
            }
            let planes = sums.planes(LEAST_FILL * side * side);
            for ((fits, plane), none) in fits.into_iter().zip(&planes).zip(NO_PLANE) {
                for ((fit, plane), d) in fits.iter_mut().zip(plane).zip(disparity) {
                    *fit = if d.is_nan() { none } else { *plane };
                }
            }
        }
    }
}

impl RowSums {
    /// Sums over the parts of a row that start at successive pixels.
    #[inline(always)]
    fn sum(&mut self, measured: &[i32], disparity: &[f64], radius: usize) {
        self.is_full = measured.iter().fold(1, |all, measured| all & measured) == 1;
        if self.is_full {
            let (side, middle) = (2 * radius as i32 + 1, radius as i32);
            let of_full = [side, 0, side * middle * (middle + 1) / 3];
            self.counts.iter_mut().zip(of_full).for_each(|(count, of_full)| count.fill(of_full));
        } else {
            self.count(measured, radius);
        }
        self.sum_disparities(disparity, radius);
    }

    /// 1, x, xx.
    ///
    /// The pixels are added from the last to the first; then sums of sums are moments about the pixel before the first.
    #[inline(always)]
    fn count(&mut self, measured: &[i32], radius: usize) {
        self.counts = [[0; LANES]; 3];
        let [n, x, xx] = &mut self.counts;
        for measured in measured.windows(LANES).rev() {
            for lane in 0..LANES {
                n[lane] += measured[lane];
                x[lane] += n[lane];
                xx[lane] += x[lane];
            }
        }
        let middle = radius as i32 + 1;
        for lane in 0..LANES {
            // Until here a pixel at x adds x (x + 1) / 2 to xx.
            xx[lane] = 2 * xx[lane] - (2 * middle + 1) * x[lane] + middle * middle * n[lane];
            x[lane] -= middle * n[lane];
        }
    }

    /// d, dx, dd, in the same way.
    #[inline(always)]
    fn sum_disparities(&mut self, disparity: &[f64], radius: usize) {
        let middle = radius as f64 + 1.0;
        for group in (0..LANES).step_by(GROUP) {
            let [mut d, mut dx, mut dd] = [[0.0; GROUP]; 3];
            for disparity in disparity[group..][..2 * radius + GROUP].windows(GROUP).rev() {
                for lane in 0..GROUP {
                    d[lane] += disparity[lane];
                    dx[lane] += d[lane];
                    dd[lane] += disparity[lane] * disparity[lane];
                }
            }
            for lane in 0..GROUP {
                dx[lane] -= middle * d[lane];
            }
            let sums = self.disparities.iter_mut().zip([d, dx, dd]);
            sums.for_each(|(sums, of_group)| sums[group..][..GROUP].copy_from_slice(&of_group));
        }
    }
}

impl WindowSums {
    /// Moves the windows down by one row.
    #[inline(always)]
    fn slide_down(&mut self, leaving: &RowSums, entering: &RowSums, radius: usize) {
        let were_full = self.full_rows > 2 * radius;
        self.full_rows = if entering.is_full { self.full_rows + 1 } else { 0 };
        if !(were_full && entering.is_full) {
            self.slide_counts(leaving, entering, radius);
        }
        let [ds, dxs, dys, dds] = &mut self.disparities;
        let [[d, dx, dd], [d_in, dx_in, dd_in]] = [&leaving.disparities, &entering.disparities];
        let (y, y_in) = (-(radius as f64) - 1.0, radius as f64);
        for lane in 0..LANES {
            dys[lane] += d_in[lane] * y_in - d[lane] * y - ds[lane];
            ds[lane] += d_in[lane] - d[lane];
            dxs[lane] += dx_in[lane] - dx[lane];
            dds[lane] += dd_in[lane] - dd[lane];
        }
    }

    /// Moves the windows down by one row: the counts.
    #[inline(always)]
    fn slide_counts(&mut self, leaving: &RowSums, entering: &RowSums, radius: usize) {
        let [ns, xs, ys, xxs, xys, yys] = &mut self.counts;
        let [[n, x, xx], [n_in, x_in, xx_in]] = [&leaving.counts, &entering.counts];
        let (y, y_in) = (-(radius as i32) - 1, radius as i32);
        for lane in 0..LANES {
            // The windows moved down, so y decreases by 1 for all their pixels.
            yys[lane] += ns[lane] - 2 * ys[lane] + n_in[lane] * (y_in * y_in) - n[lane] * (y * y);
            ys[lane] += n_in[lane] * y_in - n[lane] * y - ns[lane];
            xys[lane] += x_in[lane] * y_in - x[lane] * y - xs[lane];
            ns[lane] += n_in[lane] - n[lane];
            xs[lane] += x_in[lane] - x[lane];
            xxs[lane] += xx_in[lane] - xx[lane];
        }
    }

    /// The least-squares planes of the windows with at least `least` pixels: value in the middle, slope along u and v,
    /// residual.
    ///
    /// Computed from n times the moments about the mean, so that one division serves all four numbers.
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
            planes[0][lane] = or(value, NO_PLANE[0]);
            planes[1][lane] = or(a, NO_PLANE[1]);
            planes[2][lane] = or(b, NO_PLANE[2]);
            planes[3][lane] = or(variance, NO_PLANE[3]).sqrt();
        }
        planes
    }

    /// The planes of windows in which all pixels are measured: those of [`Self::planes`], to the bit. x, y and xy are 0, so what divides
    /// is the same for all.
    #[inline(always)]
    fn planes_of_full(&self) -> [[f32; LANES]; 4] {
        let mut planes = [[0.0; LANES]; 4];
        let [n, _, _, xx, _, yy] = self.counts.map(|count| f64::from(count[0]));
        let [ds, dxs, dys, dds] = &self.disparities;
        let [xx, yy] = [n * xx, n * yy];
        let spread = xx * yy;
        let freedom = n * (n - 3.0);
        let inverse = 1.0 / (spread * freedom);
        let [slope, mean, rest] = [freedom * inverse, spread * (n - 3.0) * inverse, spread * inverse];
        for lane in 0..LANES {
            let [d, dx, dy, dd] = [ds[lane], dxs[lane], dys[lane], dds[lane]];
            let [dx, dy, dd] = [n * dx, n * dy, n * dd - d * d];
            let a = dx * yy * slope;
            let b = dy * xx * slope;
            let variance = (dd - a * dx - b * dy).max(0.0) * rest;
            planes[0][lane] = (d * mean) as f32;
            planes[1][lane] = a as f32;
            planes[2][lane] = b as f32;
            planes[3][lane] = (variance as f32).sqrt();
        }
        planes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Lcg;

    /// Holes enter and leave, so counts are left out and formed again many times.
    #[test]
    fn windows_in_which_all_is_measured_have_the_planes_of_any_windows() {
        let mut random = Lcg::new(5);
        for radius in 1..=5 {
            let (mut windows, mut full) = (SlidingWindows::default(), 0);
            windows.clear(radius);
            for v in 0..200 {
                let mut row: Vec<f32> =
                    (0..3 * TILE).map(|_| 20.0 + random.below(680_000) as f32 / 1000.0).collect();
                if v % 37 == 5 {
                    row[TILE + v % TILE] = f32::NAN;
                }
                windows.slide_down(v, &row, TILE);
                let (side, r) = (2 * radius as i32 + 1, radius as i32);
                let xx = side * side * r * (r + 1) / 3;
                for sums in windows.sums.iter().filter(|sums| sums.full_rows > 2 * radius) {
                    full += 1;
                    assert_eq!(sums.counts, [side * side, 0, 0, xx, 0, xx].map(|count| [count; LANES]));
                    let bits = |planes: [[f32; LANES]; 4]| planes.map(|plane| plane.map(f32::to_bits));
                    assert_eq!(bits(sums.planes_of_full()), bits(sums.planes(0.0)));
                }
            }
            assert!(full > 0);
        }
    }
}
