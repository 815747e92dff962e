//! Surfaces of revolution about up, as a potter's wheel makes them: bowls, plates, cups, cans and balls.

use crate::linear::solve;

/// Rounds of the fit: in each, equations are weighted by the slope that the round before found. Two more change the distances by less than noise.
const ROUNDS: usize = 3;
/// A smaller slope of the equation counts as this (m): at the axis it vanishes.
const LEAST_SLOPE_M: f64 = 1e-3;

/// A surface of revolution about up: a point at (x, y, h) is on it if its squared distance from the axis is
/// `a + b h + c h²`. This holds exactly for every upright cylinder, cone, sphere and paraboloid, and nearly
/// for a bowl or a plate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Revolution {
    /// The mean of the points, from which all coordinates below are measured (m).
    origin_m: [f64; 3],
    /// Twice the axis' place, then a, b and c less the squared distance of the axis: x² + y² = `terms` · (x, y, 1, h, h²).
    terms: [f64; 5],
}

impl Revolution {
    /// Fits the surface to points (two coordinates along the support, and the height above it; m). Linear least squares, weighted so that
    /// distances count (Taubin 1991). O(points).
    pub(super) fn fit(points_m: &[[f64; 3]]) -> Self {
        let origin_m = mean_m(points_m);
        let mut fitted = Self { origin_m, terms: [0.0; 5] };
        for round in 0..ROUNDS {
            let (mut matrix, mut right) = ([[0.0; 5]; 5], [0.0; 5]);
            for &point in points_m {
                let [x, y, h] = fitted.about_origin(point);
                let slope_m = if round == 0 { 1.0 } else { fitted.slope_m([x, y, h]) };
                let row = [x, y, 1.0, h, h * h].map(|term| term / slope_m);
                let squared = (x * x + y * y) / slope_m;
                for (k, term) in row.into_iter().enumerate() {
                    right[k] += term * squared;
                    (0..5).for_each(|other| matrix[k][other] += term * row[other]);
                }
            }
            fitted.terms = solve(matrix, right);
        }
        fitted
    }

    fn about_origin(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| point[k] - self.origin_m[k])
    }

    /// The slope of the equation at a place (m). The residual of the equation, divided by it, is the distance
    /// from the surface.
    fn slope_m(&self, [x, y, h]: [f64; 3]) -> f64 {
        let [p, q, _, b, c] = self.terms;
        let slope = [2.0 * x - p, 2.0 * y - q, b + 2.0 * c * h];
        slope.iter().map(|x| x * x).sum::<f64>().sqrt().max(LEAST_SLOPE_M)
    }

    /// How far (m) a point lies beyond the surface, seen from the axis; below 0 within it. To first order.
    pub(super) fn beyond_m(&self, point: [f64; 3]) -> f64 {
        let [x, y, h] = self.about_origin(point);
        let [p, q, a, b, c] = self.terms;
        let off = x * x + y * y - (p * x + q * y + a + b * h + c * h * h);
        off / self.slope_m([x, y, h])
    }

    /// The root mean square distance of points from the surface (m). O(points).
    pub(super) fn distance_m(&self, points_m: &[[f64; 3]]) -> f64 {
        let squared = points_m.iter().map(|&point| self.beyond_m(point).powi(2));
        (squared.sum::<f64>() / points_m.len().max(1) as f64).sqrt()
    }

    /// A point, seen from the axis (m).
    pub(super) fn about_axis(&self, point: [f64; 3]) -> [f64; 2] {
        let [x, y, _] = self.about_origin(point);
        [x - self.terms[0] / 2.0, y - self.terms[1] / 2.0]
    }
}

/// The mean of points (m). O(points).
pub(super) fn mean_m(points_m: &[[f64; 3]]) -> [f64; 3] {
    let n = points_m.len().max(1) as f64;
    [0, 1, 2].map(|k| points_m.iter().map(|point| point[k]).sum::<f64>() / n)
}

/// The root mean square distance (m) of points from the plane that fits them best, along its normal. O(points).
pub(super) fn plane_distance_m(points_m: &[[f64; 3]]) -> f64 {
    let n = points_m.len().max(1) as f64;
    let origin_m = mean_m(points_m);
    let offsets = || points_m.iter().map(|point| [0, 1, 2].map(|k| point[k] - origin_m[k]));
    let sum = |a: usize, b: usize| offsets().map(|offset| offset[a] * offset[b]).sum::<f64>();
    let [p, q] = solve([[sum(0, 0), sum(0, 1)], [sum(0, 1), sum(1, 1)]], [sum(0, 2), sum(1, 2)]);
    let squared: f64 = offsets().map(|[x, y, h]| (h - p * x - q * y).powi(2)).sum();
    (squared / n / (1.0 + p * p + q * q)).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    const AXIS_M: [f64; 2] = [0.31, -0.22];

    /// Points of a surface with this radius at each height, at these turns (0 to 1).
    fn points(radius_m: impl Fn(f64) -> f64, turns: &[f64]) -> Vec<[f64; 3]> {
        let at = |h: f64, turn: f64| {
            let (sin, cos) = (libm::sin(turn * TAU), libm::cos(turn * TAU));
            [AXIS_M[0] + radius_m(h) * cos, AXIS_M[1] + radius_m(h) * sin, h]
        };
        turns
            .iter()
            .flat_map(|&turn| (0..12).map(move |k| (k, turn)))
            .map(|(k, turn)| at(f64::from(k) * 0.005, turn))
            .collect()
    }

    #[test]
    fn what_is_turned_is_near_its_surface_and_its_axis_is_found() {
        let turns: Vec<f64> = (0..10).map(|k| f64::from(k) * 0.04).collect();
        let can = |_| 0.04;
        let cone = |h| 0.03 + h;
        let ball = |h: f64| (0.06_f64.powi(2) - (h - 0.02).powi(2)).sqrt();
        let shapes: [&dyn Fn(f64) -> f64; 3] = [&can, &cone, &ball];
        for shape in shapes {
            let points = points(shape, &turns);
            let surface = Revolution::fit(&points);
            assert!(surface.distance_m(&points) < 0.0015, "{surface:?}");
            let off = surface.about_axis([AXIS_M[0], AXIS_M[1], 0.0]);
            assert!(off[0].hypot(off[1]) < 0.005, "{off:?}");
        }
    }

    #[test]
    fn the_walls_of_two_cans_are_not_of_one_surface() {
        let half: Vec<f64> = (0..10).map(|k| f64::from(k) * 0.05).collect();
        let can = points(|_| 0.04, &half);
        let both: Vec<[f64; 3]> =
            can.iter().copied().chain(can.iter().map(|&[x, y, h]| [x + 0.09, y, h])).collect();
        assert!(Revolution::fit(&both).distance_m(&can) > 0.005);
    }

    #[test]
    fn points_of_a_plane_have_no_distance_from_it() {
        let flat: Vec<[f64; 3]> =
            (0..40).map(|k| [f64::from(k % 8), f64::from(k / 8), 0.5 * f64::from(k % 8) + 3.0]).collect();
        assert!(plane_distance_m(&flat) < 1e-9);
        let bent: Vec<[f64; 3]> = flat.iter().map(|&[x, y, h]| [x, y, h + 0.1 * x * x]).collect();
        assert!(plane_distance_m(&bent) > 0.2);
    }
}
