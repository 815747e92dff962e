//! One surface through two pieces.

use super::spread::Sample;
use crate::linear::solve;

/// Added per sample to the diagonal of the normal equations, so that they have a solution.
pub(super) const RIDGE: f64 = 1e-6;
/// A facet is curved when a squared term across the gap lowers its residual by more than this factor, as for a cylinder along the gap.
const CURVED_RATIO: f64 = 1.3;

/// Disparity as a polynomial in the frame along the gap (see [`Along`](super::along::Along)): the first K of the terms 1, S, T, T^2.
#[derive(Clone, Copy)]
pub(super) struct Surface<const K: usize> {
    pub(super) weights: [f64; K],
}

impl<const K: usize> Surface<K> {
    #[inline(always)]
    fn terms([s, t]: [f64; 2]) -> [f64; K] {
        let all = [1.0, s, t, t * t];
        std::array::from_fn(|k| all[k])
    }

    pub(super) fn fit<'a>(samples: impl Iterator<Item = &'a Sample>) -> Self {
        let (mut matrix, mut right, mut n) = ([[0.0; K]; K], [0.0; K], 0.0);
        for &(at, d) in samples {
            let terms = Self::terms(at);
            for r in 0..K {
                for c in 0..=r {
                    matrix[r][c] += terms[r] * terms[c];
                }
                right[r] += terms[r] * d;
            }
            n += 1.0;
        }
        let whole = std::array::from_fn(|r| {
            let ridge = |c| if r == c { RIDGE * n } else { 0.0 };
            std::array::from_fn(|c| matrix[r.max(c)][r.min(c)] + ridge(c))
        });
        Self { weights: solve(whole, right) }
    }

    #[inline(always)]
    pub(super) fn value(&self, at: [f64; 2]) -> f64 {
        Self::terms(at).iter().zip(&self.weights).map(|(term, weight)| term * weight).sum()
    }

    fn mean_squared_error<'a>(&self, samples: impl Iterator<Item = &'a Sample>) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        for &(at, d) in samples {
            let residual = d - self.value(at);
            sum += residual * residual;
            n += 1.0;
        }
        sum / n
    }
}

impl Surface<3> {
    /// The same surface with a squared term of weight 0.
    fn curved(self) -> Surface<4> {
        let [value, along, across] = self.weights;
        Surface { weights: [value, along, across, 0.0] }
    }
}

/// Fits one surface to two pieces. Returns it with the disagreement (quanta): the error that it adds to the errors of one surface for
/// each piece, divided by `noise`, the factor by which the slope raises the noise.
pub(super) fn fit_jointly(
    of_a: &[Sample],
    of_b: &[Sample],
    flat: &[Surface<3>; 2],
    noise: f64,
) -> (Surface<4>, f64) {
    let of = [of_a, of_b];
    let both = || of_a.iter().chain(of_b);
    let flat_error = [0, 1].map(|k| flat[k].mean_squared_error(of[k].iter()));
    let curved_error = |k: usize| {
        let error = Surface::<4>::fit(of[k].iter()).mean_squared_error(of[k].iter());
        (flat_error[k].sqrt() > CURVED_RATIO * error.sqrt()).then_some(error)
    };
    // Both pieces have to be curved. The first one usually is not; then the second is not tried.
    let curved_error = curved_error(0).and_then(|of_a| Some([of_a, curved_error(1)?]));
    let (joint, single) = match curved_error {
        Some(curved_error) => (Surface::<4>::fit(both()), curved_error),
        None => (Surface::<3>::fit(both()).curved(), flat_error),
    };
    let added = joint.mean_squared_error(both()) - (single[0] + single[1]) / 2.0;
    (joint, added.max(0.0).sqrt() / noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A regression: the surface was curved along the gap, where a lying can is straight.
    #[test]
    fn a_curved_surface_is_a_cylinder_along_the_gap() {
        let samples = |bend: fn([f64; 2]) -> f64| -> Vec<([f64; 2], f64)> {
            let grid = (0..100).map(|k| [f64::from(k % 10) / 10.0 - 0.5, f64::from(k / 10) / 10.0 - 0.5]);
            grid.map(|at| (at, 3.0 + 2.0 * at[0] - at[1] + 5.0 * bend(at))).collect()
        };
        let error = |samples: &[([f64; 2], f64)]| {
            Surface::<4>::fit(samples.iter()).mean_squared_error(samples.iter())
        };
        assert!(error(&samples(|[_, t]| t * t)) < 1e-6, "across");
        assert!(error(&samples(|[s, _]| s * s)) > 0.1, "along");
    }
}
