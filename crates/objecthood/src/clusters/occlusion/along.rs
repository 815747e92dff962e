//! A coordinate frame along the gap between two pieces. Their planes are compared in it.

use glam::DVec3;

use super::spread::{Sample, Spread, Turned};
use super::surface::{RIDGE, Surface};
use crate::linear::{length, solve};
use crate::surface::disparity::DisparitySpace;

/// Least distance of two centroids in the image (px): nearer, the direction of the gap is undefined.
const LEAST_APART_PX: f64 = 3.0;
/// Margin (degrees) for the rounding between the quick fit from the spread and the fit to all samples. In images 2000 px wide the
/// normals of the two fits differ by less than a twentieth of it, even for facets one pixel wide (see the tests).
pub(super) const ROUNDING_DEG: f64 = 0.01;

/// A frame along the gap between two pieces: S from one centroid to the other, T across, in units of their distance.
#[derive(Clone, Copy)]
pub(super) struct Along {
    middle: [f64; 2],
    /// Gradient of S in the image (1/px).
    axis: [f64; 2],
    /// Disparity (quanta) from which disparities are counted.
    origin: f64,
}

impl Along {
    /// The frame from one centroid to another, with disparities counted from `origin`; `None` when they are too near for a direction.
    pub(super) fn between([from, to]: [[f64; 2]; 2], origin: f64) -> Option<Self> {
        let apart = [0, 1].map(|k| to[k] - from[k]);
        let length_px = length(apart);
        (length_px >= LEAST_APART_PX).then(|| Self {
            middle: [0, 1].map(|k| (from[k] + to[k]) / 2.0),
            axis: apart.map(|x| x / (length_px * length_px)),
            origin,
        })
    }

    #[inline(always)]
    fn coordinates(&self, at: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|k| at[k] - self.middle[k]);
        let [along, across] = self.axis;
        [x * along + y * across, y * along - x * across]
    }

    /// Disparity (quanta) at a pixel of a surface given in this frame.
    #[inline(always)]
    pub(super) fn disparity(&self, surface: &Surface<4>, at: [f64; 2]) -> f64 {
        self.origin + surface.value(self.coordinates(at))
    }

    /// Transforms samples to this frame.
    pub(super) fn take(&self, samples: &[Sample]) -> Vec<Sample> {
        samples.iter().map(|&(at, d)| (self.coordinates(at), d - self.origin)).collect()
    }

    /// The plane through samples with this spread, equal to [`Surface::fit`] of all samples except for rounding. O(1).
    pub(super) fn plane(&self, spread: &Spread) -> Surface<3> {
        let Turned { mean: [s, t, d], products: [ss, st, tt, sd, td] } =
            spread.turned(self.middle, self.axis, self.origin);
        let matrix = [[1.0 + RIDGE, s, t], [s, ss + RIDGE, st], [t, st, tt + RIDGE]];
        Surface { weights: solve(matrix, [d, sd, td]) }
    }

    /// Slope of a plane in the image (quanta/px).
    pub(super) fn slope(&self, plane: &Surface<3>) -> [f64; 2] {
        let ([_, s, t], [along, across]) = (plane.weights, self.axis);
        [s * along - t * across, s * across + t * along]
    }

    /// Normal of a plane at the middle of the gap.
    pub(super) fn normal(&self, plane: &Surface<3>, space: &DisparitySpace) -> DVec3 {
        space.normal(self.middle, self.origin + plane.weights[0], self.slope(plane)).into()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::pieces::{LEAST_FACET_PX, SAMPLES};
    use super::*;
    use crate::testing::space;

    proptest! {
        #[test]
        fn the_plane_by_spread_is_that_of_all_samples(
            samples in prop::collection::vec((prop::array::uniform2(0.0_f64..640.0), 100.0_f64..900.0), 3..40),
            axis in prop::array::uniform2(-0.1_f64..0.1),
            middle in prop::array::uniform2(0.0_f64..640.0),
        ) {
            let along = Along { middle, axis, origin: samples[0].1 };
            let expected = Surface::<3>::fit(along.take(&samples).iter());
            let got = along.plane(&Spread::of(&samples));
            for at in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
                let (got, expected) = (got.value(at), expected.value(at));
                prop_assert!((got - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{} {}", got, expected);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        /// Also for facets whose direction is hardly determined: one pixel wide, and as near to each other as allowed.
        #[test]
        fn normals_by_spread_differ_by_rounding(
            [from, to] in prop::array::uniform2(prop::array::uniform2(0_u16..2000)),
            (value, slope) in (100.0_f64..1000.0, prop::array::uniform2(-0.5_f64..0.5)),
            noise in prop::collection::vec(-1.0_f64..1.0, SAMPLES),
            (turn, length_px) in (0.0_f64..6.3, prop_oneof![Just(LEAST_APART_PX), LEAST_APART_PX..2000.0]),
        ) {
            let longer = [0, 1].map(|k| from[k].abs_diff(to[k])).into_iter().max().unwrap();
            prop_assume!(usize::from(longer) >= LEAST_FACET_PX - 1);
            let sample = |(q, noise): (usize, &f64)| {
                let share = q as f64 / (SAMPLES - 1) as f64;
                let at = [0, 1].map(|k| f64::from(from[k]) * (1.0 - share) + f64::from(to[k]) * share).map(f64::round);
                let off = [0, 1].map(|k| at[k] - f64::from(from[k]));
                (at, f64::from((value + slope[0] * off[0] + slope[1] * off[1] + noise) as f32))
            };
            let samples: Vec<Sample> = noise.iter().enumerate().map(sample).collect();
            let centroid = samples.iter().fold([0.0; 2], |sum, (at, _)| [0, 1].map(|k| sum[k] + at[k] / SAMPLES as f64));
            let other = [centroid[0] + length_px * libm::cos(turn), centroid[1] + length_px * libm::sin(turn)];
            let Some(along) = Along::between([centroid, other], samples[0].1) else { return Ok(()) };
            let space = space([1640.0; 2], [999.5; 2]);
            let by_spread = along.normal(&along.plane(&Spread::of(&samples)), &space);
            let by_samples = along.normal(&Surface::<3>::fit(along.take(&samples).iter()), &space);
            // Both normals of a pair may have an error.
            let apart_deg = (by_spread - by_samples).length().to_degrees();
            prop_assert!(apart_deg < ROUNDING_DEG / 20.0, "{} degrees", apart_deg);
        }
    }
}
