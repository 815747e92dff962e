//! The values of a number that are tried: in growing steps to the ends of its range, then round ones between two of them.

use crate::explain::guess::{last_digit, round};

/// Factors of the steps from the present value.
const FACTORS: [f64; 4] = [1.3, 2.0, 4.0, 10.0];
/// The steps from 0, as shares of the way to the limit.
const SHARES: [f64; 4] = [0.01, 0.05, 0.2, 0.5];
/// Part of an interval, around its middle, from which a round value is taken.
const MIDDLE: f64 = 0.5;

/// The values below and above `from`, each from the nearest to the end of the range.
pub(super) fn ladders(from: f64, (least, greatest): (f64, f64), whole: bool) -> [Vec<f64>; 2] {
    [least, greatest].map(|limit| ladder(from, limit, whole))
}

/// The values on the way to one end of the range.
fn ladder(from: f64, limit: f64, whole: bool) -> Vec<f64> {
    let sign = (limit - from).signum();
    // Towards 0 the steps have these factors too; a range that goes on behind 0 is crossed as the other side is.
    let shrinks = sign * from < 0.0 && limit * from >= 0.0;
    let step = |k: usize| {
        if from == 0.0 {
            limit * SHARES[k]
        } else if shrinks {
            from / FACTORS[k]
        } else {
            from + sign * from.abs() * (FACTORS[k] - 1.0)
        }
    };
    let rounded = |value: f64| {
        let digit = if whole { 1.0 } else { last_digit(value) };
        round((value / digit).round() * digit)
    };
    let mut values: Vec<f64> = Vec::new();
    for value in (0..FACTORS.len()).map(step).map(rounded).chain([limit]) {
        let last = values.last().copied().unwrap_or(from);
        if sign * value > sign * last && sign * value <= sign * limit {
            values.push(value);
        }
    }
    values
}

/// The roundest value about the middle of two; `None` when no whole number lies between.
pub(super) fn between(a: f64, b: f64, whole: bool) -> Option<f64> {
    let (low, high) = (a.min(b), a.max(b));
    let span = high - low;
    if span <= 0.0 || whole && span < 2.0 {
        return None;
    }
    let middle = (low + high) / 2.0;
    let coarse = 10_f64.powi(libm::log10(span).floor() as i32);
    // The last unit always fits.
    let units = [coarse, coarse / 2.0, coarse / 10.0];
    let units = units.map(|unit| if whole { unit.round().max(1.0) } else { unit });
    // Nothing is -0.
    let near = |unit: f64| round((middle / unit).round() * unit) + 0.0;
    units.map(near).into_iter().find(|value| (value - middle).abs() <= MIDDLE / 2.0 * span)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_to_both_ends_in_growing_steps() {
        for (from, limits, whole) in [
            (12.0, (-180.0, 180.0), false),
            (0.0, (-90.0, 90.0), false),
            (2.5, (0.0, 1000.0), false),
            (0.95, (0.0, 1.0), false),
            (3.0, (1.0, 50.0), true),
            (1e-9, (0.0, 1e6), false),
        ] {
            let sides = ladders(from, limits, whole);
            for (side, (sign, limit)) in sides.iter().zip([(-1.0, limits.0), (1.0, limits.1)]) {
                assert_eq!(side.last(), Some(&limit));
                let all: Vec<f64> = std::iter::once(from).chain(side.iter().copied()).collect();
                assert!(all.windows(2).all(|pair| sign * (pair[1] - pair[0]) > 0.0), "{all:?}");
                assert!(!whole || side.iter().all(|value| value.fract() == 0.0));
            }
        }
        assert_eq!(
            ladders(0.2, (0.0, 1.0), false),
            [vec![0.154, 0.1, 0.05, 0.02, 0.0], vec![0.26, 0.4, 0.8, 1.0]]
        );
        assert_eq!(ladders(1.0, (1.0, 1.0), false), [vec![], vec![]], "it is at its only value");
    }

    #[test]
    fn what_lies_between_is_round() {
        assert_eq!(between(0.32, 0.5, false), Some(0.4));
        assert_eq!(between(0.5, 0.4, false), Some(0.45));
        assert_eq!(between(1000.0, 25.0, false), Some(500.0));
        assert_eq!(between(-6.0, 4.8, false), Some(0.0));
        assert_eq!(between(3.0, 4.0, true), None);
        assert_eq!(between(3.0, 5.0, true), Some(4.0));
        assert_eq!(between(3.0, 6.0, true), Some(5.0));
        assert_eq!(between(2.0, 2.0, false), None);
    }
}
