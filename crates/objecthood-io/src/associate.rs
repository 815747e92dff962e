//! Which colour image belongs to which depth image, by their times.
//!
//! Source: `associate.py` of the TUM RGB-D benchmark.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Joins two ascending lists of times: the two that are nearest to each other are a pair, then the nearest two of the
/// rest, and so on up to `max_apart_us`. Every time is in one pair at most.
///
/// Returns the indices of each pair, in the order of the first list. O(n log n): the two that are nearest are
/// neighbours when both lists are merged, and when they are taken out their neighbours become neighbours.
pub(crate) fn associate(first: &[i64], second: &[i64], max_apart_us: i64) -> Vec<(usize, usize)> {
    let of = |list: bool, times: &[i64]| -> Vec<(i64, bool, usize)> {
        times.iter().enumerate().map(|(k, &time)| (time, list, k)).collect()
    };
    let mut merged = of(false, first);
    merged.extend(of(true, second));
    merged.sort_unstable();

    let end = merged.len();
    let mut before: Vec<usize> = (0..end).map(|m| m.wrapping_sub(1)).collect();
    let mut after: Vec<usize> = (1..=end).collect();
    let mut taken = vec![false; end];
    // Neighbours of different lists that are near enough, the nearest on top.
    let mut candidates = BinaryHeap::new();
    let consider = |candidates: &mut BinaryHeap<_>, a: usize, b: usize| {
        let (Some(left), Some(right)) = (merged.get(a), merged.get(b)) else { return };
        let apart = right.0.saturating_sub(left.0);
        if left.1 != right.1 && apart <= max_apart_us {
            candidates.push(Reverse((apart, a, b)));
        }
    };
    (1..end).for_each(|m| consider(&mut candidates, m - 1, m));

    let mut pairs = Vec::new();
    while let Some(Reverse((_, a, b))) = candidates.pop() {
        if taken[a] || taken[b] {
            continue;
        }
        (taken[a], taken[b]) = (true, true);
        let (one, other) = (merged[a], merged[b]);
        pairs.push(if one.1 { (other.2, one.2) } else { (one.2, other.2) });
        let (left, right) = (before[a], after[b]);
        if let Some(after) = after.get_mut(left) {
            *after = right;
        }
        if let Some(before) = before.get_mut(right) {
            *before = left;
        }
        consider(&mut candidates, left, right);
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// As `associate.py` does it: all pairs that are near enough, sorted, each taken if both are free.
    fn naive(first: &[i64], second: &[i64], max_apart_us: i64) -> Vec<(usize, usize)> {
        let mut all: Vec<(i64, usize, usize)> = Vec::new();
        for (a, x) in first.iter().enumerate() {
            for (b, y) in second.iter().enumerate() {
                all.push(((x - y).abs(), a, b));
            }
        }
        all.sort_unstable();
        let (mut used_a, mut used_b) = (vec![false; first.len()], vec![false; second.len()]);
        let mut pairs = Vec::new();
        for (apart, a, b) in all {
            if apart <= max_apart_us && !used_a[a] && !used_b[b] {
                (used_a[a], used_b[b]) = (true, true);
                pairs.push((a, b));
            }
        }
        pairs.sort_unstable();
        pairs
    }

    proptest! {
        /// Where all distances differ, as they do among times as random as these, there is one answer.
        #[test]
        fn it_is_the_greedy_association(
            mut first in prop::collection::vec(0_i64..1_000_000_000_000, 0..40),
            mut second in prop::collection::vec(0_i64..1_000_000_000_000, 0..40),
            max_apart in 0_i64..100_000_000_000,
        ) {
            first.sort_unstable();
            second.sort_unstable();
            prop_assert_eq!(associate(&first, &second, max_apart), naive(&first, &second, max_apart));
        }

        #[test]
        fn no_time_is_used_twice(
            mut first in prop::collection::vec(0_i64..50, 0..40),
            mut second in prop::collection::vec(0_i64..50, 0..40),
        ) {
            first.sort_unstable();
            second.sort_unstable();
            let pairs = associate(&first, &second, 3);
            for (k, &(a, b)) in pairs.iter().enumerate() {
                prop_assert!((first[a] - second[b]).abs() <= 3);
                prop_assert!(pairs[..k].iter().all(|other| other.0 != a && other.1 != b));
            }
            prop_assert_eq!(pairs.is_empty(), naive(&first, &second, 3).is_empty());
        }
    }

    #[test]
    fn times_at_the_limit() {
        assert_eq!(associate(&[0, 100_000], &[20_000, 79_999], 20_000), [(0, 0)]);
        assert_eq!(associate(&[0, 30], &[20, 35], 100), [(0, 0), (1, 1)]);
        assert_eq!(associate(&[i64::MIN], &[i64::MAX], 100), []);
    }

    #[test]
    fn many_equal_times_take_no_quadratic_time() {
        let times = vec![7; 200_000];
        assert_eq!(associate(&times, &times, 20_000).len(), times.len());
    }
}
