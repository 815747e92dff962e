//! Rule 4: pieces of one surface of revolution are one vessel (docs/CONTEXT.md 4.4.6).
//!
//! What lies in a bowl or on a plate hides parts of it. The pieces that are left touch nowhere, so no border joins them, and each is too small to
//! show a circle. But they have one axis and one profile. The far inside and the near wall are pieces too, as the wall is thin.

use super::limits::{Limits, PART_PX};
use super::revolution::Revolution;
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::rim::{check_covered, check_radius, foot_m, measure_covered};
use crate::clusters::scene::sampled;
use crate::discovery::join::JoinEvidence;
use crate::linear::length;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// Root mean square distance of a piece from the surface, at most (m): walls are a few millimetres thick,
const DISTANCE_M: f64 = 0.005;
/// or this share of the radius, because a profile is no parabola,
const DISTANCE_SHARE: f64 = 0.06;
/// or so many quanta, for each time that the sensor's waves exceed a Kinect's.
const NOISE_QUANTA: f64 = 1.0;
/// The radius of a surface is this quantile of the distances of its points from the axis.
const RADIUS_SHARE: f64 = 0.95;
/// Heights reach from the first to the second of these quantiles.
const HEIGHT_QUANTILES: [f64; 2] = [0.05, 0.95];
/// Two pieces have this share of the heights of the lower one in common: things that stand on each other share none.
const LEVEL_SHARE: f64 = 0.3;

/// A cluster that may be a piece of a vessel.
struct Piece {
    id: SegmentId,
    /// Some of its points: along the two tangents of the support, and the height above it (m).
    points_m: Vec<[f64; 3]>,
    /// Where it begins and ends in height (m).
    heights_m: [f64; 2],
    /// The noise of its points (m).
    noise_m: f64,
}

impl Piece {
    /// `None` for a cluster that is too small, or no surface of revolution by itself.
    fn of(clusters: &Clusters<'_>, limits: Limits<'_>, id: SegmentId) -> Option<Self> {
        let (scene, pixels) = (clusters.scene, &clusters.get(id).pixels);
        if pixels.len() < scene.space.area_px(PART_PX) {
            return None;
        }
        let point = |i: usize| {
            let [x, y] = foot_m(scene, i as u32, limits.support);
            [x, y, scene.height_m(i, limits.support)]
        };
        let points_m: Vec<[f64; 3]> = sampled(pixels).map(point).collect();
        let mut heights_m: Vec<f64> = points_m.iter().map(|point| point[2]).collect();
        let mut depths_m: Vec<f64> = sampled(pixels).map(|i| f64::from(scene.points_m[i][2])).collect();
        let quanta = NOISE_QUANTA * scene.space.noise().waves().max(1.0);
        let noise_m = scene.space.step_m(quanta, element_at(&mut depths_m, 0.5));
        let heights_m = HEIGHT_QUANTILES.map(|share| element_at(&mut heights_m, share));
        let piece = Self { id, points_m, heights_m, noise_m };
        let surface = Revolution::fit(&piece.points_m);
        let radius_m = radius_m(&surface, &piece.points_m);
        let is_turned = surface.distance_m(&piece.points_m) < piece.most_m(radius_m)
            && check_radius("radius of the surface", radius_m)[1].holds();
        is_turned.then_some(piece)
    }

    /// The greatest distance (m) at which it is still of a surface with this radius.
    fn most_m(&self, radius_m: f64) -> f64 {
        (DISTANCE_SHARE * radius_m).max(DISTANCE_M).max(self.noise_m)
    }

    /// The share of the heights of the lower of two pieces that both have.
    fn level_share(&self, other: &Self) -> f64 {
        let [[low, high], [other_low, other_high]] = [self.heights_m, other.heights_m];
        let common_m = high.min(other_high) - low.max(other_low);
        common_m / (high - low).min(other_high - other_low).max(f64::MIN_POSITIVE)
    }
}

/// The distance of the outermost points of a surface from its axis (m).
fn radius_m(surface: &Revolution, points_m: &[[f64; 3]]) -> f64 {
    let mut distances_m: Vec<f64> = points_m.iter().map(|&point| length(surface.from_axis(point))).collect();
    element_at(&mut distances_m, RADIUS_SHARE)
}

/// Joins the two pieces that fit one surface of revolution best, and returns whether there are any.
/// O(pieces² · `SAMPLED_PX`) for the clusters that are round.
pub(super) fn join_turned(clusters: &mut Clusters<'_>, limits: Limits<'_>, misses: &mut Vec<Miss>) -> bool {
    let ids = clusters.alive().into_iter();
    let pieces: Vec<Piece> = ids.filter_map(|id| Piece::of(clusters, limits, id)).collect();
    let mut best: Option<(f64, Proposal, JoinEvidence)> = None;
    for (k, piece) in pieces.iter().enumerate() {
        for other in &pieces[..k] {
            let size = |piece: &Piece| clusters.get(piece.id).pixels.len();
            let [into, from] = if size(piece) > size(other) { [piece, other] } else { [other, piece] };
            let mut join = Proposal::new(Rule::VesselTurned, Source::Cluster(from.id), Some(into.id));
            match fit_both(clusters, limits, [into, from], &mut join) {
                Some((off, evidence)) if best.as_ref().is_none_or(|best| off < best.0) => {
                    best = Some((off, join, evidence));
                }
                Some(_) => {}
                None => misses.push(join.refuse()),
            }
        }
    }
    let Some((_, join, evidence)) = best else { return false };
    clusters.join(join, evidence);
    true
}

/// Checks that two pieces are of one surface: how far the worse one is off it, over the limit, and the evidence.
fn fit_both(
    clusters: &Clusters<'_>,
    limits: Limits<'_>,
    [into, from]: [&Piece; 2],
    join: &mut Proposal,
) -> Option<(f64, JoinEvidence)> {
    let level = into.level_share(from);
    let check_level =
        Check::new("share of the lower one's heights that both have", "", level, Bound::AtLeast, LEVEL_SHARE);
    if !join.check(check_level) {
        return None;
    }
    let points_m: Vec<[f64; 3]> = into.points_m.iter().chain(&from.points_m).copied().collect();
    let surface = Revolution::fit(&points_m);
    let radius_m = radius_m(&surface, &points_m);
    let mut most_off = 0.0_f64;
    for (what, piece) in [
        ("distance of the larger piece from one surface of revolution", into),
        ("distance of the smaller piece from one surface of revolution", from),
    ] {
        let (distance_m, most_m) = (surface.distance_m(&piece.points_m), piece.most_m(radius_m));
        if !join.check(Check::new(what, "m", distance_m, Bound::Below, most_m)) {
            return None;
        }
        most_off = most_off.max(distance_m / most_m);
    }
    let covered = measure_covered(points_m.iter().map(|&point| surface.from_axis(point)));
    let [low, high] = check_radius("radius of the surface", radius_m);
    let is_one = join.check(low)
        && join.check(high)
        && join.check(check_covered(covered))
        && join.check(limits.check_color(clusters, from.id, &[into.id]));
    is_one.then_some((most_off, JoinEvidence::VesselTurned { radius_m, covered }))
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
        let mut misses = Vec::new();
        while join_turned(&mut clusters, limits, &mut misses) {}
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
}
