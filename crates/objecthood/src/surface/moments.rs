//! Moments of regions, from which surfaces are fitted (docs/CONTEXT.md 2.1).
//!
//! The moments of a union are the sum of the moments of its parts. So the surface of a union and its residual follow without
//! a visit to any pixel.

#![allow(clippy::needless_range_loop, reason = "indices are exponents, as in the formulae")]

use std::ops::Range;

use crate::linear::solve;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::position;
use crate::surface::model::{Basis, Fit, Model, TERMS};

/// Added to the diagonal of the normal equations, in which x and y are scaled to a spread of 1, so that they have a solution.
const RIDGE: f64 = 1e-7;
/// The least mean squared distance from the centre (px^2) by which x and y are scaled.
const LEAST_SPREAD: f64 = 1e-3;

/// Sums over the pixels of a region, with x and y counted from a centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    /// Origin of x and y: column and row (px).
    pub center: [f64; 2],
    /// Σ x^i y^j at \[i\]\[j\], for i + j <= 4.
    powers: [[f64; 5]; 5],
    /// Σ d x^i y^j at \[i\]\[j\], for i + j <= 2.
    products: [[f64; 3]; 3],
    /// Σ d^2.
    squares: f64,
}

impl Moments {
    /// The moments of no pixels.
    pub fn about(center: [f64; 2]) -> Self {
        Self { center, powers: [[0.0; 5]; 5], products: [[0.0; 3]; 3], squares: 0.0 }
    }

    /// The moments of every segment of a label map about its centroid; for an empty segment about the first pixel of the image.
    /// O(pixels), parallel over segments.
    pub fn of_segments(segments: &Segments, disparity: &Raster<f32>) -> Vec<Self> {
        segments.runs_of_each().map(|_, runs| Self::of_runs(runs, disparity))
    }

    /// The moments of the pixels in these runs along rows, about their centroid.
    fn of_runs(runs: &[Range<usize>], disparity: &Raster<f32>) -> Self {
        let width = disparity.width();
        // Sums of whole numbers are exact in any order.
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

    /// The moments of the pixels with these indices about their centroid. O(pixels). `pixels` must not be empty.
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
        self.add_at::<2>(u - self.center[0], powers(v - self.center[1]), d);
    }

    /// As [`Self::add`], but only to the sums that a plane needs: less than half of the work. [`Self::fit`] then finds planes only.
    pub(crate) fn add_for_plane(&mut self, [u, v]: [f64; 2], d: f64) {
        self.add_at::<1>(u - self.center[0], powers(v - self.center[1]), d);
    }

    /// Adds pixels of one row, the first at (u, v).
    fn add_run(&mut self, [u, v]: [f64; 2], disparity: &[f32]) {
        let y = powers(v - self.center[1]);
        for (k, &d) in disparity.iter().enumerate() {
            self.add_at::<2>((u + k as f64) - self.center[0], y, d.into());
        }
    }

    /// Adds to the sums that a surface of this degree needs.
    #[inline]
    fn add_at<const DEGREE: usize>(&mut self, x: f64, y: [f64; 5], d: f64) {
        let x = powers(x);
        // Half-open ranges, which the compiler unrolls.
        for i in 0..2 * DEGREE + 1 {
            for j in 0..2 * DEGREE + 1 - i {
                self.powers[i][j] += x[i] * y[j];
            }
        }
        for i in 0..DEGREE + 1 {
            for j in 0..DEGREE + 1 - i {
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

    /// The same moments about another centre, by the binomial theorem; exact except for rounding. O(1).
    pub fn shifted(&self, center: [f64; 2]) -> Self {
        self.shifted_for::<2>(center)
    }

    /// The moments of the union of two disjoint regions about its centroid. O(1).
    pub fn merged(&self, other: &Self) -> Self {
        self.merged_for::<2>(other)
    }

    /// The least-squares surface of the union of two disjoint regions, equal to the bit to `merged(other).fit(basis)`. It moves only
    /// the moments that the basis needs; for a plane this is a quarter of the work. O(1).
    pub(crate) fn fit_with(&self, other: &Self, basis: Basis) -> Fit {
        match basis {
            Basis::Plane => self.merged_for::<1>(other).fit(basis),
            Basis::Quadratic => self.merged_for::<2>(other).fit(basis),
        }
    }

    /// The moments about another centre that a surface of this degree needs: up to twice its degree. The others are 0.
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

    /// The least-squares surface of the region. O(1).
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

/// 1, x, x^2, x^3, x^4.
#[inline]
fn powers(x: f64) -> [f64; 5] {
    [1.0, x, x * x, x * x * x, x * x * x * x]
}

/// Binomial coefficients.
const BINOMIALS: [[f64; 5]; 5] = [
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0],
];

/// Moves the centre of a table of moments of up to this order, first along x, then along y. `along`: the powers of old centre
/// - new centre.
#[inline]
fn shifted<const N: usize, const ORDER: usize>(
    table: &[[f64; N]; N],
    along: &[[f64; 5]; 2],
) -> [[f64; N]; N] {
    let [along_x, along_y] = along;
    let mut half = [[0.0; N]; N];
    let mut moved = [[0.0; N]; N];
    // No loop bound depends on an index, so the compiler unrolls the loops.
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

#[cfg(test)]
mod tests;
