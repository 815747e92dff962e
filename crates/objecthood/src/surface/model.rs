//! A surface in disparity: a plane or a quadratic (docs/CONTEXT.md 2.1).

use crate::linear::length;

/// Exponents of x and y of the six terms of a quadratic; a plane uses the first three.
pub(crate) const TERMS: [(usize, usize); 6] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];

/// The terms of the polynomial that gives the disparity of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// 1, x, y.
    Plane,
    /// 1, x, y, xx, xy, yy.
    Quadratic,
}

/// A surface: disparity (quanta) as a polynomial of the pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Origin of x and y: column and row (px).
    pub(super) center: [f64; 2],
    /// Coefficients of [`TERMS`], with x and y counted from the centre.
    pub(super) weights: [f64; 6],
}

/// A surface with the error of its fit.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The surface.
    pub model: Model,
    /// Sum of the squared residuals (quanta^2).
    pub squared_error: f64,
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

    /// The length of its slope at the centre (quanta/px).
    #[inline]
    pub fn steepness(&self) -> f64 {
        length([self.weights[1], self.weights[2]])
    }

    /// How much it bends along a row: the size of the factor of the square (quanta/px^2).
    pub(crate) fn bend_in_rows(&self) -> f64 {
        self.weights[3].abs()
    }

    /// The direction (columns, rows) in which it bends most: of the largest second derivative.
    pub(crate) fn steepest_bend(&self) -> [f64; 2] {
        let [.., cxx, cxy, cyy] = self.weights;
        let turn = 0.5 * libm::atan2(cxy, cxx - cyy);
        // The larger of both second derivatives along the axes, by size, lies along this turn or across it.
        let turn = if cxx + cyy < 0.0 { turn + std::f64::consts::FRAC_PI_2 } else { turn };
        [libm::cos(turn), libm::sin(turn)]
    }
}
