//! Vessels: an inside and a wall that no convexity could join (METHOD 3.12).
//!
//! A vessel shows the far side of its inside and the near side of its wall, with the rim as a step in depth between them. They are known
//! by a concave inside, by equal height, and by the circle on which the rim lies.

use std::collections::BTreeSet;

use crate::clusters::borders::Borders;
use crate::clusters::check::{Bound, Check, Checks};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Event, Miss, Rule, Source};
use crate::clusters::rim::{circle_checks, rim_circle, share_within};
use crate::discovery::join::{Join, JoinEvidence, RimCircle};
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::regions::SegmentId;

/// Pieces of one inside: they touch along so many pixels (px at a focal length of 525 px) ...
const INSIDE_TOUCH_PX: usize = 8;
/// ... and each has so many (at 525 px).
const INSIDE_PX: usize = 60;
/// So often two pieces of an inside are joined.
const INSIDE_MERGES: usize = 6;
/// An inside and a wall have at least so many pixels (at 525 px).
const PART_PX: usize = 100;
/// An inside bends outwards by no more than this, a wall inwards by no more.
const FLAT: f64 = 0.1;
/// A wall is in front of the inside along so many pixels (at 525 px), ...
const FRONT_PX: usize = 8;
/// ... so many times more than behind.
const FRONT_RATIO: u32 = 4;
/// Without a circle the wall is in front along so many (at 525 px).
const FRONT_ALONE_PX: usize = 12;
/// A part of the vessel stands within its rim's circle with this share of its pixels.
const WITHIN_SHARE: f64 = 0.8;
/// So often something is joined to a vessel, by the second rule and by the third.
const MERGES: usize = 12;
/// What remains touches the vessel along so many pixels (at 525 px) ...
const REMAINDER_TOUCH_PX: usize = 6;
/// ... and with this share of all its contacts, ...
const REMAINDER_SHARE: f64 = 0.8;
/// ... and has at most this share of the vessel's pixels.
const REMAINDER_SIZE: f64 = 0.3;

/// The parameters that its limits come from.
const CONCAVITY: &str = "vessels.concavity";
const RIM_HEIGHT: &str = "vessels.rim_height_m";

/// Joins the parts of vessels. Without a support surface, or with `concavity` 0, nothing is done.
/// O(merges · clusters · neighbours + the pixels of every inside and its walls that are tried, up to 12 times).
pub(crate) fn join_vessels(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let Some(support) = clusters.scene.support.filter(|_| params.concavity > 0.0) else { return };
    let rules = Rules { support, params };
    let mut vessels = BTreeSet::new();
    repeat(clusters, INSIDE_MERGES, |clusters, misses| rules.join_insides(clusters, misses));
    repeat(clusters, MERGES, |clusters, misses| rules.join_wall(clusters, &mut vessels, misses));
    repeat(clusters, MERGES, |clusters, misses| rules.join_remainder(clusters, &vessels, misses));
}

/// Applies a rule until it joins nothing more, at most so often; what it left alone in the end is noted.
fn repeat<'a>(
    clusters: &mut Clusters<'a>,
    times: usize,
    mut rule: impl FnMut(&mut Clusters<'a>, &mut Vec<Miss>) -> bool,
) {
    let mut misses = Vec::new();
    for _ in 0..times {
        misses.clear();
        if !rule(clusters, &mut misses) {
            break;
        }
    }
    clusters.history.note_misses(misses);
}

struct Rules<'a> {
    support: &'a StructureSurface,
    params: &'a params::Vessels,
}

/// What may be the wall before an inside.
struct Wall {
    id: SegmentId,
    /// Pixel pairs in which it is in front.
    in_front: u32,
    checks: Vec<Check>,
}

/// The circle of a rim, and the clusters that stand within it.
struct Rim {
    circle: RimCircle,
    members: Vec<(SegmentId, Vec<Check>)>,
    /// What is near and does not.
    others: Vec<Miss>,
}

impl Rules<'_> {
    fn top_m(&self, clusters: &Clusters<'_>, id: SegmentId) -> f64 {
        clusters.top_m(id, self.support)
    }

    /// That `id` stands no higher above `other` than rims may differ.
    fn no_higher(&self, clusters: &Clusters<'_>, id: SegmentId, other: SegmentId) -> Check {
        let above_m = self.top_m(clusters, id) - self.top_m(clusters, other);
        Check::new("its top above the other's", "m", above_m, Bound::AtMost, self.params.rim_height_m)
            .set_by(RIM_HEIGHT)
    }

    /// (i) Two concave pieces that touch are pieces of one inside.
    fn join_insides(&self, clusters: &mut Clusters<'_>, misses: &mut Vec<Miss>) -> bool {
        let space = clusters.scene.space;
        let least_touch = space.length_px(INSIDE_TOUCH_PX) as u32;
        let size = |id: SegmentId| clusters.get(id).pixels.len();
        let large: Vec<SegmentId> = clusters.alive();
        let large = large.into_iter().filter(|&id| size(id) >= space.area_px(INSIDE_PX));
        for a in large {
            for (&b, borders) in &clusters.get(a).neighbours {
                let Some(b) = b.filter(|&b| b > a && size(b) >= space.area_px(INSIDE_PX)) else { continue };
                if borders.touch < least_touch {
                    continue;
                }
                let (large, small) = if size(b) > size(a) { (b, a) } else { (a, b) };
                let convexity = [large, small].map(|id| clusters.convexity(id));
                let concave = |what, convexity, share| {
                    Check::new(what, "", convexity, Bound::AtMost, -self.params.concavity * share)
                        .set_by(CONCAVITY)
                };
                let mut checks = Checks::default();
                let is_inside =
                    checks.that(concave("how far the larger piece bends outwards", convexity[0], 1.0))
                        && checks.that(concave(
                            "how far the smaller piece bends outwards",
                            convexity[1],
                            0.5,
                        ))
                        && checks.that(self.no_higher(clusters, small, large));
                let (rule, checks) = (Rule::VesselInside, checks.0);
                if is_inside {
                    join(clusters, large, small, rule, checks, JoinEvidence::VesselInside { convexity });
                    return true;
                }
                misses.push(Miss { rule, from: Source::Cluster(small), into: Some(large), checks });
            }
        }
        false
    }

    /// (ii) An inside and what stands before it at the same height are one vessel when their rims lie on a circle, or
    /// when the inside is concave enough.
    fn join_wall(
        &self,
        clusters: &mut Clusters<'_>,
        vessels: &mut BTreeSet<SegmentId>,
        misses: &mut Vec<Miss>,
    ) -> bool {
        let space = clusters.scene.space;
        let rule = Rule::VesselWall;
        for inside in clusters.alive() {
            let is_large = clusters.get(inside).pixels.len() >= space.area_px(PART_PX);
            if !is_large || vessels.contains(&inside) {
                continue;
            }
            let convexity = clusters.convexity(inside);
            if convexity > FLAT {
                continue;
            }
            let walls = self.walls(clusters, inside, misses);
            let Some(wall) =
                walls.iter().reduce(|best, next| if next.in_front > best.in_front { next } else { best })
            else {
                continue;
            };
            let mut checks = Checks(wall.checks.clone());
            let evidence = |rim| JoinEvidence::VesselWall { convexity, wall_in_front: wall.in_front, rim };
            if let Some(Rim { circle, members, others }) = self.rim(clusters, inside, wall, &walls, misses) {
                checks.0.extend(circle_checks(&circle));
                join(clusters, wall.id, inside, rule, checks.0, evidence(Some(circle)));
                for (member, checks) in members.into_iter().filter(|(member, _)| *member != wall.id) {
                    let evidence = JoinEvidence::VesselRim { rim: circle };
                    join(clusters, wall.id, member, Rule::VesselRim, checks, evidence);
                }
                clusters.history.note_misses(others);
            } else if checks.that(
                Check::new(
                    "how far the inside bends outwards",
                    "",
                    convexity,
                    Bound::Below,
                    -self.params.concavity,
                )
                .set_by(CONCAVITY),
            ) && checks.that(Check::new(
                "wall in front of the inside along",
                "px",
                f64::from(wall.in_front),
                Bound::AtLeast,
                space.length_px(FRONT_ALONE_PX) as f64,
            )) {
                join(clusters, wall.id, inside, rule, checks.0, evidence(None));
            } else {
                misses.push(Miss {
                    rule,
                    from: Source::Cluster(inside),
                    into: Some(wall.id),
                    checks: checks.0,
                });
                continue;
            }
            vessels.insert(wall.id);
            return true;
        }
        false
    }

    /// What may be the wall before an inside.
    fn walls(&self, clusters: &Clusters<'_>, inside: SegmentId, misses: &mut Vec<Miss>) -> Vec<Wall> {
        let space = clusters.scene.space;
        let top_m = self.top_m(clusters, inside);
        let least_px = space.area_px(PART_PX);
        let mut wall = |(&other, borders): (&Option<SegmentId>, &Borders)| {
            let id = other?;
            let &Borders { in_front: behind, behind: in_front, .. } = borders;
            let size_px = clusters.get(id).pixels.len();
            if size_px < least_px || (in_front as usize) < space.length_px(FRONT_PX) {
                return None;
            }
            let mut checks = Checks::default();
            let (front, back) = (f64::from(in_front), f64::from(FRONT_RATIO * behind));
            let is_wall = checks.that(Check::new(
                "wall in front along, against 4 times behind",
                "px",
                front,
                Bound::AtLeast,
                back,
            )) && checks.that(Check::new(
                "how far the wall bends outwards",
                "",
                clusters.convexity(id),
                Bound::AtLeast,
                -FLAT,
            )) && checks.that({
                let apart_m = (self.top_m(clusters, id) - top_m).abs();
                let limit_m = self.params.rim_height_m;
                Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m).set_by(RIM_HEIGHT)
            });
            let checks = checks.0;
            if !is_wall {
                misses.push(Miss {
                    rule: Rule::VesselWall,
                    from: Source::Cluster(inside),
                    into: Some(id),
                    checks,
                });
                return None;
            }
            Some(Wall { id, in_front, checks })
        };
        clusters.get(inside).neighbours.iter().filter_map(&mut wall).collect()
    }

    /// The circle of the rim of an inside and its walls, and the clusters that stand within it, a wall or the inside's own
    /// among them.
    fn rim(
        &self,
        clusters: &Clusters<'_>,
        inside: SegmentId,
        wall: &Wall,
        walls: &[Wall],
        misses: &mut Vec<Miss>,
    ) -> Option<Rim> {
        if !self.params.rim_circle {
            return None;
        }
        let space = clusters.scene.space;
        let top_m = self.top_m(clusters, inside);
        let mut parts: Vec<SegmentId> = walls.iter().map(|wall| wall.id).chain([inside]).collect();
        let mut circle = rim_circle(clusters, &parts, top_m, self.support);
        if circle.is_err() && walls.len() > 1 {
            parts = vec![wall.id, inside];
            circle = rim_circle(clusters, &parts, top_m, self.support);
        }
        let circle = match circle {
            Ok(circle) => circle,
            Err(failed) => {
                let checks = wall.checks.iter().copied().chain(failed).collect();
                let (rule, from) = (Rule::VesselWall, Source::Cluster(inside));
                misses.push(Miss { rule, from, into: Some(wall.id), checks });
                return None;
            }
        };
        let near = parts.iter().flat_map(|&part| clusters.get(part).neighbours.keys().copied().flatten());
        let candidates: BTreeSet<SegmentId> =
            near.chain(parts.iter().copied()).filter(|&q| q != inside).collect();
        let least_touch = space.length_px(INSIDE_TOUCH_PX) as u32;
        let mut others = Vec::new();
        let mut member = |q: SegmentId| {
            let above_m = self.top_m(clusters, q) - top_m;
            let clings = || !parts.contains(&q) && clusters.borders(inside, q).touch >= least_touch;
            let limit_m = self.params.rim_height_m;
            let above = |bound, limit_m| {
                Check::new("its top above the inside's", "m", above_m, bound, limit_m).set_by(RIM_HEIGHT)
            };
            let within = || share_within(clusters, q, &circle, self.support);
            let mut checks = Checks::default();
            let is_member = checks.that(above(Bound::AtMost, limit_m))
                && (clings() || checks.that(above(Bound::AtLeast, -limit_m)))
                && checks.that(Check::new(
                    "its share within the rim",
                    "",
                    within(),
                    Bound::AtLeast,
                    WITHIN_SHARE,
                ));
            let checks = checks.0;
            if !is_member {
                let (rule, from) = (Rule::VesselRim, Source::Cluster(q));
                others.push(Miss { rule, from, into: Some(wall.id), checks });
                return None;
            }
            Some((q, checks))
        };
        let members: Vec<_> = candidates.into_iter().filter_map(&mut member).collect();
        if members.iter().any(|(q, _)| parts.contains(q)) {
            return Some(Rim { circle, members, others });
        }
        misses.append(&mut others);
        None
    }

    /// (iii) What touches hardly anything but a vessel and is much smaller belongs to it.
    fn join_remainder(
        &self,
        clusters: &mut Clusters<'_>,
        vessels: &BTreeSet<SegmentId>,
        misses: &mut Vec<Miss>,
    ) -> bool {
        let least_touch = clusters.scene.space.length_px(REMAINDER_TOUCH_PX) as u32;
        for id in clusters.alive().into_iter().filter(|id| !vessels.contains(id)) {
            let cluster = clusters.get(id);
            let all: u32 = cluster.neighbours.values().map(|borders| borders.touch).sum();
            let touched = cluster.neighbours.iter().filter_map(|(&other, borders)| {
                other.filter(|other| vessels.contains(other)).map(|other| (borders.touch, other))
            });
            let Some((touch, vessel)) =
                touched.reduce(|best, next| if next.0 > best.0 { next } else { best })
            else {
                continue;
            };
            if touch < least_touch {
                continue;
            }
            let contact_share = f64::from(touch) / f64::from(all.max(1));
            let size_share = cluster.pixels.len() as f64 / clusters.get(vessel).pixels.len() as f64;
            let mut checks = Checks::default();
            let belongs = checks.that(Check::new(
                "share of its contacts that are with the vessel",
                "",
                contact_share,
                Bound::AtLeast,
                REMAINDER_SHARE,
            )) && checks.that(Check::new(
                "its pixels over the vessel's",
                "",
                size_share,
                Bound::AtMost,
                REMAINDER_SIZE,
            )) && checks.that(self.no_higher(clusters, id, vessel));
            let (rule, checks) = (Rule::VesselRemainder, checks.0);
            if belongs {
                join(clusters, vessel, id, rule, checks, JoinEvidence::VesselRemainder { contact_share });
                return true;
            }
            misses.push(Miss { rule, from: Source::Cluster(id), into: Some(vessel), checks });
        }
        false
    }
}

/// Merges and notes why.
fn join(
    clusters: &mut Clusters<'_>,
    into: SegmentId,
    from: SegmentId,
    rule: Rule,
    checks: Vec<Check>,
    evidence: JoinEvidence,
) {
    let parts = [into, from].map(|id| clusters.part(id));
    let join = Some((Join { parts, evidence, behind: None }, None));
    clusters.give(Event { rule, from: Source::Cluster(from), into: Some(into), checks, join });
}
