//! Vessels: an inside and a wall that no convexity could join (METHOD 3.12).
//!
//! A vessel shows the far side of its inside and the near side of its wall, with the rim as a step in depth between them. They are known
//! by a concave inside, by equal height, and by the circle on which the rim lies.

use std::collections::BTreeSet;

use crate::objectness::clusters::{Borders, Clusters};
use crate::objectness::join::{Join, JoinEvidence, RimCircle};
use crate::objectness::rim::{rim_circle, share_within};
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

/// Joins the parts of vessels. Without a support surface, or with `concavity` 0, nothing is done.
/// O(merges · clusters · neighbours + the pixels of every inside and its walls that are tried, up to 12 times).
pub(crate) fn join_vessels(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let Some(support) = clusters.scene.support.filter(|_| params.concavity > 0.0) else { return };
    let rules = Rules { support, params };
    for _ in 0..INSIDE_MERGES {
        if !rules.join_insides(clusters) {
            break;
        }
    }
    let mut vessels = BTreeSet::new();
    for _ in 0..MERGES {
        if !rules.join_wall(clusters, &mut vessels) {
            break;
        }
    }
    for _ in 0..MERGES {
        if !rules.join_remainder(clusters, &vessels) {
            break;
        }
    }
}

struct Rules<'a> {
    support: &'a StructureSurface,
    params: &'a params::Vessels,
}

impl Rules<'_> {
    fn top_m(&self, clusters: &Clusters<'_>, id: SegmentId) -> f64 {
        clusters.top_m(id, self.support)
    }

    /// (i) Two concave pieces that touch are pieces of one inside.
    fn join_insides(&self, clusters: &mut Clusters<'_>) -> bool {
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
                if convexity[0] <= -self.params.concavity
                    && convexity[1] <= -self.params.concavity / 2.0
                    && self.top_m(clusters, small) <= self.top_m(clusters, large) + self.params.rim_height_m
                {
                    merge(clusters, large, small, JoinEvidence::VesselInside { convexity });
                    return true;
                }
            }
        }
        false
    }

    /// (ii) An inside and what stands before it at the same height are one vessel when their rims lie on a circle, or
    /// when the inside is concave enough.
    fn join_wall(&self, clusters: &mut Clusters<'_>, vessels: &mut BTreeSet<SegmentId>) -> bool {
        let space = clusters.scene.space;
        for inside in clusters.alive() {
            let convexity = clusters.convexity(inside);
            let is_large = clusters.get(inside).pixels.len() >= space.area_px(PART_PX);
            if !is_large || vessels.contains(&inside) || convexity > FLAT {
                continue;
            }
            let walls = self.walls(clusters, inside);
            let Some(&(front, wall)) =
                walls.iter().reduce(|best, next| if next.0 > best.0 { next } else { best })
            else {
                continue;
            };
            let evidence = |rim| JoinEvidence::VesselWall { convexity, wall_in_front: front, rim };
            if let Some((rim, members)) = self.rim(clusters, inside, wall, &walls) {
                merge(clusters, wall, inside, evidence(Some(rim)));
                for member in members.into_iter().filter(|&member| member != wall) {
                    merge(clusters, wall, member, JoinEvidence::VesselRim { rim });
                }
            } else if convexity < -self.params.concavity && front as usize >= space.length_px(FRONT_ALONE_PX)
            {
                merge(clusters, wall, inside, evidence(None));
            } else {
                continue;
            }
            vessels.insert(wall);
            return true;
        }
        false
    }

    /// What may be the wall before an inside, with the number of pixel pairs in which it is in front.
    fn walls(&self, clusters: &Clusters<'_>, inside: SegmentId) -> Vec<(u32, SegmentId)> {
        let space = clusters.scene.space;
        let top_m = self.top_m(clusters, inside);
        let is_wall = |(&other, borders): (&Option<SegmentId>, &Borders)| {
            let other = other?;
            let &Borders { in_front, behind, .. } = borders;
            let is_wall = clusters.get(other).pixels.len() >= space.area_px(PART_PX)
                && clusters.convexity(other) >= -FLAT
                && behind as usize >= space.length_px(FRONT_PX)
                && behind >= FRONT_RATIO * in_front
                && (self.top_m(clusters, other) - top_m).abs() <= self.params.rim_height_m;
            is_wall.then_some((behind, other))
        };
        clusters.get(inside).neighbours.iter().filter_map(is_wall).collect()
    }

    /// The circle of the rim of an inside and its walls, and the clusters that stand within it, a wall or the inside's own
    /// among them.
    fn rim(
        &self,
        clusters: &Clusters<'_>,
        inside: SegmentId,
        wall: SegmentId,
        walls: &[(u32, SegmentId)],
    ) -> Option<(RimCircle, Vec<SegmentId>)> {
        if !self.params.rim_circle {
            return None;
        }
        let space = clusters.scene.space;
        let top_m = self.top_m(clusters, inside);
        let mut parts: Vec<SegmentId> = walls.iter().map(|&(_, wall)| wall).chain([inside]).collect();
        let mut rim = rim_circle(clusters, &parts, top_m, self.support);
        if rim.is_none() && walls.len() > 1 {
            parts = vec![wall, inside];
            rim = rim_circle(clusters, &parts, top_m, self.support);
        }
        let rim = rim?;
        let near = parts.iter().flat_map(|&part| clusters.get(part).neighbours.keys().copied().flatten());
        let candidates: BTreeSet<SegmentId> =
            near.chain(parts.iter().copied()).filter(|&q| q != inside).collect();
        let least_touch = space.length_px(INSIDE_TOUCH_PX) as u32;
        let is_member = |&q: &SegmentId| {
            let above_m = self.top_m(clusters, q) - top_m;
            let clings = !parts.contains(&q) && clusters.borders(inside, q).touch >= least_touch;
            above_m <= self.params.rim_height_m
                && (above_m >= -self.params.rim_height_m || clings)
                && share_within(clusters, q, &rim, self.support) >= WITHIN_SHARE
        };
        let members: Vec<SegmentId> = candidates.into_iter().filter(is_member).collect();
        members.iter().any(|q| parts.contains(q)).then_some((rim, members))
    }

    /// (iii) What touches hardly anything but a vessel and is much smaller belongs to it.
    fn join_remainder(&self, clusters: &mut Clusters<'_>, vessels: &BTreeSet<SegmentId>) -> bool {
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
            let contact_share = f64::from(touch) / f64::from(all.max(1));
            let size_share = cluster.pixels.len() as f64 / clusters.get(vessel).pixels.len() as f64;
            if touch >= least_touch
                && contact_share >= REMAINDER_SHARE
                && size_share <= REMAINDER_SIZE
                && self.top_m(clusters, id) <= self.top_m(clusters, vessel) + self.params.rim_height_m
            {
                merge(clusters, vessel, id, JoinEvidence::VesselRemainder { contact_share });
                return true;
            }
        }
        false
    }
}

/// Merges and notes why.
fn merge(clusters: &mut Clusters<'_>, into: SegmentId, from: SegmentId, evidence: JoinEvidence) {
    let parts = [into, from].map(|id| clusters.part(id));
    clusters.merge(Some(into), from);
    clusters.note(into, Join { parts, evidence, behind: None }, None);
}
