//! Rule 2: an inside and the wall in front of it are one vessel (docs/CONTEXT.md 4.4.2).
//!
//! Their tops are equally high. They are joined when their rims lie on one circle, or else when the inside is concave enough. If there
//! is a circle, the other clusters within it are joined to them too.

use std::collections::BTreeSet;

use super::limits::{CONCAVITY, INSIDE_TOUCH_PX, Limits, PART_PX, RIM_HEIGHT};
use super::piece::Piece;
use crate::check::{Bound, Check};
use crate::clusters::borders::BorderCounts;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::clusters::rim::{check_circle, fit_rim_circle, measure_share_within};
use crate::clusters::scene::sampled;
use crate::discovery::join::{JoinEvidence, RimCircle};
use crate::hull::Hull;
use crate::oversegment::structure::StructureSurface;
use crate::regions::SegmentId;

/// The convexity of an inside is at most this. That of a wall is at least minus this; what bends inwards by
/// more is hollow, and what bends outwards by more is round.
pub(in crate::clusters) const FLAT: f64 = 0.1;
/// A wall is in front of the inside along at least this many pixel pairs (px at 525 px).
const FRONT_PX: usize = 8;
/// A wall is in front of the inside at least this many times as often as behind it.
const FRONT_RATIO: u32 = 4;
/// Without a circle, the wall is in front of the inside along at least this many pixel pairs (px at 525 px).
const FRONT_ALONE_PX: usize = 12;
/// Less than this share of a wall's pixels lies within the outline of the inside: what lies there is
/// contents.
const SURROUNDED_SHARE: f64 = 0.5;
/// Least share of a part's pixels within the circle of the vessel's rim.
const WITHIN_SHARE: f64 = 0.8;

/// A cluster that may be the wall in front of an inside.
struct Wall {
    id: SegmentId,
    /// Number of pixel pairs in which it is in front.
    in_front: u32,
    /// The proposal to give the inside to it.
    join: Proposal,
}

/// The circle of a rim, and the clusters near it.
struct Rim {
    circle: RimCircle,
    /// The clusters within it, each with the proposal to give it to the wall.
    members: Vec<(SegmentId, Proposal)>,
    /// The refusals of the other clusters.
    others: Vec<Miss>,
}

/// Joins the first inside that it finds to its wall, and returns whether it found one. The wall is added to `vessels` and is not
/// tried as an inside any more.
pub(super) fn join_wall(
    clusters: &mut Clusters<'_>,
    limits: Limits<'_>,
    vessels: &mut BTreeSet<SegmentId>,
    misses: &mut Vec<Miss>,
) -> bool {
    for inside in clusters.alive().into_iter().filter(|id| !vessels.contains(id)) {
        if !is_inside(clusters, inside) {
            continue;
        }
        let mut walls = find_walls(clusters, limits, inside, misses);
        if walls.is_empty() {
            continue;
        }
        let round = Piece::of(clusters, limits.support, inside);
        if let Some(round) = &round {
            walls = keep_own(clusters, limits.support, round, walls, misses);
        }
        // On ties the first wall wins.
        let foremost =
            walls.iter().reduce(|best, next| if next.in_front > best.in_front { next } else { best });
        let Some(wall) = foremost else { continue };
        let search = RimSearch { clusters, limits, inside, round: round.as_ref(), wall, walls: &walls };
        let is_joined = match search.find_rim(misses) {
            Some(rim) => {
                join_within_rim(clusters, inside, wall, rim);
                true
            }
            None => join_concave(clusters, limits, inside, wall, misses),
        };
        if is_joined {
            vessels.insert(wall.id);
            return true;
        }
    }
    false
}

/// Whether a cluster may be an inside: it is large and hardly bends outwards.
fn is_inside(clusters: &Clusters<'_>, id: SegmentId) -> bool {
    clusters.get(id).pixels.len() >= clusters.scene.space.area_px(PART_PX) && clusters.convexity(id) <= FLAT
}

/// Joins to the wall the inside and the other clusters within the circle of the rim.
fn join_within_rim(clusters: &mut Clusters<'_>, inside: SegmentId, wall: &Wall, found: Rim) {
    let Rim { circle, members, others } = found;
    let (convexity, wall_in_front) = (clusters.convexity(inside), wall.in_front);
    let mut join = wall.join.clone();
    join.extend(check_circle(&circle));
    clusters.join(join, JoinEvidence::VesselWall { convexity, wall_in_front, rim: Some(circle) });
    for (_, join) in members.into_iter().filter(|(member, _)| *member != wall.id) {
        clusters.join(join, JoinEvidence::VesselRim { rim: circle });
    }
    clusters.history.note_misses(others);
}

/// Joins an inside to the wall if it is concave enough to need no circle. Returns whether it did.
fn join_concave(
    clusters: &mut Clusters<'_>,
    limits: Limits<'_>,
    inside: SegmentId,
    wall: &Wall,
    misses: &mut Vec<Miss>,
) -> bool {
    let (convexity, wall_in_front) = (clusters.convexity(inside), wall.in_front);
    let most = -limits.params.concavity;
    let least_front = clusters.scene.space.length_px(FRONT_ALONE_PX) as f64;
    let front = f64::from(wall_in_front);
    let mut join = wall.join.clone();
    let is_joined = join.check(
        Check::new("how far the inside bends outwards", "", convexity, Bound::Below, most).set_by(CONCAVITY),
    ) && join.check(Check::new(
        "wall in front of the inside along",
        "px",
        front,
        Bound::AtLeast,
        least_front,
    ));
    if is_joined {
        clusters.join(join, JoinEvidence::VesselWall { convexity, wall_in_front, rim: None });
    } else {
        misses.push(join.refuse());
    }
    is_joined
}

/// The neighbours of an inside that may be the wall in front of it, by ascending number.
fn find_walls(
    clusters: &Clusters<'_>,
    limits: Limits<'_>,
    inside: SegmentId,
    misses: &mut Vec<Miss>,
) -> Vec<Wall> {
    let space = clusters.scene.space;
    let (least_px, least_front) = (space.area_px(PART_PX), space.length_px(FRONT_PX));
    let outline = Hull::of(&clusters.get(inside).pixels, clusters.scene.disparity.width());
    let mut walls = Vec::new();
    for (&other, borders) in &clusters.get(inside).neighbours {
        // The counts are seen from the inside, so they are swapped for the wall.
        let &BorderCounts { in_front: behind, behind: in_front, .. } = borders;
        let Some(id) = other else { continue };
        if clusters.get(id).pixels.len() < least_px || (in_front as usize) < least_front {
            continue;
        }
        let mut join = Proposal::new(Rule::VesselWall, Source::Cluster(inside), Some(id));
        let is_wall = join.check(check_in_front(in_front, behind))
            && join.check(Check::new(
                "how far the wall bends outwards",
                "",
                clusters.convexity(id),
                Bound::AtLeast,
                -FLAT,
            ))
            && join.check(check_level(clusters, limits, id, inside))
            && join.check(check_around(clusters, id, &outline));
        if is_wall {
            walls.push(Wall { id, in_front, join });
        } else {
            misses.push(join.refuse());
        }
    }
    walls
}

fn check_in_front(in_front: u32, behind: u32) -> Check {
    let (front, back) = (f64::from(in_front), f64::from(FRONT_RATIO * behind));
    Check::new("wall in front along, against 4 times behind", "px", front, Bound::AtLeast, back)
}

fn check_level(clusters: &Clusters<'_>, limits: Limits<'_>, wall: SegmentId, inside: SegmentId) -> Check {
    let apart_m = (limits.top_m(clusters, wall) - limits.top_m(clusters, inside)).abs();
    let limit_m = limits.params.rim_height_m;
    Check::new("difference of the tops", "m", apart_m, Bound::AtMost, limit_m).set_by(RIM_HEIGHT)
}

/// Checks that a cluster lies before the inside and not in it: the rim bounds in the image what is seen of the inside, the wall lies
/// beyond it.
fn check_around(clusters: &Clusters<'_>, wall: SegmentId, outline: &Hull) -> Check {
    let (within, all) = sampled(&clusters.get(wall).pixels)
        .fold((0, 0), |(within, all), i| (within + u32::from(outline.contains(i)), all + 1));
    let share = f64::from(within) / f64::from(all.max(1));
    Check::new(
        "share of the wall within the outline of the inside",
        "",
        share,
        Bound::Below,
        SURROUNDED_SHARE,
    )
}

/// The walls of a round inside that are its own. A bowl in a bowl has the inside of the outer one around it, and the wall beyond that is the outer
/// one's.
fn keep_own(
    clusters: &Clusters<'_>,
    support: &StructureSurface,
    round: &Piece,
    walls: Vec<Wall>,
    misses: &mut Vec<Miss>,
) -> Vec<Wall> {
    let is_concave = |id: &SegmentId| clusters.convexity(*id) < -FLAT;
    let beside = clusters.get(round.id).neighbours.keys().copied().flatten().filter(is_concave);
    let beyond_m = beside.filter_map(|id| round.beyond_m(clusters, support, id));
    let outer_m = beyond_m.filter(|&beyond_m| beyond_m > round.most_beyond_m()).reduce(f64::min);
    let Some(outer_m) = outer_m else { return walls };
    let mut own = Vec::new();
    for mut wall in walls {
        let what = "wall beyond the inside; limit: another inside beyond it";
        let is_nearer = |beyond_m| wall.join.check(Check::new(what, "m", beyond_m, Bound::Below, outer_m));
        if round.beyond_m(clusters, support, wall.id).is_none_or(is_nearer) {
            own.push(wall);
        } else {
            misses.push(wall.join.refuse());
        }
    }
    own
}

/// The search for the rim of one inside.
struct RimSearch<'a> {
    clusters: &'a Clusters<'a>,
    limits: Limits<'a>,
    inside: SegmentId,
    /// The same, if it is round.
    round: Option<&'a Piece>,
    /// The foremost wall.
    wall: &'a Wall,
    /// All walls.
    walls: &'a [Wall],
}

impl RimSearch<'_> {
    /// The circle of the rim and the clusters within it, if a wall is within it; other clusters are noted as refused.
    fn find_rim(&self, misses: &mut Vec<Miss>) -> Option<Rim> {
        if !self.limits.params.rim_circle {
            return None;
        }
        let (parts, circle) = match self.fit_circle() {
            Ok(found) => found,
            Err(failed) => {
                let mut join = self.wall.join.clone();
                join.extend(failed);
                misses.push(join.refuse());
                return None;
            }
        };
        let (mut members, mut others) = (Vec::new(), Vec::new());
        for id in self.near(&parts) {
            let mut join = Proposal::new(Rule::VesselRim, Source::Cluster(id), Some(self.wall.id));
            if self.is_within(id, &parts, &circle, &mut join) {
                members.push((id, join));
            } else {
                others.push(join.refuse());
            }
        }
        if members.iter().any(|(id, _)| parts.contains(id)) {
            return Some(Rim { circle, members, others });
        }
        misses.append(&mut others);
        None
    }

    /// The circle through the rims of the inside and of all walls; if that fails, of the inside and the foremost wall only. Returned with
    /// these parts.
    ///
    /// # Errors
    /// The checks of the last circle; one of them fails.
    fn fit_circle(&self) -> Result<(Vec<SegmentId>, RimCircle), Vec<Check>> {
        let top_m = self.limits.top_m(self.clusters, self.inside);
        let fit = |parts: Vec<SegmentId>| {
            let circle = fit_rim_circle(self.clusters, &parts, top_m, self.limits.support)?;
            Ok((parts, circle))
        };
        let all = fit(self.walls.iter().map(|wall| wall.id).chain([self.inside]).collect());
        if self.walls.len() > 1 { all.or_else(|_| fit(vec![self.wall.id, self.inside])) } else { all }
    }

    /// The parts and their neighbours except the inside, by ascending number.
    fn near(&self, parts: &[SegmentId]) -> BTreeSet<SegmentId> {
        let beside = |&part: &SegmentId| self.clusters.get(part).neighbours.keys().copied().flatten();
        let near = parts.iter().flat_map(beside).chain(parts.iter().copied());
        near.filter(|&id| id != self.inside).collect()
    }

    /// Whether a cluster stands within the circle and its top is as high as the inside's. The top of a cluster that clings to the inside
    /// may be lower. What is no wall has the colours of the inside or of the foremost wall, else it is a content.
    fn is_within(&self, id: SegmentId, parts: &[SegmentId], circle: &RimCircle, join: &mut Proposal) -> bool {
        let &Self { clusters, limits, inside, .. } = self;
        let above_m = limits.top_m(clusters, id) - limits.top_m(clusters, inside);
        let least_touch = clusters.scene.space.length_px(INSIDE_TOUCH_PX) as u32;
        let clings = || !parts.contains(&id) && clusters.borders(inside, id).touch >= least_touch;
        let check_above = |bound, limit_m| {
            Check::new("its top above the inside's", "m", above_m, bound, limit_m).set_by(RIM_HEIGHT)
        };
        let share = || measure_share_within(clusters, id, circle, limits.support);
        let most_m = limits.params.rim_height_m;
        join.check(check_above(Bound::AtMost, most_m))
            && (clings() || join.check(check_above(Bound::AtLeast, -most_m)))
            && join.check(Check::new("its share within the rim", "", share(), Bound::AtLeast, WITHIN_SHARE))
            && (parts.contains(&id)
                || join.check(limits.check_color(clusters, id, &[inside, self.wall.id]))
                    && self.check_no_content(id).is_none_or(|check| join.check(check)))
    }

    /// Checks that a cluster does not lie within the surface of a round inside.
    fn check_no_content(&self, id: SegmentId) -> Option<Check> {
        let round = self.round?;
        let within_m = -round.beyond_m(self.clusters, self.limits.support, id)?;
        let what = "how far it lies within the surface of revolution of the inside";
        Some(Check::new(what, "m", within_m, Bound::Below, round.most_beyond_m()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, single};

    #[test]
    fn a_wall_lies_before_the_inside_and_a_content_in_it() {
        let rows = [
            "____________", //
            "__aaaaaaaa__",
            "__aabbbbaa__",
            "__aabbbbaa__",
            "__aaaaaaaa__",
            "__cccccccc__",
            "___cccccc___",
        ];
        let table = Table::drawn(&rows, &[0.02, 0.03, 0.02]);
        let scene = table.scene();
        let clusters = single(&scene);
        let [inside, content, wall] = [0, 1, 2].map(SegmentId);
        let outline = Hull::of(&clusters.get(inside).pixels, 12);
        let [content, wall] = [content, wall].map(|id| check_around(&clusters, id, &outline));
        assert_eq!((content.measured, content.holds()), (1.0, false));
        assert_eq!((wall.measured, wall.holds()), (0.0, true));
    }
}
