//! Rule 4: pieces of one surface of revolution are one vessel (docs/CONTEXT.md 4.4.4).
//!
//! Contents of a bowl or a plate hide parts of it. The pieces that remain visible do not touch, so no border
//! joins them, and each is too small to show a circle. But they share one axis and one profile. Even the far
//! inside and the near wall do, because the wall is thin.

use super::limits::Limits;
use super::piece::{Piece, radius_m};
use super::revolution::{Revolution, plane_distance_m};
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::rim::{check_covered, check_radius, measure_covered};
use crate::discovery::join::JoinEvidence;
use crate::quantile::element_at;
use crate::regions::SegmentId;

/// The pieces lie farther than noise, and than this (m), from one plane: any flat thing fits some surface of
/// revolution.
const BENT_M: f64 = 0.0025;
/// Two pieces have at least this share of the heights of the less tall one in common: a thing on another
/// begins where the other ends.
const LEVEL_SHARE: f64 = 0.3;

/// Two pieces of one surface.
struct Fit {
    parts: [SegmentId; 2],
    /// The distance of the worse piece from it, over the limit.
    off: f64,
    join: Proposal,
    evidence: JoinEvidence,
}

/// Joins pieces of one surface of revolution, the pair that fits best first, at most `times` times.
/// O(clusters + pairs of near pieces), times about 200 pixels.
pub(super) fn join_turned(clusters: &mut Clusters<'_>, limits: Limits<'_>, times: usize) {
    let ids = clusters.alive().into_iter();
    let mut pieces: Vec<Piece> = ids.filter_map(|id| Piece::of(clusters, limits.support, id)).collect();
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
        if let Some(whole) = Piece::of(clusters, limits.support, parts[0]) {
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

/// The fits of a piece with others near it. Near misses are recorded.
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

/// Fits one surface to two pieces, the larger one first. `None` if a check fails. A miss is recorded if both
/// distances hold.
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
            && join.check(limits.check_color(clusters, from.id, &[into.id]))
            && (!parts.into_iter().all(|id| clusters.convexity(id) < 0.0)
                || join.check(check_apart(&surface, [into, from])));
    if !is_one {
        misses.push(join.refuse());
        return None;
    }
    Some(Fit { parts, off, join, evidence: JoinEvidence::VesselTurned { radius_m, covered } })
}

/// Checks that neither of two insides lies beyond the other: otherwise one stands in the other.
fn check_apart(surface: &Revolution, [into, from]: [&Piece; 2]) -> Check {
    let beyond_m = |piece: &Piece| {
        let mut beyond_m: Vec<f64> = piece.points_m.iter().map(|&point| surface.beyond_m(point)).collect();
        element_at(&mut beyond_m, 0.5)
    };
    let apart_m = (beyond_m(into) - beyond_m(from)).abs();
    Check::new("distance of the pieces across that surface", "m", apart_m, Bound::Below, into.most_beyond_m())
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
    fn a_bowl_lies_apart_from_the_one_it_stands_in() {
        let is_one = |inner_px: f64| {
            let table = Table::new((160, 120), |u, v| {
                let (u, v) = (u as f64 - 80.0, v as f64 - 60.0);
                Some(match u.hypot(v) {
                    r if r < 30.0 => (1, bowl_m(u * 50.0 / inner_px, v * 50.0 / inner_px)),
                    r if r < 50.0 => (2, bowl_m(u, v)),
                    _ => (0, 0.0),
                })
            });
            let scene = table.scene();
            let clusters = single(&scene);
            let support = scene.ground().unwrap();
            let pieces = [0, 1].map(|id| Piece::of(&clusters, support, SegmentId(id)).unwrap());
            let points_m = pieces.each_ref().map(|piece| piece.points_m.clone()).concat();
            check_apart(&Revolution::fit(&points_m), [&pieces[0], &pieces[1]]).holds()
        };
        assert!(is_one(50.0) && !is_one(36.0));
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
