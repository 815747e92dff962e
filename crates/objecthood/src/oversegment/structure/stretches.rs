//! Rows in stretches: a stretch that lies wholly before or behind a surface is decided at once, without its
//! pixels (docs/CONTEXT.md 1.1.2 and 1.1.3).

use crate::raster::Raster;
use crate::simd::vectorized;

/// Pixels of a stretch.
pub(super) const STRETCH: usize = 64;
/// Terms of up to 10^8 quanta are rounded by less than this (quanta).
const ROUNDING_QUANTA: f64 = 1e-6;

/// The least and the greatest disparity (quanta) of each stretch of each row. Infinite, in the wrong order, where nothing is measured.
pub(super) struct Stretches {
    ranges: Vec<[f32; 2]>,
    in_row: usize,
}

impl Stretches {
    /// O(pixels).
    pub(super) fn of(disparity: &Raster<f32>) -> Self {
        let width = disparity.width();
        let rows = disparity.as_slice().chunks(width);
        let ranges = vectorized(
            #[inline(always)]
            || rows.flat_map(|row| row.chunks(STRETCH).map(range)).collect(),
        );
        Self { ranges, in_row: width.div_ceil(STRETCH) }
    }

    /// The stretches of row `v`, each with its first column.
    pub(super) fn of_row(&self, v: usize) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let ranges = &self.ranges[v * self.in_row..(v + 1) * self.in_row];
        (0..).step_by(STRETCH).zip(ranges.iter().map(|range| range.map(f64::from)))
    }
}

/// The least and the greatest measured value, found in lanes side by side.
#[inline(always)]
fn range(values: &[f32]) -> [f32; 2] {
    const LANES: usize = 8;
    let (mut low, mut high) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    // NaN is neither less nor greater.
    let mut add = |k: usize, value: f32| {
        low[k] = if value < low[k] { value } else { low[k] };
        high[k] = if value > high[k] { value } else { high[k] };
    };
    let (lanes, rest) = values.as_chunks::<LANES>();
    lanes.iter().for_each(|values| (0..LANES).for_each(|k| add(k, values[k])));
    rest.iter().enumerate().for_each(|(k, value)| add(k, *value));
    [low.into_iter().fold(f32::INFINITY, f32::min), high.into_iter().fold(f32::NEG_INFINITY, f32::max)]
}

/// Bounds of a polynomial over so many pixels of a row, from column `u` on. `bend`: the size of the factor of its square, or more.
#[inline(always)]
pub(super) fn range_in_row(value: impl Fn(f64) -> f64, bend: f64, u: usize, pixels: usize) -> [f64; 2] {
    let [one, other] = [u, u + pixels - 1].map(|u| value(u as f64));
    // Half way between two places a parabola is farthest from its chord: by its bend times the square of half their distance.
    let half = 0.5 * pixels as f64;
    let off = bend * half * half + ROUNDING_QUANTA;
    [one.min(other) - off, one.max(other) + off]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::raster;

    proptest! {
        #[test]
        fn a_stretch_ranges_from_its_least_to_its_greatest_value(
            disparity in (1_usize..3 * STRETCH, 1_usize..4)
                .prop_flat_map(|size| raster(size, prop_oneof![1 => Just(f32::NAN), 5 => 17.0_f32..3500.0])),
        ) {
            let stretches = Stretches::of(&disparity);
            for (v, row) in disparity.as_slice().chunks(disparity.width()).enumerate() {
                let ranges = stretches.of_row(v);
                for ((u, [low, high]), values) in ranges.zip(row.chunks(STRETCH)) {
                    prop_assert!(std::ptr::eq(&row[u], &values[0]));
                    let measured = || values.iter().copied().filter(|d| !d.is_nan()).map(f64::from);
                    prop_assert_eq!(low, measured().fold(f64::INFINITY, f64::min));
                    prop_assert_eq!(high, measured().fold(f64::NEG_INFINITY, f64::max));
                }
            }
        }

        #[test]
        fn no_value_lies_beyond_its_bounds(
            [c, cx, cxx] in [-3000.0_f64..3000.0, -20.0_f64..20.0, -1.0_f64..1.0],
            u in 0_usize..1000,
            pixels in 1_usize..2 * STRETCH,
        ) {
            let value = |u: f64| c + cx * (u - 320.0) + cxx * (u - 320.0) * (u - 320.0);
            let [low, high] = range_in_row(value, cxx.abs(), u, pixels);
            prop_assert!((u..u + pixels).all(|u| (low..=high).contains(&value(u as f64))));
        }
    }
}
