//! Size: how graspable an oriented box is (PARITY.md 6).

use crate::discovery::object::OrientedBox;
use crate::params;

/// The longest side of the box (m).
pub fn longest_side_m(box_m: &OrientedBox) -> f32 {
    sorted(box_m)[2]
}

/// The sides of the box (m), the shortest first.
fn sorted(box_m: &OrientedBox) -> [f32; 3] {
    let mut sides_m = box_m.extents_m;
    sides_m.sort_by(f32::total_cmp);
    sides_m
}

/// Rates how well a thing with this box can be grasped and moved, in [0, 1] (ours, because the hard limits of the paper leave no
/// doubt to weigh, and a thing that is thin in two directions is a sliver of another, however long).
///
/// The longest side has the upper limit `max_side_m`, the second-longest the limits `min_second_side_m` and `max_second_side_m`. Limits
/// are soft: the rating is 1/2 at the limit, 1 an octave inside, 0 an octave outside, and linear in the logarithm between. A thing may
/// be larger than its visible part, so the lower limit counts by the share of the outline that is its own (`visibility`). A single
/// point has no size: 0.
pub(crate) fn rate_size(box_m: &OrientedBox, visibility: f32, params: &params::Objectness) -> f32 {
    let [_, second_m, longest_m] = sorted(box_m);
    if longest_m == 0.0 {
        return 0.0;
    }
    let within = |excess: f32| 0.5 - 0.5 * libm::log2f(excess).clamp(-1.0, 1.0);
    let thin = 1.0 - within(params.min_second_side_m / second_m);
    let within_largest =
        within(longest_m / params.max_side_m).min(within(second_m / params.max_second_side_m));
    (1.0 - visibility * thin).min(within_largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oriented_box::fit_oriented_box;

    #[test]
    fn limits_of_size_are_soft_and_what_is_hidden_may_be_larger() {
        let params = params::Objectness::default();
        let (min_m, max_m) = (params.min_second_side_m, params.max_side_m);
        let part = |extents_m, visibility| {
            let of_origin = fit_oriented_box(&[], [0.0, -1.0, 0.0]);
            rate_size(&OrientedBox { extents_m, ..of_origin }, visibility, &params)
        };
        let expected = [
            ([0.0, 0.0, 0.0], 1.0, 0.0),
            // With any visibility. A regression: a cloud of one point was an object.
            ([0.0, 0.0, 0.0], 0.0, 0.0),
            ([0.0, min_m / 2.0, 0.1], 1.0, 0.0),
            ([min_m, 0.1, 0.0], 1.0, 0.5),
            ([0.0, 2.0 * min_m, 0.2], 1.0, 1.0),
            ([0.0, 0.0, 0.1], 0.25, 0.75),
            ([0.1, max_m / 2.0, 0.1], 1.0, 1.0),
            ([0.1, max_m, 0.1], 1.0, 0.5),
            ([0.1, 0.1, 2.0 * max_m], 0.0, 0.0),
            ([0.0, min_m, max_m], 1.0, 0.5),
        ];
        for (extents_m, visibility, expected) in expected {
            let got = part(extents_m, visibility);
            assert!((got - expected).abs() < 1e-6, "{extents_m:?}, {visibility}: {got}");
        }
    }
}
