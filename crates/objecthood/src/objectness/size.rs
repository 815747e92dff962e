//! Size: how graspable an oriented box is (PARITY.md 6).

use crate::camera::Camera;
use crate::discovery::object::OrientedBox;
use crate::params;
use crate::surface::disparity::DisparitySpace;

/// A thing that lies alone may be as thin as the window of a plane fit (px at 525 px): on a narrower one, no
/// pixel has a slope of its own.
const WINDOW_PX: usize = 7;
/// Such a thing is longer than this many windows: a wave of noise on a table is shorter.
const LONG_WINDOWS: f32 = 4.0;
/// Nothing graspable is thinner in two directions than a thin pen (m).
const LEAST_SIDE_M: f32 = 0.008;
/// The top of a graspable thing is at most this high above the plane that it stands on out of sight (m);
/// people and cupboards are higher.
const HIGHEST_M: f32 = 2.0;
/// Where a sensor smears edges, its waves are up to 40 px long (at 525 px). A thing of this area (px) is surely more than one of them ...
const RESOLVED_PX: usize = 1600;
/// ... and one that is this many octaves smaller (the smallest hypothesis) may be a wave, ...
const WAVE_OCTAVES: f32 = 3.0;
/// ... which lowers the rating by this share.
const WAVE_DOUBT: f32 = 0.35;

/// The longest side of the box (m).
pub fn longest_side_m(box_m: &OrientedBox) -> f32 {
    box_m.sides_m()[2]
}

/// Rates how well a thing with this box can be grasped and moved, in [0, 1] (ours, because the hard limits of
/// the paper leave no doubt to weigh, and because a thing that is thin in two directions is a sliver of
/// another, however long it is).
///
/// The longest side has the upper limit `max_side_m`, the second-longest the limits `min_second_side_m` and `max_second_side_m`. Limits
/// are soft: the rating is 1/2 at the limit, 1 an octave inside, 0 an octave outside, and linear in the logarithm between. A thing may
/// be larger than its visible part, so the lower limit counts by the share of the outline that is its own (`visibility`). A single
/// point has no size: 0.
pub(crate) fn rate_size(
    box_m: &OrientedBox,
    least_second_m: f32,
    visibility: f32,
    params: &params::Objectness,
) -> f32 {
    let [_, second_m, longest_m] = box_m.sides_m();
    if longest_m == 0.0 {
        return 0.0;
    }
    let thin = 1.0 - within(least_second_m / second_m);
    (1.0 - visibility * thin).min(within_largest(box_m, params))
}

/// The rating of a box by the upper limits alone.
fn within_largest(box_m: &OrientedBox, params: &params::Objectness) -> f32 {
    let [_, second_m, longest_m] = box_m.sides_m();
    within(longest_m / params.max_side_m).min(within(second_m / params.max_second_side_m))
}

/// The least second-longest side (m) of a thing that lies alone in this box. If the thing is long, it is what
/// the sensor resolves at its depth, but at most `min_second_side_m` and at least what anything graspable
/// has.
pub(crate) fn resolved_side_m(
    box_m: &OrientedBox,
    space: &DisparitySpace,
    params: &params::Objectness,
) -> f32 {
    let Camera { fx_px, fy_px, .. } = space.camera();
    let window_px = space.length_px(WINDOW_PX) as f32;
    let resolved_m = window_px * box_m.center_m[2] / (fx_px * fy_px).sqrt() as f32;
    match longest_side_m(box_m) > LONG_WINDOWS * resolved_m {
        true => resolved_m.max(LEAST_SIDE_M).min(params.min_second_side_m),
        false => params.min_second_side_m,
    }
}

/// The rating of a length in multiples of its upper limit: 1/2 at the limit, 1 an octave below, 0 an octave above, linear in the logarithm
/// between.
fn within(excess: f32) -> f32 {
    0.5 - 0.5 * libm::log2f(excess).clamp(-1.0, 1.0)
}

/// Rates the size of a thing whose foot is hidden, as if it reached down to the surface that carries it, by
/// the upper limits of [`rate_size`]. `rise_m`: the height of its top above that surface. `cut`: the share of
/// the thing that goes on behind the edge of another surface or of the image; the doubt is weighted by it.
///
/// Source: ours, because trunks and chairs behind a table come in pieces of a graspable size, but stand on
/// the floor.
pub(crate) fn rate_rise(box_m: &OrientedBox, rise_m: f32, cut: f32, params: &params::Objectness) -> f32 {
    let [width_m, depth_m, height_m] = box_m.extents_m;
    let whole = OrientedBox { extents_m: [width_m, depth_m, height_m.max(rise_m)], ..*box_m };
    1.0 - cut * (1.0 - within_largest(&whole, params))
}

/// Rates the height of a thing with a hidden foot above the plane that carries it, whether it is cut or not:
/// 1 up to 2 m, 0 from 4 m on, linear in the logarithm between.
///
/// Source: ours, because things that hang from a ceiling or a wall are higher above the floor than any
/// graspable thing that stands on it.
pub(crate) fn rate_height(rise_m: f32) -> f32 {
    1.0 - libm::log2f((rise_m / HIGHEST_M).max(1.0)).min(1.0)
}

/// Rates whether a thing is larger in the image than the waves of a sensor that smears edges (docs/CONTEXT.md
/// 6.1): from 0.65 for a thing as small as the smallest hypothesis to 1 from 40 x 40 px on, linear in the
/// logarithm. The contrast of the thing (6.4) reduces this doubt.
///
/// Source: ours, because such a sensor makes crumbs of this size from tables, floors and edges. Their size in
/// metres depends on their distance, but they have the colour of the surface that they are a piece of.
pub(crate) fn rate_resolution(size_px: usize, contrast: f32, space: &DisparitySpace) -> f32 {
    let octaves = libm::log2f(space.area_px(RESOLVED_PX) as f32 / size_px as f32);
    1.0 - (1.0 - contrast) * WAVE_DOUBT * (octaves / WAVE_OCTAVES).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oriented_box::fit_oriented_box;
    use crate::testing::space;

    #[test]
    fn limits_of_size_are_soft_and_what_is_hidden_may_be_larger() {
        let params = params::Objectness::default();
        let (min_m, max_m) = (params.min_second_side_m, params.max_side_m);
        let part = |extents_m, visibility| {
            let of_origin = fit_oriented_box(&[], [0.0, -1.0, 0.0]);
            rate_size(&OrientedBox { extents_m, ..of_origin }, params.min_second_side_m, visibility, &params)
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

    #[test]
    fn how_thin_a_thing_may_be_follows_what_the_sensor_resolves() {
        let params = params::Objectness::default();
        let of_origin = fit_oriented_box(&[], [0.0, -1.0, 0.0]);
        let pen = OrientedBox { extents_m: [0.14, 0.012, 0.009], ..of_origin };
        let at = |focal_px: f64, z_m: f32| {
            let box_m = OrientedBox { center_m: [0.0, 0.0, z_m], ..pen };
            resolved_side_m(&box_m, &space([focal_px; 2], [319.5, 239.5]), &params)
        };
        assert_eq!([at(525.0, 0.3), at(525.0, 3.0)], [0.008, 0.02]);
        assert!([525.0, 1050.0].iter().all(|&focal_px| (at(focal_px, 1.0) - 7.0 / 525.0).abs() < 1e-6));
        let rated = |z_m| rate_size(&pen, at(525.0, z_m), 1.0, &params);
        assert!(rated(0.6) > 0.7 && rated(2.0) < 0.2, "{} {}", rated(0.6), rated(2.0));
        // A wave of noise.
        let speck = OrientedBox { extents_m: [0.045, 0.014, 0.01], center_m: [0.0, 0.0, 1.0], ..of_origin };
        assert_eq!(resolved_side_m(&speck, &space([525.0; 2], [319.5, 239.5]), &params), 0.02);
    }

    #[test]
    fn what_hangs_high_above_its_support_is_no_thing() {
        assert_eq!([0.1, 2.0, 4.0, 9.0].map(rate_height), [1.0, 1.0, 0.0, 0.0]);
        assert!((rate_height(8.0_f32.sqrt()) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn what_stands_far_below_is_as_large_as_it_is_high() {
        let params = params::Objectness::default();
        let limit_m = params.max_side_m;
        let of_origin = fit_oriented_box(&[], [0.0, -1.0, 0.0]);
        let rated_as =
            |extents_m, rise_m, cut| rate_rise(&OrientedBox { extents_m, ..of_origin }, rise_m, cut, &params);
        let rated = |rise_m, cut| rated_as([0.05, 0.05, 0.1], rise_m, cut);
        assert_eq!(
            [rated(limit_m / 2.0, 1.0), rated(limit_m, 1.0), rated(2.0 * limit_m, 1.0)],
            [1.0, 0.5, 0.0]
        );
        assert_eq!([rated(2.0 * limit_m, 0.25), rated(2.0 * limit_m, 0.0)], [0.75, 1.0]);
        // The seat of a chair, of which a strip is seen: a box as high as it is wide is furniture, a bottle of this height is not.
        let (seat, bottle) = (rated_as([0.4, 0.1, 0.02], 0.45, 1.0), rated_as([0.08, 0.08, 0.3], 0.45, 1.0));
        assert!(seat < 0.45 && bottle > 0.7, "{seat} {bottle}");
    }

    #[test]
    fn a_crumb_may_be_a_wave_and_what_is_larger_than_waves_is_not() {
        for focal_px in [525.0, 1050.0] {
            let space = space([focal_px; 2], [319.5, 239.5]);
            let rated =
                [100, 200, 800, 1600, 20_000].map(|px| rate_resolution(space.area_px(px), 0.0, &space));
            for (rated, expected) in rated.into_iter().zip([0.65, 0.65, 1.0 - 0.35 / 3.0, 1.0, 1.0]) {
                assert!((rated - expected).abs() < 1e-3, "{focal_px}: {rated} instead of {expected}");
            }
            let contrasts = [0.0, 0.5, 1.0].map(|contrast| rate_resolution(200, contrast, &space));
            assert!(contrasts.is_sorted() && contrasts[2] == 1.0, "{contrasts:?}");
        }
    }
}
