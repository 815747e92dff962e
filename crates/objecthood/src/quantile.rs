//! Quantiles of lists of numbers.

use glam::DVec3;

/// The value below which this share of the values lies; 0 without values. Reorders the values. O(n).
pub(crate) fn element_at(values: &mut [f64], share: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let place = ((share * values.len() as f64) as usize).min(last);
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Where values begin and end, but for outliers: two of their quantiles. Reorders the values. O(n).
pub(crate) fn range(values: &mut [f64], quantiles: [f64; 2]) -> [f64; 2] {
    quantiles.map(|share| element_at(values, share))
}

/// The same of the places of points (m) along a direction. O(n).
pub(crate) fn reach_m(
    points: impl IntoIterator<Item = DVec3>,
    direction: DVec3,
    quantiles: [f64; 2],
) -> [f64; 2] {
    range(&mut points.into_iter().map(|point| direction.dot(point)).collect::<Vec<f64>>(), quantiles)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn an_element_is_that_of_the_sorted_values(
            mut values in prop::collection::vec(-5.0_f64..5.0, 0..30),
            share in 0.0_f64..=1.0,
        ) {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let place = (share * sorted.len() as f64).floor() as usize;
            let expected = sorted.get(place).or(sorted.last()).copied().unwrap_or(0.0);
            prop_assert_eq!(element_at(&mut values, share), expected);
        }
    }
}
