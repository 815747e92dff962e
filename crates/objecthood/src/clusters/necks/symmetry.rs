//! Whether the axis of a slim part is an axis of symmetry of the other, as that of a handle is of the head of a hammer (docs/CONTEXT.md 4.7).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::sampled;
use crate::linear::principal_angle;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// A part is slim when it is so many times as long as wide and as thick.
const SLIMNESS: f64 = 2.5;
/// Lengths reach from the first to the second of these quantiles, ...
const ENDS: [f64; 2] = [0.03, 0.97];
/// ... widths from the first to the second of these: outlines are noisy.
const SIDES: [f64; 2] = [0.05, 0.95];
/// Sine of the greatest slope of an axis, 45 degrees: what is upright carries others in its axis.
const STEEP: f64 = 0.707;
/// The end of the slim part is so near to the other along the axis (m): fattened edges and shadows hide as much.
const GAP_M: [f64; 2] = [-0.015, 0.02];
/// The end is what lies this near (m) to it.
const END_M: f64 = 0.03;
/// The end shares so much of its heights with the other: what lies below or above it is no part of it.
const LEVEL_SHARE: f64 = 0.3;
/// The other is symmetric about the axis to this share.
const SYMMETRY: f64 = 0.7;
/// Both sides of the axis are compared in stripes across it of this width (m), if they hold so many points.
const STRIPE_M: f64 = 0.01;
const LEAST_POINTS: usize = 8;

/// A slim part: a direction with two across it, and where it begins and ends along each (m).
struct Shaft {
    /// Its length runs along the first direction, the second is level.
    directions: [DVec3; 3],
    ranges_m: [[f64; 2]; 3],
}

/// The range of points along a direction (m), between two quantiles.
fn range_m(points: impl Iterator<Item = DVec3>, direction: DVec3, quantiles: [f64; 2]) -> [f64; 2] {
    let mut places: Vec<f64> = points.map(|point| direction.dot(point)).collect();
    quantiles.map(|share| element_at(&mut places, share))
}

impl Shaft {
    /// `None` for points that lie along a steep line.
    fn of(points: &[DVec3], up: DVec3) -> Option<Self> {
        let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let offsets = || points.iter().map(|point| *point - mean);
        let (east, north) = up.any_orthonormal_pair();
        let sum = |a: DVec3, b: DVec3| offsets().map(|offset| a.dot(offset) * b.dot(offset)).sum::<f64>();
        let angle = principal_angle([sum(east, east), sum(east, north), sum(north, north)]);
        let level = east * libm::cos(angle) + north * libm::sin(angle);
        let along = (level + up * (sum(level, up) / sum(level, level))).try_normalize()?;
        let aside = up.cross(level);
        let directions = [along, aside, along.cross(aside)];
        let ranges_m = [0, 1, 2]
            .map(|k| range_m(points.iter().copied(), directions[k], if k == 0 { ENDS } else { SIDES }));
        (along.dot(up).abs() < STEEP).then_some(Self { directions, ranges_m })
    }

    /// Its length over the greater of its widths.
    fn slimness(&self) -> f64 {
        let [length_m, width_m, thickness_m] = self.ranges_m.map(|[low, high]| high - low);
        length_m / width_m.max(thickness_m).max(f64::MIN_POSITIVE)
    }

    /// How symmetric points are about its axis, in [0, 1]: how far they reach to the side where they reach less, over how far to the other,
    /// summed over stripes across the axis.
    fn symmetry(&self, points: &[DVec3]) -> f64 {
        let [along, aside, _] = self.directions;
        let [low_m, high_m] = self.ranges_m[1];
        let axis_m = (low_m + high_m) / 2.0;
        let mut places: Vec<(i64, f64)> = points
            .iter()
            .map(|point| ((along.dot(*point) / STRIPE_M).floor() as i64, aside.dot(*point) - axis_m))
            .collect();
        places.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (mut less_m, mut more_m) = (0.0, 0.0);
        for stripe in places.chunk_by(|a, b| a.0 == b.0).filter(|stripe| stripe.len() >= LEAST_POINTS) {
            let mut across: Vec<f64> = stripe.iter().map(|place| place.1).collect();
            let [left_m, right_m] = SIDES.map(|share| element_at(&mut across, share));
            let reaches_m = [-left_m, right_m].map(|reach_m| reach_m.max(0.0));
            less_m += reaches_m[0].min(reaches_m[1]);
            more_m += reaches_m[0].max(reaches_m[1]);
        }
        if more_m > 0.0 { less_m / more_m } else { 0.0 }
    }
}

/// The checks by which the first part is slim, ends at the second, and has an axis about which that is symmetric; `None` when one fails. What
/// lies against another by chance seldom points to its middle, and seldom along one of its own axes. O(sampled pixels · log(sampled pixels)).
pub(super) fn checks(clusters: &Clusters<'_>, up: DVec3, [part, body]: [SegmentId; 2]) -> Option<Vec<Check>> {
    let scene = clusters.scene;
    let points = |id: SegmentId| sampled(&clusters.get(id).pixels).map(|i| scene.point_at(i)).collect();
    let own: Vec<DVec3> = points(part);
    let shaft = Shaft::of(&own, up)?;
    let check = |name, unit, value, bound, limit| Check::new(name, unit, value, bound, limit);
    let slimness = shaft.slimness();
    let slim = check("length of the slim part, over its width", "", slimness, Bound::AtLeast, SLIMNESS);
    if !slim.holds() {
        return None;
    }
    let others: Vec<DVec3> = points(body);
    let [along, _, over] = shaft.directions;
    let [low_m, high_m] = shaft.ranges_m[0];
    let begins_m = range_m(others.iter().copied(), along, SIDES);
    let is_beyond = begins_m[0] + begins_m[1] > low_m + high_m;
    let (end_m, gap_m) =
        if is_beyond { (high_m, begins_m[0] - high_m) } else { (low_m, low_m - begins_m[1]) };
    let gap = "distance of its end from the other, along its axis";
    let at_end = own.iter().copied().filter(|point| (along.dot(*point) - end_m).abs() < END_M);
    let (of_end, of_other) = (range_m(at_end, over, SIDES), range_m(others.iter().copied(), over, SIDES));
    let common_m = of_end[1].min(of_other[1]) - of_end[0].max(of_other[0]);
    let level_share = common_m / (of_end[1] - of_end[0]).max(f64::MIN_POSITIVE);
    let checks = vec![
        slim,
        check(gap, "m", gap_m, Bound::AtLeast, GAP_M[0]),
        check(gap, "m", gap_m, Bound::AtMost, GAP_M[1]),
        check("share of its end as high as the other", "", level_share, Bound::AtLeast, LEVEL_SHARE),
        check("symmetry of the other about its axis", "", shaft.symmetry(&others), Bound::AtLeast, SYMMETRY),
    ];
    checks.iter().all(Check::holds).then_some(checks)
}
