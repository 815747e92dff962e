//! Surfaces of first and second order in disparity, fitted from moments alone (METHOD 3.5).
//!
//! The moments of two regions add up to those of their union, so that the model of a union and its residual are known
//! without touching a pixel.

#![allow(clippy::needless_range_loop, reason = "indices are exponents, as in the formulae")]

use crate::raster::Raster;
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
        let (x, y) = (u - self.center[0], v - self.center[1]);
        let (x, y) = ([1.0, x, x * x, x * x * x, x * x * x * x], [1.0, y, y * y, y * y * y, y * y * y * y]);
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
        let shift = [self.center[0] - center[0], self.center[1] - center[1]];
        Self {
            center,
            powers: shifted(&self.powers, shift),
            products: shifted(&self.products, shift),
            squares: self.squares,
        }
    }

    /// Of the union of two regions, about its centroid.
    pub fn merged(&self, other: &Self) -> Self {
        let n = self.count() + other.count();
        let sum = |k: usize| {
            let first = |m: &Self| [m.powers[1][0], m.powers[0][1]][k];
            (self.count() * self.center[k] + first(self) + other.count() * other.center[k] + first(other)) / n
        };
        let center = [sum(0), sum(1)];
        let (mut union, other) = (self.shifted(center), other.shifted(center));
        let sums = union.powers.as_flattened_mut().iter_mut().chain(union.products.as_flattened_mut());
        let others = other.powers.as_flattened().iter().chain(other.products.as_flattened());
        sums.zip(others).for_each(|(sum, other)| *sum += other);
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
        let t = 1.0 / spread.max(LEAST_SPREAD).sqrt();
        let t = [1.0, t, t * t, t * t * t, t * t * t * t];
        let mut matrix = [[0.0; K]; K];
        let mut right = [0.0; K];
        for (r, &(i, j)) in TERMS[..K].iter().enumerate() {
            for (c, &(p, q)) in TERMS[..K].iter().enumerate() {
                matrix[r][c] = self.powers[i + p][j + q] * t[i + j + p + q] / n;
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

/// Moves a table of moments by `shift` = old centre - new centre: first along x, then along y.
fn shifted<const N: usize>(table: &[[f64; N]; N], shift: [f64; 2]) -> [[f64; N]; N] {
    const BINOMIALS: [[f64; 5]; 5] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 1.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 1.0, 0.0, 0.0],
        [1.0, 3.0, 3.0, 1.0, 0.0],
        [1.0, 4.0, 6.0, 4.0, 1.0],
    ];
    let powers = |s: f64| [1.0, s, s * s, s * s * s, s * s * s * s];
    let [along_x, along_y] = shift.map(powers);
    let mut half = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N - i {
            half[i][j] = (0..=i).map(|p| BINOMIALS[i][p] * along_x[i - p] * table[p][j]).sum();
        }
    }
    let mut moved = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N - i {
            moved[i][j] = (0..=j).map(|q| BINOMIALS[j][q] * along_y[j - q] * half[i][q]).sum();
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
