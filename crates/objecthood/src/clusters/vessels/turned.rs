//! Rule 6: pieces of one surface of revolution are one vessel (docs/CONTEXT.md 4.4.6).
//!
//! What lies in a bowl or on a plate hides parts of it. The pieces that are left touch nowhere, so no border joins them, and each is too small to
//! show a circle. But they have one axis and one profile. The far inside and the near wall are pieces too, as the wall is thin.

use super::limits::{Limits, PART_PX};
use super::revolution::{Revolution, mean_m, plane_distance_m};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::rim::{check_covered, check_radius, measure_covered};
use crate::clusters::scene::sampled;
use crate::discovery::join::JoinEvidence;
use crate::linear::length;
use crate::quantile::{element_at, range};
use crate::regions::SegmentId;
use crate::tangents::tangents;

/// Root mean square distance of a piece from the surface, at most (m): walls are a few millimetres thick,
const DISTANCE_M: f64 = 0.005;
/// or this share of the radius, because a profile is no parabola,
const DISTANCE_SHARE: f64 = 0.06;
/// or so many quanta, for each time that the sensor's waves exceed a Kinect's,
const NOISE_QUANTA: f64 = 1.0;
/// but never more than this share of the radius: where noise is as large as a thing, everything is round.
const MOST_SHARE: f64 = 0.12;
/// The pieces are farther than noise, and than this (m), from one plane: through flat things a surface of revolution goes everywhere.
const BENT_M: f64 = 0.0025;
/// The radius of a surface is this quantile of the distances of its points from the axis.
const RADIUS_SHARE: f64 = 0.95;
/// Heights reach from the first to the second of these quantiles.
const HEIGHT_QUANTILES: [f64; 2] = [0.05, 0.95];
/// Two pieces have this share of the heights of the less tall one in common: what stands on another begins where that ends.
const LEVEL_SHARE: f64 = 0.3;
/// The middles of two pieces of one vessel are at most this far apart in the plan view (m): the diameter of the largest.
const APART_M: f64 = 0.4;

/// A cluster that may be a piece of a vessel.
struct Piece {
    id: SegmentId,
    /// Some of its points: along the two tangents of the support, and the height above it (m).
    points_m: Vec<[f64; 3]>,
    /// The middle of these points in the plan view (m).
    middle_m: [f64; 2],
    /// Where it begins and ends in height (m).
    heights_m: [f64; 2],
    /// The noise of its points (m).
    noise_m: f64,
}

impl Piece {
    /// `None` for a cluster that is too small, flat, or no surface of revolution by itself.
    fn of(clusters: &Clusters<'_>, limits: Limits<'_>, id: SegmentId) -> Option<Self> {
        let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels);
        if pixels.len() < scene.space.area_px(PART_PX) || clusters.flat(id).is_some() {
            return None;
        }
        let sideways = tangents(limits.support.normal);
        let point = |i: usize| {
            let [x, y] = sideways.map(|tangent| tangent.dot(scene.point_at(i)));
            [x, y, scene.height_m(i, limits.support)]
        };
        let points_m: Vec<[f64; 3]> = sampled(pixels).map(point).collect();
        let mut heights_m: Vec<f64> = points_m.iter().map(|point| point[2]).collect();
        let heights_m = range(&mut heights_m, HEIGHT_QUANTILES);
        let mut depths_m: Vec<f64> = scene.sampled_points(pixels).map(|point| point.z).collect();
        let depth_m = element_at(&mut depths_m, 0.5);
        let noise_m = scene.space.step_m(NOISE_QUANTA * scene.space.noise().waves().max(1.0), depth_m);
        let [x, y, _] = mean_m(&points_m);
        let piece = Self { id, points_m, middle_m: [x, y], heights_m, noise_m };
        let surface = Revolution::fit(&piece.points_m);
        let radius_m = radius_m(&surface, &piece.points_m);
        let [_, is_small] = check_radius("radius of the surface", radius_m);
        (is_small.holds() && surface.distance_m(&piece.points_m) < piece.most_m(radius_m)).then_some(piece)
    }

    /// The greatest distance (m) at which it is still of a surface with this radius.
    fn most_m(&self, radius_m: f64) -> f64 {
        (DISTANCE_SHARE * radius_m).max(DISTANCE_M).max(self.noise_m).min(MOST_SHARE * radius_m)
    }

    fn is_near(&self, other: &Self) -> bool {
        length([0, 1].map(|k| self.middle_m[k] - other.middle_m[k])) < APART_M
    }

    /// The share of the heights of the less tall of two pieces that both have.
    fn level_share(&self, other: &Self) -> f64 {
        let [[low, high], [other_low, other_high]] = [self.heights_m, other.heights_m];
        let common_m = high.min(other_high) - low.max(other_low);
        common_m / (high - low).min(other_high - other_low).max(f64::MIN_POSITIVE)
    }
}

/// The distance of the outermost points of a surface from its axis (m).
fn radius_m(surface: &Revolution, points_m: &[[f64; 3]]) -> f64 {
    let mut distances_m: Vec<f64> = points_m.iter().map(|&point| length(surface.about_axis(point))).collect();
    element_at(&mut distances_m, RADIUS_SHARE)
}

/// Two pieces of one surface.
struct Fit {
    parts: [SegmentId; 2],
    /// The distance of the worse one from it, over the limit.
    off: f64,
    join: Proposal,
    evidence: JoinEvidence,
}

/// Joins pieces of one surface of revolution, the pair that fits best first, at most `times` times.
/// O(clusters + pairs of near pieces), times about 200 pixels.
pub(super) fn join_turned(clusters: &mut Clusters<'_>, limits: Limits<'_>, times: usize) {
    let ids = clusters.alive().into_iter();
    let mut pieces: Vec<Piece> = ids.filter_map(|id| Piece::of(clusters, limits, id)).collect();
    let mut misses = Vec::new();
    let mut fits = Vec::new();
    for (k, piece) in pieces.iter().enumerate() {
        fits.extend(fit_all(clusters, limits, piece, &pieces[..k], &mut misses));
    }
    for _ in 0..times {
        // On ties the first pair.
        let best = (0..fits.len()).reduce(|best, k| if fits[k].off < fits[best].off { k } else { best });
        let Some(Fit { parts, join, evidence, .. }) = best.map(|best| fits.remove(best)) else { break };
        clusters.join(join, evidence);
        let is_of = |id: SegmentId| parts.contains(&id);
        fits.retain(|fit| !fit.parts.into_iter().any(is_of));
        pieces.retain(|piece| !is_of(piece.id));
        if let Some(whole) = Piece::of(clusters, limits, parts[0]) {
            fits.extend(fit_all(clusters, limits, &whole, &pieces, &mut misses));
            pieces.push(whole);
        }
    }
    misses.retain(|miss: &Miss| {
        let ends = [miss.into, miss.from.cluster()];
        ends.into_iter().flatten().all(|id| !clusters.get(id).pixels.is_empty())
    });
    clusters.history.note_misses(misses);
}

/// The fits of a piece with others near it; near misses are noted.
fn fit_all(
    clusters: &Clusters<'_>,
    limits: Limits<'_>,
    piece: &Piece,
    others: &[Piece],
    misses: &mut Vec<Miss>,
) -> Vec<Fit> {
    let size = |piece: &Piece| clusters.get(piece.id).pixels.len();
    let near = others.iter().filter(|other| piece.is_near(other));
    near.filter_map(|other| {
        let pair = if size(piece) > size(other) { [piece, other] } else { [other, piece] };
        fit_both(clusters, limits, pair, misses)
    })
    .collect()
}

/// Fits one surface to two pieces, the larger one first; `None` when a check fails. A miss is noted if both distances hold.
fn fit_both(
    clusters: &Clusters<'_>,
    limits: Limits<'_>,
    [into, from]: [&Piece; 2],
    misses: &mut Vec<Miss>,
) -> Option<Fit> {
    let parts = [into, from].map(|piece| piece.id);
    let mut join = Proposal::new(Rule::VesselTurned, Source::Cluster(from.id), Some(into.id));
    let level = into.level_share(from);
    let what = "share of the less tall one's heights that both have";
    if !join.check(Check::new(what, "", level, Bound::AtLeast, LEVEL_SHARE)) {
        return None;
    }
    let points_m: Vec<[f64; 3]> = into.points_m.iter().chain(&from.points_m).copied().collect();
    let surface = Revolution::fit(&points_m);
    let radius_m = radius_m(&surface, &points_m);
    let mut off = 0.0_f64;
    for (what, piece) in [
        ("distance of the larger piece from one surface of revolution", into),
        ("distance of the smaller piece from one surface of revolution", from),
    ] {
        let (distance_m, most_m) = (surface.distance_m(&piece.points_m), piece.most_m(radius_m));
        if !join.check(Check::new(what, "m", distance_m, Bound::Below, most_m)) {
            return None;
        }
        off = off.max(distance_m / most_m);
    }
    let bent_m = plane_distance_m(&points_m);
    let noise_m = into.noise_m.max(from.noise_m).max(BENT_M);
    let covered = measure_covered(points_m.iter().map(|&point| surface.about_axis(point)));
    let [low, high] = check_radius("radius of the surface", radius_m);
    let is_one =
        join.check(Check::new("distance of both from one plane", "m", bent_m, Bound::Above, noise_m))
            && join.check(low)
            && join.check(high)
            && join.check(check_covered(covered))
            && join.check(limits.check_color(clusters, from.id, &[into.id]));
    if !is_one {
        misses.push(join.refuse());
        return None;
    }
    Some(Fit { parts, off, join, evidence: JoinEvidence::VesselTurned { radius_m, covered } })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};
    use crate::params;

    /// The numbers of the clusters after the rule, in an image of (facet, height).
    fn joined(at: impl Fn(f64, f64) -> (i32, f64)) -> Vec<Option<u32>> {
        let table = Table::new((160, 120), |u, v| Some(at(u as f64 - 80.0, v as f64 - 60.0)));
        let scene = table.scene();
        let mut clusters = single(&scene);
        let limits = Limits { support: scene.ground().unwrap(), params: &params::Vessels::default() };
        join_turned(&mut clusters, limits, 12);
        named(&clusters)
    }

    /// Height (m) of the inside of a bowl of 5 cm, so many pixels from its middle.
    fn bowl_m(u: f64, v: f64) -> f64 {
        0.01 + (u * u + v * v) * 0.05 / (50.0 * 50.0)
    }

    #[test]
    fn what_a_bar_across_a_bowl_parts_is_one_bowl() {
        let parted = joined(|u, v| match u.hypot(v) {
            _ if u.abs() < 12.0 => (3, 0.08),
            r if r < 50.0 => (if u < 0.0 { 1 } else { 2 }, bowl_m(u, v)),
            _ => (0, 0.0),
        });
        assert_eq!(parted, [Some(0), Some(0), Some(2)]);
    }

    #[test]
    fn two_bowls_side_by_side_are_two() {
        let two = joined(|u, v| {
            let (facet, u) = if u < 0.0 { (1, u + 38.0) } else { (2, u - 38.0) };
            if u.hypot(v) < 36.0 { (facet, bowl_m(u, v)) } else { (0, 0.0) }
        });
        assert_eq!(two, [Some(0), Some(1)]);
    }

    #[test]
    fn what_stands_on_another_shares_no_heights_with_it() {
        // Two cones of one axis and one profile, the second on the first.
        let stacked = joined(|u, v| match u.hypot(v) {
            r if r < 25.0 => (2, 0.10 - r * 0.001),
            r if r < 50.0 => (1, 0.10 - r * 0.001),
            _ => (0, 0.0),
        });
        assert_eq!(stacked, [Some(0), Some(1)]);
    }

    #[test]
    fn two_flat_things_of_one_height_are_two() {
        // A ripple of 0.2 mm, as noise would be.
        let two = joined(|u, v| {
            let is_top = v.abs() < 20.0 && (4.0..34.0).contains(&u.abs());
            let facet = if u < 0.0 { 1 } else { 2 };
            if is_top { (facet, 0.05 + 0.0002 * ((u * 12.9 + v * 78.2).sin())) } else { (0, 0.0) }
        });
        assert_eq!(two, [Some(0), Some(1)]);
    }
}
