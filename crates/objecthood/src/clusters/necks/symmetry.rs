//! Whether the axis of a slim part is an axis of symmetry of the other part, as the axis of a handle is for
//! the head of a hammer (docs/CONTEXT.md 4.7.4).

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::limits::{FOOT_M, SIDES};
use crate::linear::principal_angle;
use crate::quantile::{range, reach_m};
use crate::regions::SegmentId;

/// A part is slim if its length is at least this many times its width and its thickness.
const SLIMNESS: f64 = 3.0;
/// Lengths reach from the first to the second of these quantiles: outlines are noisy.
const ENDS: [f64; 2] = [0.03, 0.97];
/// Sine of the greatest slope of an axis, 45 degrees: an upright thing carries others in its axis.
const STEEP: f64 = 0.707;
/// The end of the slim part is this near to the other along the axis (m): widened edges and shadows hide as
/// much.
const GAP_M: [f64; 2] = [-0.015, 0.02];
/// The end is what lies this near (m) to it.
const END_M: f64 = 0.03;
/// At least this share of the heights of the end is shared with the other: a thing below or above the end is
/// no part of it.
const LEVEL_SHARE: f64 = 0.3;
/// The other is symmetric about the axis to at least this degree.
const SYMMETRY: f64 = 0.7;
/// The outlines of both parts are uncertain by a pixel each. So that much farther to one side is no asymmetry
/// (px of the image, of any camera), ...
const OUTLINE_PX: f64 = 2.0;
/// ... up to this share of the width of the other.
const OUTLINE_SHARE: f64 = 0.2;
/// Both sides of the axis are compared in at most this many stripes across it, each at least this wide (m),
/// ...
const STRIPES: f64 = 12.0;
const STRIPE_M: f64 = 0.01;
/// ... if a stripe holds this many points.
const LEAST_POINTS: usize = 8;
/// Between the end and the other, a support is seen at less than this share of the examined places, ...
const SEEN_SHARE: f64 = 0.5;
/// ... which are this far apart (m).
const STEP_M: f64 = 0.002;

/// A slim part: its direction and the two across it, with the range of the part along each (m).
pub(super) struct Shaft {
    points: Vec<DVec3>,
    /// Its length runs along the first direction, the second is level.
    directions: [DVec3; 3],
    /// The width of a pixel at its distance (m).
    pixel_m: f64,
    ranges_m: [[f64; 2]; 3],
}

impl Shaft {
    /// `None` for a cluster that lies along a steep line, or is not slim. O(sampled pixels).
    pub(super) fn of(clusters: &Clusters<'_>, up: DVec3, id: SegmentId) -> Option<Self> {
        let points: Vec<DVec3> = points(clusters, id);
        let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let offsets = || points.iter().map(|point| *point - mean);
        let (east, north) = up.any_orthonormal_pair();
        let sum = |a: DVec3, b: DVec3| offsets().map(|offset| a.dot(offset) * b.dot(offset)).sum::<f64>();
        let angle = principal_angle([sum(east, east), sum(east, north), sum(north, north)]);
        let level = east * libm::cos(angle) + north * libm::sin(angle);
        let along = (level + up * (sum(level, up) / sum(level, level))).try_normalize()?;
        if along.dot(up).abs() >= STEEP {
            return None;
        }
        let aside = up.cross(level);
        let directions = [along, aside, along.cross(aside)];
        let ranges_m = [0, 1, 2]
            .map(|k| reach_m(points.iter().copied(), directions[k], if k == 0 { ENDS } else { SIDES }));
        let camera = clusters.scene.space.camera();
        let pixel_m = mean.z / camera.fx_px.min(camera.fy_px);
        let shaft = Self { points, directions, pixel_m, ranges_m };
        (shaft.slimness() >= SLIMNESS).then_some(shaft)
    }

    /// Its length over the greater of its widths.
    fn slimness(&self) -> f64 {
        let [length_m, width_m, thickness_m] = self.ranges_m.map(|[low, high]| high - low);
        length_m / width_m.max(thickness_m).max(f64::MIN_POSITIVE)
    }

    /// The point on its axis at a place along it (m).
    fn at(&self, along_m: f64) -> DVec3 {
        let [along, aside, over] = self.directions;
        along * along_m + aside * self.middle_m(1) + over * self.middle_m(2)
    }

    /// The place of its axis along one of its directions (m).
    fn middle_m(&self, direction: usize) -> f64 {
        f64::midpoint(self.ranges_m[direction][0], self.ranges_m[direction][1])
    }

    /// How symmetric points are about its axis, in [0, 1]: how far they reach to the shorter side, over how
    /// far to the longer, summed over stripes across the axis. What outlines are uncertain by does not count.
    /// `begins_m`: the range of the points along the axis.
    fn symmetry(&self, points: &[DVec3], begins_m: [f64; 2]) -> f64 {
        let [along, aside, _] = self.directions;
        let axis_m = self.middle_m(1);
        let width_m = ((begins_m[1] - begins_m[0]) / STRIPES).max(STRIPE_M);
        let stripe = |point: DVec3| ((along.dot(point) - begins_m[0]) / width_m).round() as i64;
        let mut places: Vec<(i64, f64)> =
            points.iter().map(|&point| (stripe(point), aside.dot(point) - axis_m)).collect();
        places.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let (mut less_m, mut more_m) = (0.0, 0.0);
        for stripe in places.chunk_by(|a, b| a.0 == b.0).filter(|stripe| stripe.len() >= LEAST_POINTS) {
            let mut across: Vec<f64> = stripe.iter().map(|place| place.1).collect();
            let [left_m, right_m] = range(&mut across, SIDES);
            let reaches_m = [-left_m, right_m].map(|reach_m| reach_m.max(0.0));
            let [less, more] = [reaches_m[0].min(reaches_m[1]), reaches_m[0].max(reaches_m[1])];
            less_m += less;
            let uncertain_m = (OUTLINE_PX * self.pixel_m).min(OUTLINE_SHARE * (less + more));
            more_m += less.max(more - uncertain_m);
        }
        if more_m > 0.0 { less_m / more_m } else { 0.0 }
    }

    /// The share of the places on its axis between two places (m) at which a support is seen, so that nothing
    /// lies between.
    fn bare_share(&self, clusters: &Clusters<'_>, [from_m, to_m]: [f64; 2]) -> f64 {
        let scene = clusters.scene;
        let count = ((to_m - from_m).abs() / STEP_M) as usize;
        let seen = (1..count).filter_map(|k| {
            let place_m = from_m + (to_m - from_m) * k as f64 / count as f64;
            let pixel = scene.space.camera().pixel_at(self.at(place_m), scene.disparity.size())?;
            scene.facets.segments.at(pixel)
        });
        let is_support = |facet: SegmentId| scene.supports.contains(&facet.index());
        let (bare, all) =
            seen.fold((0, 0), |(bare, all), facet| (bare + i32::from(is_support(facet)), all + 1));
        f64::from(bare) / f64::from(all.max(1))
    }
}

fn points(clusters: &Clusters<'_>, id: SegmentId) -> Vec<DVec3> {
    clusters.scene.sampled_points(&clusters.get(id).pixels).collect()
}

/// The checks by which a slim part ends at another, and its axis is an axis of symmetry of the other. `None`
/// if one fails. A thing that lies against another by chance seldom points to the middle of the other, and
/// seldom along an axis of symmetry. O(sampled pixels · log(sampled pixels)).
pub(super) fn checks(
    clusters: &Clusters<'_>,
    shaft: &Shaft,
    body: SegmentId,
    feet_m: [f64; 2],
) -> Option<Vec<Check>> {
    let check = |name, unit, value, bound, limit| Check::new(name, unit, value, bound, limit);
    let others = points(clusters, body);
    let [along, _, over] = shaft.directions;
    let [low_m, high_m] = shaft.ranges_m[0];
    let begins_m = reach_m(others.iter().copied(), along, SIDES);
    let is_beyond = begins_m[0] + begins_m[1] > low_m + high_m;
    let [end_m, begin_m] = if is_beyond { [high_m, begins_m[0]] } else { [low_m, begins_m[1]] };
    // The quantiles leave out a part of its length at each end.
    let left_out_m = (high_m - low_m) * ENDS[0] / (ENDS[1] - ENDS[0]);
    let gap_m = if is_beyond { begin_m - end_m } else { end_m - begin_m } - left_out_m;
    let gap = "distance of its end from the other, along its axis";
    let at_end = shaft.points.iter().copied().filter(|point| (along.dot(*point) - end_m).abs() < END_M);
    let (mut of_end, mut of_other) =
        (reach_m(at_end, over, SIDES), reach_m(others.iter().copied(), over, SIDES));
    // Parts that stand on the support reach down to it, also where that is not seen. (The height of a foot is
    // measured upwards, which is across a level axis.)
    if feet_m.iter().all(|&foot_m| foot_m <= FOOT_M) {
        of_end[0] -= feet_m[0].max(0.0);
        of_other[0] -= feet_m[1].max(0.0);
    }
    let common_m = of_end[1].min(of_other[1]) - of_end[0].max(of_other[0]);
    let level_share = common_m / (of_end[1] - of_end[0]).max(f64::MIN_POSITIVE);
    let slim = "length of the slim part, over its width";
    let mut checks = vec![
        check(slim, "", shaft.slimness(), Bound::AtLeast, SLIMNESS),
        check(gap, "m", gap_m, Bound::AtLeast, GAP_M[0]),
        check(gap, "m", gap_m, Bound::AtMost, GAP_M[1]),
        check("share of its end as high as the other", "", level_share, Bound::AtLeast, LEVEL_SHARE),
    ];
    if !checks.iter().all(Check::holds) {
        return None;
    }
    let symmetry = shaft.symmetry(&others, begins_m);
    let bare_share = shaft.bare_share(clusters, [end_m, begin_m]);
    checks.extend([
        check("symmetry of the other about its axis", "", symmetry, Bound::AtLeast, SYMMETRY),
        check(
            "share of the way between at which a support is seen",
            "",
            bare_share,
            Bound::Below,
            SEEN_SHARE,
        ),
    ]);
    checks.iter().all(Check::holds).then_some(checks)
}
