//! Whether a part begins at another as a neck: the joint is narrower than both parts (docs/CONTEXT.md 4.7.5).

use std::collections::BTreeMap;

use glam::DVec3;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::necks::alike::check_alike_in_light;
use crate::clusters::necks::contact::{beside, pixel_pairs};
use crate::clusters::necks::limits::{HIDDEN_M, SIDES, WIDTH_QUANTA};
use crate::clusters::necks::part::Part;
use crate::linear::length;
use crate::quantile::{range, reach_m};
use crate::regions::SegmentId;

/// A neck is at most this share of the width of the widest place of its part, and of the other part.
const NECK_SHARE: f64 = 0.6;
/// A neck is at most this wide (m): a wider one that is hidden in part is often a corner.
const WIDEST_M: f64 = 0.04;
/// A neck is at least this share of the width of the other: one that looks narrower is hidden in part.
const SLIVER_SHARE: f64 = 0.2;
/// The length of the joint over the width of the neck lies between these. A part that something hides meets
/// the other along more, or across a shadow.
const JOINT_LENGTHS: [f64; 2] = [0.65, 1.5];
/// The width at the joint is at least this share of the neck's greatest width: the corner of a partly hidden
/// thing widens steadily.
const EVENNESS: f64 = 0.55;
/// A neck is at least as long as this share of its part's greatest width: where round things touch, they
/// widen at once.
const NECK_LENGTH: f64 = 0.25;
/// The part at the other end lies within 60 degrees of the direction of the neck: the cosine.
const OPPOSITE: f64 = 0.5;
/// The part is divided into this many slices from the joint on, ...
const SLICES: usize = 16;
/// ... and a slice of fewer pixels has no width (px at 525 px).
const LEAST_PX: usize = 6;

/// The checks by which the first part begins as a neck at the second; the caller has compared their colours.
/// `None` if one fails. A part that is narrow along its whole length counts only with a third part of its
/// colours at its other end. O(pixels of all three).
pub(super) fn checks(
    clusters: &Clusters<'_>,
    parts: &BTreeMap<SegmentId, Part<'_>>,
    [part, body]: [SegmentId; 2],
    least_overlap: f64,
) -> Option<Vec<Check>> {
    let neck = Neck::of(clusters, [part, body])?;
    let mut checks = neck.checks(clusters, body);
    if !checks.iter().all(Check::holds) {
        return None;
    }
    let narrow = |what, share| Check::new(what, "", share, Bound::AtMost, NECK_SHARE);
    let of_part = narrow("width of the neck, over that of the part", neck.width_m / neck.widest_m);
    let of_part = if of_part.holds() {
        of_part
    } else {
        let is_held = |&other: &SegmentId| {
            other != body
                && neck.ends_at(clusters, [part, other])
                && check_alike_in_light([part, other].map(|id| parts[&id].colors()), least_overlap).holds()
        };
        let shares = beside(clusters, part).filter(is_held).map(|other| neck.share_of(clusters, other));
        let least = shares.fold(f64::INFINITY, f64::min);
        narrow("width of the neck, over that of what is at its other end", least)
    };
    checks.push(of_part);
    checks.iter().all(Check::holds).then_some(checks)
}

/// The beginning of a part at another.
struct Neck {
    /// How near the two parts are (m), and how long their joint is (m).
    gap_m: f64,
    joint_m: f64,
    /// The middle of the part (m), the direction from the joint to it, and the direction across that and the
    /// line of sight.
    mean: DVec3,
    away: DVec3,
    aside: DVec3,
    /// The greatest width of the neck, its width at the joint, and the greatest width of the whole part (m).
    width_m: f64,
    at_joint_m: f64,
    widest_m: f64,
    /// A narrower width is noise (m).
    noise_m: f64,
}

impl Neck {
    /// `None` for parts that are not side by side, and for one that is too short or has too few pixels at the joint. O(pixels of the part).
    fn of(clusters: &Clusters<'_>, [part, body]: [SegmentId; 2]) -> Option<Self> {
        let Joint { points: joint, middle, gap_m } = Joint::of(clusters, [part, body])?;
        let own = points(clusters, part);
        let mean = own.iter().sum::<DVec3>() / own.len() as f64;
        let away = (mean - middle).try_normalize()?;
        let aside = away.cross(middle).try_normalize()?;
        let least_px = clusters.scene.space.area_px(LEAST_PX);
        let slices = Slices::of(&own, middle, [away, aside], least_px)?;
        let neck_m = slices.neck_m()?;
        Some(Self {
            gap_m,
            joint_m: length([width_m(&joint, away), width_m(&joint, aside)]),
            mean,
            away,
            aside,
            width_m: neck_m,
            at_joint_m: slices.widths_m[0]?,
            widest_m: slices.widest_m,
            noise_m: clusters.scene.space.step_m(WIDTH_QUANTA, middle.z),
        })
    }

    /// The checks of its joint with the other and of its width. O(pixels of the other).
    fn checks(&self, clusters: &Clusters<'_>, body: SegmentId) -> Vec<Check> {
        let check = |name, unit, value, bound, limit| Check::new(name, unit, value, bound, limit);
        let (width, over_other) = ("width of the neck", "width of the neck, over that of the other");
        let (length, evenness) =
            ("length of the joint, over that width", "width at the joint, over that width");
        let (joint_share, share) = (self.joint_m / self.width_m, self.share_of(clusters, body));
        vec![
            check("distance of the parts", "m", self.gap_m, Bound::AtMost, HIDDEN_M),
            check(width, "m", self.width_m, Bound::Above, self.noise_m),
            check(width, "m", self.width_m, Bound::AtMost, WIDEST_M),
            check(evenness, "", self.at_joint_m / self.width_m, Bound::AtLeast, EVENNESS),
            check(length, "", joint_share, Bound::AtLeast, JOINT_LENGTHS[0]),
            check(length, "", joint_share, Bound::AtMost, JOINT_LENGTHS[1]),
            check(over_other, "", share, Bound::AtLeast, SLIVER_SHARE),
            check(over_other, "", share, Bound::AtMost, NECK_SHARE),
        ]
    }

    /// Its width over that of a cluster. O(pixels of the cluster).
    fn share_of(&self, clusters: &Clusters<'_>, id: SegmentId) -> f64 {
        self.width_m / width_m(&points(clusters, id), self.aside)
    }

    /// Whether the other end of its part is at another cluster. O(pixels of the part).
    fn ends_at(&self, clusters: &Clusters<'_>, pair: [SegmentId; 2]) -> bool {
        let end = Joint::of(clusters, pair).filter(|end| end.gap_m <= HIDDEN_M);
        end.is_some_and(|end| self.away.dot((end.middle - self.mean).normalize_or_zero()) > OPPOSITE)
    }
}

/// The points of a cluster (m).
fn points(clusters: &Clusters<'_>, id: SegmentId) -> Vec<DVec3> {
    clusters.get(id).pixels.iter().map(|&i| clusters.scene.point_at(i as usize)).collect()
}

/// How far points reach along a direction (m).
fn width_m(points: &[DVec3], direction: DVec3) -> f64 {
    let [from_m, to_m] = reach_m(points.iter().copied(), direction, SIDES);
    to_m - from_m
}

/// Where a part is beside another in the image.
struct Joint {
    /// Its points there, and their middle (m).
    points: Vec<DVec3>,
    middle: DVec3,
    /// The least distance of the parts there (m).
    gap_m: f64,
}

impl Joint {
    /// `None` if they are not side by side. O(pixels of the part).
    fn of(clusters: &Clusters<'_>, parts: [SegmentId; 2]) -> Option<Self> {
        let point = |i| clusters.scene.point_at(i);
        let (mut pixels, mut gap_m) = (Vec::new(), f64::INFINITY);
        for (i, j) in pixel_pairs(clusters, parts) {
            gap_m = gap_m.min(point(j).distance(point(i)));
            pixels.push(i);
        }
        pixels.dedup();
        let points: Vec<DVec3> = pixels.into_iter().map(point).collect();
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        (!points.is_empty()).then_some(Self { points, middle, gap_m })
    }
}

/// A part in slices from the joint on.
struct Slices {
    /// The widths (m); `None` where there are too few pixels.
    widths_m: Vec<Option<f64>>,
    /// The thickness of a slice.
    step_m: f64,
    widest_m: f64,
}

impl Slices {
    /// `None` for a part without length.
    fn of(points: &[DVec3], joint: DVec3, [away, aside]: [DVec3; 2], least_px: usize) -> Option<Self> {
        let [_, end_m] = reach_m(points.iter().copied(), away, SIDES);
        let step_m = (end_m - away.dot(joint)) / SLICES as f64;
        if step_m <= 0.0 {
            return None;
        }
        let mut slices = vec![Vec::new(); SLICES];
        for point in points {
            let place = ((away.dot(*point - joint)) / step_m).max(0.0) as usize;
            slices[place.min(SLICES - 1)].push(aside.dot(*point));
        }
        let width_m = |mut places: Vec<f64>| {
            let [from_m, to_m] = range(&mut places, SIDES);
            (places.len() >= least_px).then_some(to_m - from_m)
        };
        let widths_m: Vec<Option<f64>> = slices.into_iter().map(width_m).collect();
        let widest_m = widths_m.iter().flatten().copied().fold(0.0, f64::max);
        Some(Self { widths_m, step_m, widest_m })
    }

    /// The greatest width of the beginning; `None` if the part is not that long, or a slice has no width.
    fn neck_m(&self) -> Option<f64> {
        let slices = (NECK_LENGTH * self.widest_m / self.step_m).ceil() as usize;
        let widths_m = self.widths_m.get(..slices.max(1))?;
        widths_m.iter().try_fold(0.0, |widest_m: f64, width_m| Some(widest_m.max((*width_m)?)))
    }
}
