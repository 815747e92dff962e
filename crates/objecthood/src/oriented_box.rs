//! Oriented boxes around points, with one axis along up (PARITY.md 6).

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::discovery::object::OrientedBox;
use crate::linear::principal_angle;
use crate::simd::vectorized;

/// Share of the points beyond each face of the box, because sensors have outliers.
const OUTLIERS: f64 = 0.01;
/// One point in this many is sampled for a first estimate of the percentiles: a prime, which does not fall into step with image rows.
const SAMPLE_STEP: usize = 61;
/// Points whose places along an axis are computed in one vectorised loop.
const SIDE_BY_SIDE: usize = 64;

/// Fits a box to `points_m`: z along `up`, x and y along the principal axes of the horizontal coordinates, each side from the 1st to
/// the 99th percentile. Without points it has no size.
///
/// The axes form a right-handed frame. x is the principal axis of greatest variance. It points towards positive camera x (or y, or z,
/// if it has no component along x), so that the same points give the same box. O(n).
pub fn fit_oriented_box(points_m: &[[f32; 3]], up: [f32; 3]) -> OrientedBox {
    let up = Vec3::from(up).as_dvec3();
    let (east, north) = up.any_orthonormal_pair();
    let points = || points_m.iter().map(|&p| Vec3::from(p).as_dvec3());

    let mean = points().sum::<DVec3>() / points_m.len().max(1) as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for p in points() {
        let (x, y) = ((p - mean).dot(east), (p - mean).dot(north));
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    let angle = principal_angle([xx, xy, yy]);
    let axis = east * libm::cos(angle) + north * libm::sin(angle);
    let leading = axis.to_array().into_iter().find(|part| part.abs() > 1e-6);
    let x = if leading.is_some_and(|part| part < 0.0) { -axis } else { axis };
    let axes = [x, up.cross(x), up];

    let mut center = DVec3::ZERO;
    let mut extents_m = [0.0; 3];
    for (axis, extent) in axes.into_iter().zip(&mut extents_m) {
        let [low, high] = limits_m(points_m, axis);
        center += axis * ((low + high) / 2.0);
        *extent = (high - low) as f32;
    }
    let rotation = DQuat::from_mat3(&DMat3::from_cols(axes[0], axes[1], axes[2]));
    OrientedBox {
        center_m: center.as_vec3().to_array(),
        rotation_xyzw: rotation.as_quat().to_array(),
        extents_m,
    }
}

/// The places along `axis` (m) below and above which a share of [`OUTLIERS`] of the points lies, interpolated linearly; 0 without
/// points.
///
/// A sample gives bounds for both tails, and only the points in the tails are ranked (after Floyd and Rivest 1975). If a tail is too
/// short, all points are ranked. O(n).
fn limits_m(points_m: &[[f32; 3]], axis: DVec3) -> [f64; 2] {
    let count = points_m.len();
    let sample = points_m.iter().step_by(SAMPLE_STEP).map(|p| along_m(p, axis));
    let mut sample: Vec<f64> = sample.collect();
    let place = |share: f64, count: usize| share * count.saturating_sub(1) as f64;
    let most = [2.0 * OUTLIERS, 1.0 - 2.0 * OUTLIERS].map(|share| {
        let place = place(share, sample.len());
        ranked(&mut sample, place)
    });
    let [low, high] = [OUTLIERS, 1.0 - OUTLIERS].map(|share| place(share, count));
    let mut tails = tails_m(points_m, axis, most);
    let is_long_enough =
        (low as usize + 2).min(count) <= tails[0].len() && count <= high as usize + tails[1].len();
    if !is_long_enough {
        tails = tails_m(points_m, axis, [f64::INFINITY, f64::NEG_INFINITY]);
    }
    let [below, above] = &mut tails;
    let before = (count - above.len()) as f64;
    [ranked(below, low), ranked(above, high - before)]
}

/// The places of points along `axis` (m), in two lists: up to `low`, and from `high` on.
fn tails_m(points_m: &[[f32; 3]], axis: DVec3, [low, high]: [f64; 2]) -> [Vec<f64>; 2] {
    // Mostly enough, so that they hardly ever grow.
    let mut tails = [(); 2].map(|()| Vec::with_capacity(points_m.len().div_ceil(16)));
    for points in points_m.chunks(SIDE_BY_SIDE) {
        let mut along = [0.0; SIDE_BY_SIDE];
        let along = &mut along[..points.len()];
        let is_any = vectorized(
            #[inline(always)]
            || {
                along.iter_mut().zip(points).for_each(|(along, p)| *along = along_m(p, axis));
                along.iter().fold(false, |any, x| any | (*x <= low) | (*x >= high))
            },
        );
        if is_any {
            tails[0].extend(along.iter().filter(|x| **x <= low));
            tails[1].extend(along.iter().filter(|x| **x >= high));
        }
    }
    tails
}

#[inline(always)]
fn along_m(point_m: &[f32; 3], axis: DVec3) -> f64 {
    Vec3::from(*point_m).as_dvec3().dot(axis)
}

/// The value at a place in ascending order, counted from 0 and interpolated linearly; 0 without values. Reorders the values. O(n).
fn ranked(values: &mut [f64], place: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let (_, &mut low, above) = values.select_nth_unstable_by(place as usize, f64::total_cmp);
    let high = above.iter().copied().min_by(f64::total_cmp).unwrap_or(low);
    low + (high - low) * place.fract()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A box filled evenly and turned about up: the fit finds its centre, sides and axes.
        #[test]
        fn a_filled_box_is_found_again(
            angle in 0.0_f64..3.0, tilt in -0.7_f64..0.7,
            center in prop::array::uniform3(-1.0_f64..1.0),
        ) {
            let sides = [0.3, 0.1, 0.2];
            let rotation = DQuat::from_rotation_x(tilt) * DQuat::from_rotation_z(angle);
            let mut points = Vec::new();
            for i in 0..=20 {
                for j in 0..=20 {
                    for k in 0..=20 {
                        let share = DVec3::new(f64::from(i), f64::from(j), f64::from(k)) / 20.0 - 0.5;
                        let p = rotation * (share * DVec3::from(sides)) + DVec3::from(center);
                        points.push(p.as_vec3().to_array());
                    }
                }
            }
            let up = rotation * DVec3::Z;
            let found = fit_oriented_box(&points, up.as_vec3().to_array());
            for (got, side) in found.extents_m.iter().zip(sides) {
                prop_assert!((f64::from(*got) - side).abs() < 1e-4, "{:?}", found);
            }
            prop_assert!(Vec3::from(found.center_m).as_dvec3().distance(DVec3::from(center)) < 1e-4);
            let axes = glam::Quat::from_array(found.rotation_xyzw).as_dquat();
            prop_assert!((axes * DVec3::Z).dot(up) > 0.9999);
            prop_assert!((axes * DVec3::X).dot(rotation * DVec3::X).abs() > 0.9999);
        }
    }

    #[test]
    fn outliers_do_not_stretch_the_box_and_no_point_is_no_box() {
        let mut points: Vec<[f32; 3]> = (0..1000).map(|i| [i as f32 / 1000.0, 0.0, 1.0]).collect();
        points.push([50.0, 0.0, 1.0]);
        let found = fit_oriented_box(&points, [0.0, -1.0, 0.0]);
        assert!((found.extents_m[0] - 0.98).abs() < 0.01, "{found:?}");
        assert_eq!(fit_oriented_box(&[], [0.0, -1.0, 0.0]).extents_m, [0.0; 3]);
    }

    /// The reference: from all values in ascending order.
    fn naive_limits_m(points_m: &[[f32; 3]], axis: DVec3) -> [f64; 2] {
        let mut along: Vec<f64> = points_m.iter().map(|p| along_m(p, axis)).collect();
        along.sort_by(f64::total_cmp);
        [OUTLIERS, 1.0 - OUTLIERS].map(|share| {
            let place = share * (along.len() - 1) as f64;
            let (low, high) = (along[place as usize], along[(place.ceil()) as usize]);
            low + (high - low) * place.fract()
        })
    }

    proptest! {
        #[test]
        fn limits_are_those_of_sorted_values_whatever_the_sample_says(
            points in prop::collection::vec(prop::array::uniform3(-1.0_f32..1.0), 1..2000),
            axis in prop::array::uniform3(-1.0_f64..1.0),
            // The sampled points are moved by this much.
            moved in prop_oneof![2 => Just(0.0_f32), 1 => -3.0_f32..3.0],
        ) {
            let mut points = points;
            points.iter_mut().step_by(SAMPLE_STEP).for_each(|p| *p = p.map(|x| x + moved));
            let axis = DVec3::from(axis);
            let bits = |limits: [f64; 2]| limits.map(f64::to_bits);
            prop_assert_eq!(bits(limits_m(&points, axis)), bits(naive_limits_m(&points, axis)));
        }
    }

    #[test]
    fn between_places_values_are_interpolated() {
        assert_eq!(ranked(&mut [4.0, 1.0, 3.0, 2.0], 1.5), 2.5);
        assert_eq!(ranked(&mut [4.0, 1.0, 3.0, 2.0], 3.0), 4.0);
        assert_eq!(ranked(&mut [7.0], 0.0), 7.0);
        assert_eq!(limits_m(&[], DVec3::X), [0.0; 2]);
    }

    proptest! {
        #[test]
        fn x_is_the_longer_way_and_points_right(angle in -1.5_f32..1.5, roll in -1.0_f32..1.0) {
            // A board on the ground, twice as long as wide, seen by a tilted camera.
            let rotation = glam::Quat::from_rotation_z(roll) * glam::Quat::from_rotation_y(angle);
            let on_board = |i: usize| Vec3::new((i % 21) as f32 / 10.0 - 1.0, 0.0, (i / 21) as f32 / 20.0 - 0.5);
            let points: Vec<_> = (0..441).map(|i| (rotation * on_board(i) + 3.0 * Vec3::Z).to_array()).collect();
            let found = fit_oriented_box(&points, (rotation * -Vec3::Y).to_array());
            let x = glam::Quat::from_array(found.rotation_xyzw) * Vec3::X;
            prop_assert!(x.distance(rotation * Vec3::X) < 1e-3, "{} {:?}", x, found);
        }
    }

    #[test]
    fn without_camera_x_the_box_points_down() {
        // A slope seen edge-on: up is camera x, and the longer side has no component along it.
        for slope in [1.0, -1.0] {
            let points: Vec<_> =
                (0..100).map(|i| i as f32 / 100.0).map(|y| [0.0, y, slope * y + 2.0]).collect();
            let found = fit_oriented_box(&points, [1.0, 0.0, 0.0]);
            let x = glam::Quat::from_array(found.rotation_xyzw) * Vec3::X;
            assert!(x.distance(Vec3::new(0.0, 1.0, slope).normalize()) < 1e-6, "{x}");
        }
    }
}
