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
/// the columns, then along the rows: O(pixels · (1 + radius / 32)), because each band of 64 rows starts anew.
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
            let fits = plane_fits(&disparity, radius);
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

    #[test]
    fn a_plane_is_its_own_fit() {
        let plane = |i: usize| 250.0 + 0.5 * (i % 20) as f32 - 0.25 * (i / 20) as f32;
        let disparity = Raster::from_vec(20, 16, (0..320).map(plane).collect()).unwrap();
        for (i, fit) in plane_fits(&disparity, 3).as_slice().iter().enumerate() {
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
