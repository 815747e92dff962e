//! Surfaces of first and second order in disparity, fitted from moments alone (docs/CONTEXT.md 2.1).
//!
//! The moments of two regions add up to those of their union, so that the model of a union and its residual are known
//! without touching a pixel.

#![allow(clippy::needless_range_loop, reason = "indices are exponents, as in the formulae")]

use std::ops::Range;

use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::position;

/// Exponents of x and y of the six terms of a quadratic; a plane uses the first three.
const TERMS: [(usize, usize); 6] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
/// Keeps the normal equations solvable, in normalised coordinates.
const RIDGE: f64 = 1e-7;
/// Mean squared distance from the centre (px^2) that a region has at least.
const LEAST_SPREAD: f64 = 1e-3;

/// What the disparity of a surface is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// 1, x, y.
    Plane,
    /// 1, x, y, xx, xy, yy.
    Quadratic,
}

/// Sums over the pixels of a region, with x and y counted from a centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Where x and y are counted from: column and row (px).
    pub center: [f64; 2],
    /// Σ x^i y^j at \[i\]\[j\], for i + j <= 4.
    powers: [[f64; 5]; 5],
    /// Σ d x^i y^j at \[i\]\[j\], for i + j <= 2.
    products: [[f64; 3]; 3],
    /// Σ d^2.
    squares: f64,
}

/// A surface: disparity (quanta) as a polynomial of the pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    center: [f64; 2],
    weights: [f64; 6],
}

/// A surface and how well it fits.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The surface.
    pub model: Model,
    /// Sum of the squared residuals (quanta^2).
    pub squared_error: f64,
}

impl Moments {
    /// Of no pixels.
    pub fn about(center: [f64; 2]) -> Self {
        Self { center, powers: [[0.0; 5]; 5], products: [[0.0; 3]; 3], squares: 0.0 }
    }

    /// Of all segments of a label map, each about its centroid; an empty one about the first pixel. O(pixels); parallel
    /// over segments.
    pub fn of_segments(segments: &Segments, disparity: &Raster<f32>) -> Vec<Self> {
        segments.runs_of_each().map(|_, runs| Self::of_runs(runs, disparity))
    }

    /// Of the pixels in these runs along rows.
    fn of_runs(runs: &[Range<usize>], disparity: &Raster<f32>) -> Self {
        let width = disparity.width();
        // Sums of whole numbers, which are exact in any order.
        let [mut count, mut across, mut down] = [0_u64; 3];
        for run in runs {
            let (n, u, v) = (run.len() as u64, (run.start % width) as u64, (run.start / width) as u64);
            count += n;
            across += n * u + n * (n - 1) / 2;
            down += n * v;
        }
        let mut moments = Self::about([across, down].map(|sum| sum as f64 / count.max(1) as f64));
        for run in runs {
            moments.add_run(position(run.start, width), &disparity.as_slice()[run.clone()]);
        }
        moments
    }

    /// Of the pixels with these indices, about their centroid; at least one.
    pub fn of(pixels: &[u32], disparity: &Raster<f32>) -> Self {
        let width = disparity.width();
        let n = pixels.len() as f64;
        let sum = pixels.iter().fold([0.0; 2], |[x, y], &i| {
            let [u, v] = position(i as usize, width);
            [x + u, y + v]
        });
        let mut moments = Self::about([sum[0] / n, sum[1] / n]);
        for &i in pixels {
            moments.add(position(i as usize, width), f64::from(disparity[i as usize]));
        }
        moments
    }

    /// Adds a pixel (px) with its disparity (quanta).
    pub fn add(&mut self, [u, v]: [f64; 2], d: f64) {
        self.add_at(u - self.center[0], powers(v - self.center[1]), d);
    }

    /// Adds pixels side by side, the first of which is at (u, v).
    fn add_run(&mut self, [u, v]: [f64; 2], disparity: &[f32]) {
        let y = powers(v - self.center[1]);
        for (k, &d) in disparity.iter().enumerate() {
            self.add_at((u + k as f64) - self.center[0], y, d.into());
        }
    }

    #[inline]
    fn add_at(&mut self, x: f64, y: [f64; 5], d: f64) {
        let x = powers(x);
        for i in 0..5 {
            for j in 0..5 - i {
                self.powers[i][j] += x[i] * y[j];
            }
        }
        for i in 0..3 {
            for j in 0..3 - i {
                self.products[i][j] += d * (x[i] * y[j]);
            }
        }
        self.squares += d * d;
    }

    /// Number of pixels.
    #[inline]
    pub fn count(&self) -> f64 {
        self.powers[0][0]
    }

    /// The same sums about another centre, by binomials: exact but for rounding.
    pub fn shifted(&self, center: [f64; 2]) -> Self {
        self.shifted_for::<2>(center)
    }

    /// Of the union of two regions, about its centroid.
    pub fn merged(&self, other: &Self) -> Self {
        self.merged_for::<2>(other)
    }

    /// The least-squares surface of the union of two regions, from those moments only that it needs: for a plane a quarter of
    /// the work of [`Self::merged`].
    pub fn fit_with(&self, other: &Self, basis: Basis) -> Fit {
        match basis {
            Basis::Plane => self.merged_for::<1>(other).fit(basis),
            Basis::Quadratic => self.merged_for::<2>(other).fit(basis),
        }
    }

    /// What a surface of this degree needs: moments of up to twice its order. The others are 0.
    #[inline]
    fn shifted_for<const DEGREE: usize>(&self, center: [f64; 2]) -> Self {
        let shift = [self.center[0] - center[0], self.center[1] - center[1]];
        let along = [powers(shift[0]), powers(shift[1])];
        let powers = match DEGREE {
            1 => shifted::<5, 2>(&self.powers, &along),
            _ => shifted::<5, 4>(&self.powers, &along),
        };
        Self { center, powers, products: shifted::<3, DEGREE>(&self.products, &along), squares: self.squares }
    }

    #[inline]
    fn merged_for<const DEGREE: usize>(&self, other: &Self) -> Self {
        let n = self.count() + other.count();
        let sum = |k: usize| {
            let first = |m: &Self| [m.powers[1][0], m.powers[0][1]][k];
            (self.count() * self.center[k] + first(self) + other.count() * other.center[k] + first(other)) / n
        };
        let center = [sum(0), sum(1)];
        let (mut union, other) = (self.shifted_for::<DEGREE>(center), other.shifted_for::<DEGREE>(center));
        for i in 0..=2 * DEGREE {
            for j in 0..=2 * DEGREE - i {
                union.powers[i][j] += other.powers[i][j];
            }
        }
        for i in 0..=DEGREE {
            for j in 0..=DEGREE - i {
                union.products[i][j] += other.products[i][j];
            }
        }
        union.squares += other.squares;
        union
    }

    /// The least-squares surface. O(1).
    pub fn fit(&self, basis: Basis) -> Fit {
        match basis {
            Basis::Plane => self.fit_terms::<3>(),
            Basis::Quadratic => self.fit_terms::<6>(),
        }
    }

    fn fit_terms<const K: usize>(&self) -> Fit {
        let n = self.count();
        let spread = (self.powers[2][0] + self.powers[0][2]) / n;
        let t = powers(1.0 / spread.max(LEAST_SPREAD).sqrt());
        let order = if K == 3 { 2 } else { 4 };
        let mut means = [[0.0; 5]; 5];
        for i in 0..=order {
            for j in 0..=order - i {
                means[i][j] = self.powers[i][j] * t[i + j] / n;
            }
        }
        let mut matrix = [[0.0; K]; K];
        let mut right = [0.0; K];
        for (r, &(i, j)) in TERMS[..K].iter().enumerate() {
            for (c, &(p, q)) in TERMS[..K].iter().enumerate() {
                matrix[r][c] = means[i + p][j + q];
            }
            matrix[r][r] += RIDGE;
            right[r] = self.products[i][j] * t[i + j] / n;
        }
        let x = solve(matrix, right);
        let explained: f64 = x.iter().zip(&right).map(|(x, b)| x * b).sum();
        let mut weights = [0.0; 6];
        for (k, (weight, x)) in weights.iter_mut().zip(x).enumerate() {
            let (i, j) = TERMS[k];
            *weight = x * t[i + j];
        }
        Fit {
            model: Model { center: self.center, weights },
            squared_error: (self.squares - n * explained).max(0.0),
        }
    }
}

impl Model {
    /// Its disparity at a pixel (quanta).
    #[inline]
    pub fn value(&self, [u, v]: [f64; 2]) -> f64 {
        let (x, y) = (u - self.center[0], v - self.center[1]);
        let [c, cx, cy, cxx, cxy, cyy] = self.weights;
        c + cx * x + cy * y + cxx * x * x + cxy * x * y + cyy * y * y
    }

    /// Its slope along u and v at a pixel (quanta/px).
    #[inline]
    pub fn slope(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (x, y) = (u - self.center[0], v - self.center[1]);
        let [_, cx, cy, cxx, cxy, cyy] = self.weights;
        [cx + 2.0 * cxx * x + cxy * y, cy + cxy * x + 2.0 * cyy * y]
    }

    /// How steep it is in the middle of its region (quanta/px).
    #[inline]
    pub fn steepness(&self) -> f64 {
        length([self.weights[1], self.weights[2]])
    }
}

/// Length of a slope; the same on every platform, which `hypot` is not.
#[inline]
pub(crate) fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// 1, x, x^2, x^3, x^4.
#[inline]
fn powers(x: f64) -> [f64; 5] {
    [1.0, x, x * x, x * x * x, x * x * x * x]
}

/// Moves a table of moments of up to this order by old centre - new centre, of which the powers are given: first along x,
/// then along y.
#[inline]
fn shifted<const N: usize, const ORDER: usize>(
    table: &[[f64; N]; N],
    along: &[[f64; 5]; 2],
) -> [[f64; N]; N] {
    const BINOMIALS: [[f64; 5]; 5] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0, 0.0],
        [1.0, 3.0, 3.0, 1.0, 0.0],
        [1.0, 4.0, 6.0, 4.0, 1.0],
    ];
    let [along_x, along_y] = along;
    let mut half = [[0.0; N]; N];
    let mut moved = [[0.0; N]; N];
    // Bounds that do not depend on each other, so that the loops are unrolled.
    for i in 0..N {
        for j in 0..N {
            if i + j <= ORDER {
                let mut sum = along_x[i] * table[0][j];
                for p in 1..N {
                    if p <= i {
                        sum += BINOMIALS[i][p] * along_x[i - p] * table[p][j];
                    }
                }
                half[i][j] = sum;
            }
        }
    }
    for i in 0..N {
        for j in 0..N {
            if i + j <= ORDER {
                let mut sum = along_y[j] * half[i][0];
                for q in 1..N {
                    if q <= j {
                        sum += BINOMIALS[j][q] * along_y[j - q] * half[i][q];
                    }
                }
                moved[i][j] = sum;
            }
        }
    }
    moved
}

/// Solves a small linear system by Gaussian elimination with partial pivoting. Terms that nothing determines are 0.
pub(crate) fn solve<const K: usize>(mut matrix: [[f64; K]; K], mut right: [f64; K]) -> [f64; K] {
    for k in 0..K {
        let mut pivot = k;
        for row in k + 1..K {
            if matrix[row][k].abs() > matrix[pivot][k].abs() {
                pivot = row;
            }
        }
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        if matrix[k][k] == 0.0 {
            continue;
        }
        for row in k + 1..K {
            let factor = matrix[row][k] / matrix[k][k];
            for column in k..K {
                matrix[row][column] -= factor * matrix[k][column];
            }
            right[row] -= factor * right[k];
        }
    }
    let mut x = [0.0; K];
    for k in (0..K).rev() {
        if matrix[k][k] != 0.0 {
            let known: f64 = (k + 1..K).map(|column| matrix[k][column] * x[column]).sum();
            x[k] = (right[k] - known) / matrix[k][k];
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{raster, small_size};

    /// An image of disparities and two sets of its pixels that have none in common, each with one at least.
    fn two_regions() -> impl Strategy<Value = (Raster<f32>, Vec<u32>, Vec<u32>)> {
        small_size()
            .prop_flat_map(|size| (raster(size, 0.0_f32..20.0), raster(size, 0_u8..3)))
            .prop_map(|(disparity, side)| {
                let of = |k: u8| (0..side.len() as u32).filter(|&i| side[i as usize] == k).collect();
                (disparity, of(0), of(1))
            })
            .prop_filter("both have pixels", |(_, a, b): &(_, Vec<u32>, Vec<u32>)| {
                !a.is_empty() && !b.is_empty()
            })
    }

    /// The sums over the pixels, from their definition.
    fn summed(pixels: &[u32], disparity: &Raster<f32>, center: [f64; 2]) -> Moments {
        let mut moments = Moments::about(center);
        for &i in pixels {
            let [u, v] = position(i as usize, disparity.width());
            let (x, y, d) = (u - center[0], v - center[1], f64::from(disparity[i as usize]));
            for (i, j) in (0..5).flat_map(|i| (0..5 - i).map(move |j| (i, j))) {
                moments.powers[i][j] += x.powi(i as i32) * y.powi(j as i32);
            }
            for (i, j) in (0..3).flat_map(|i| (0..3 - i).map(move |j| (i, j))) {
                moments.products[i][j] += d * x.powi(i as i32) * y.powi(j as i32);
            }
            moments.squares += d * d;
        }
        moments
    }

    /// The same but for rounding, which grows with the size of the terms.
    fn assert_same(got: &Moments, expected: &Moments) -> Result<(), TestCaseError> {
        let flat = |m: &Moments| {
            let tables = [m.powers.as_flattened(), m.products.as_flattened(), &[m.squares], &m.center];
            tables.concat()
        };
        for (k, (got, expected)) in flat(got).into_iter().zip(flat(expected)).enumerate() {
            prop_assert!((got - expected).abs() <= 1e-6 + 1e-11 * expected.abs(), "{k}: {got} {expected}");
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn moments_of_a_union_are_the_merged_ones(
            (disparity, a, b) in two_regions(),
            [center_a, center_b] in prop::array::uniform2(prop::array::uniform2(-5.0..20.0)),
        ) {
            let union = [a.as_slice(), &b].concat();
            let [of_a, of_b] = [&a, &b].map(|pixels| Moments::of(pixels, &disparity));
            let merged = of_a.merged(&of_b);
            let expected = Moments::of(&union, &disparity);
            assert_same(&merged, &expected)?;
            // Wherever the parts are counted from.
            assert_same(&of_a.shifted(center_a).merged(&of_b.shifted(center_b)), &expected)?;
            prop_assert_eq!(merged.count(), union.len() as f64);
            for basis in [Basis::Plane, Basis::Quadratic] {
                let (merged, scratch) = (merged.fit(basis), expected.fit(basis));
                prop_assert!((merged.squared_error - scratch.squared_error).abs() < 1e-4);
                for &i in &union {
                    let at = position(i as usize, disparity.width());
                    prop_assert!((merged.model.value(at) - scratch.model.value(at)).abs() < 1e-4);
                }
            }
        }

        #[test]
        fn moments_of_segments_and_trial_surfaces_are_the_same_bit_for_bit((disparity, a, b) in two_regions()) {
            let labels = (0..disparity.len() as u32).map(|i| if a.contains(&i) { 0 } else if b.contains(&i) { 2 } else { -1 });
            let segments = Segments::from_numbered(disparity.with_data(labels.collect()), 3);
            let [of_a, of_none, of_b] = &Moments::of_segments(&segments, &disparity)[..] else { panic!("three") };
            prop_assert_eq!([of_a, of_b], [&Moments::of(&a, &disparity), &Moments::of(&b, &disparity)]);
            prop_assert_eq!(of_none.count(), 0.0);
            for basis in [Basis::Plane, Basis::Quadratic] {
                let (trial, whole) = (of_a.fit_with(of_b, basis), of_a.merged(of_b).fit(basis));
                prop_assert_eq!((trial.model, trial.squared_error), (whole.model, whole.squared_error));
            }
        }

        #[test]
        fn moments_are_shifted_as_if_summed_there(
            (disparity, pixels, _) in two_regions(),
            center in prop::array::uniform2(-20.0..20.0),
        ) {
            let own = Moments::of(&pixels, &disparity);
            assert_same(&own, &summed(&pixels, &disparity, own.center))?;
            assert_same(&own.shifted(center), &summed(&pixels, &disparity, center))?;
            assert_same(&own.shifted(center).shifted(own.center), &own)?;
        }

        /// A fit is best when the residuals are at right angles to every term; only the ridge, in normalised
        /// coordinates, draws the weights a little to 0.
        #[test]
        fn a_fit_has_the_least_squared_error((disparity, pixels, _) in two_regions()) {
            let moments = Moments::of(&pixels, &disparity);
            let n = moments.count();
            let spread_px = ((moments.powers[2][0] + moments.powers[0][2]) / n).max(LEAST_SPREAD).sqrt();
            for (basis, terms) in [(Basis::Plane, 3), (Basis::Quadratic, 6)] {
                let Fit { model, squared_error } = moments.fit(basis);
                let residuals = pixels.iter().map(|&i| {
                    let at = position(i as usize, disparity.width());
                    (at, f64::from(disparity[i as usize]) - model.value(at))
                });
                let (mut left, mut drawn) = (residuals.clone().map(|(_, r)| r * r).sum::<f64>(), 0.0);
                for (k, &(p, q)) in TERMS[..terms].iter().enumerate() {
                    let term = |[u, v]: [f64; 2]| {
                        let [x, y] = [u - model.center[0], v - model.center[1]].map(|x| x / spread_px);
                        x.powi(p as i32) * y.powi(q as i32)
                    };
                    let weight = model.weights[k] * spread_px.powi((p + q) as i32);
                    let along: f64 = residuals.clone().map(|(at, r)| r * term(at)).sum();
                    prop_assert!((along - n * RIDGE * weight).abs() < 1e-6 * n, "{along}");
                    drawn += n * RIDGE * weight * weight;
                }
                left += drawn;
                prop_assert!((squared_error - left).abs() < 1e-6 * n, "{squared_error} {left}");
            }
        }

        #[test]
        fn planes_and_quadratics_are_recovered(
            corner in prop::array::uniform2(0_usize..600),
            [a, b] in prop::array::uniform2(-3.0..3.0),
            [xx, xy, yy] in prop::array::uniform3(-0.1..0.1),
            side in 3_usize..12,
        ) {
            let at = |k: usize| [(corner[0] + k % side) as f64, (corner[1] + k / side) as f64];
            for (basis, bend) in [(Basis::Plane, 0.0), (Basis::Quadratic, 1.0)] {
                let surface = |[u, v]: [f64; 2]| {
                    let (x, y) = (u - corner[0] as f64, v - corner[1] as f64);
                    300.0 + a * x + b * y + bend * (xx * x * x + xy * x * y + yy * y * y)
                };
                // About a centre that is not the centroid, as the structure's.
                let mut moments = Moments::about(at(0));
                (0..side * side).for_each(|k| moments.add(at(k), surface(at(k))));
                let Fit { model, squared_error } = moments.fit(basis);
                prop_assert!(squared_error < 0.02 * moments.count(), "{squared_error}");
                for at in (0..side * side).map(at) {
                    prop_assert!((model.value(at) - surface(at)).abs() < 0.02);
                    let rise = [[0.5, 0.0], [0.0, 0.5]].map(|[du, dv]| {
                        surface([at[0] + du, at[1] + dv]) - surface([at[0] - du, at[1] - dv])
                    });
                    let slope = model.slope(at);
                    prop_assert!((slope[0] - rise[0]).abs() < 0.02 && (slope[1] - rise[1]).abs() < 0.02);
                }
                let about_center = model.slope(model.center);
                prop_assert!((model.steepness() - about_center[0].hypot(about_center[1])).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_determines_no_surface_is_fitted_all_the_same() {
        let disparity = Raster::from_vec(9, 9, (0..81).map(|i| 200.0 + (i % 9) as f32).collect()).unwrap();
        let row: Vec<u32> = (36..45).collect();
        let column: Vec<u32> = (0..9).map(|v| 9 * v + 4).collect();
        let diagonal: Vec<u32> = (0..9).map(|v| 10 * v).collect();
        for pixels in [&row[..1], &row[..2], &row, &column, &diagonal, &[0, 1, 9]] {
            for basis in [Basis::Plane, Basis::Quadratic] {
                let fit = Moments::of(pixels, &disparity).fit(basis);
                for &i in pixels {
                    let expected = f64::from(disparity[i as usize]);
                    let got = fit.model.value(position(i as usize, 9));
                    assert!((got - expected).abs() < 0.01, "{basis:?} {pixels:?}: {got} {expected}");
                }
                let elsewhere = fit.model.value([20.0, 20.0]);
                assert!(elsewhere.is_finite() && fit.squared_error.is_finite(), "{basis:?} {pixels:?}");
            }
        }
        // No pixels at all are no panic.
        let none = Moments::about([3.0, 4.0]);
        assert_eq!(
            (none.count(), none.shifted([0.0; 2]).count(), none.merged(&none).count()),
            (0.0, 0.0, 0.0)
        );
        none.fit(Basis::Quadratic);
    }
}
