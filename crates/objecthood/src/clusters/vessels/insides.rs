//! Rule 1: concave pieces that touch are one inside (docs/CONTEXT.md 4.4.1).

use super::limits::{INSIDE_TOUCH_PX, Limits};
use super::piece::check_on;
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::discovery::join::JoinEvidence;
use crate::regions::SegmentId;

/// Least number of pixels of a piece of an inside (px at a focal length of 525 px).
const INSIDE_PX: usize = 60;
/// The smaller piece needs this share of the concavity that the larger one needs.
const SMALLER_SHARE: f64 = 0.5;

/// Joins the first two pieces of one inside that it finds, and returns whether it found any. Both are
/// concave. The smaller one is higher than the larger one by at most the difference of tops within a vessel.
/// If the larger one is round, the smaller one lies on its surface.
pub(super) fn join_insides(clusters: &mut Clusters<'_>, limits: Limits<'_>, misses: &mut Vec<Miss>) -> bool {
    for [large, small] in touching_pairs(clusters) {
        let convexity = [large, small].map(|id| clusters.convexity(id));
        let mut join = Proposal::new(Rule::VesselInside, Source::Cluster(small), Some(large));
        let is_inside =
            join.check(limits.check_concave("how far the larger piece bends outwards", convexity[0], 1.0))
                && join.check(limits.check_concave(
                    "how far the smaller piece bends outwards",
                    convexity[1],
                    SMALLER_SHARE,
                ))
                && join.check(limits.check_no_higher(clusters, small, large))
                && join.check(limits.check_color(clusters, small, &[large]))
                && check_on(clusters, limits.support, large, small).is_none_or(|check| join.check(check));
        if is_inside {
            clusters.join(join, JoinEvidence::VesselInside { convexity });
            return true;
        }
        misses.push(join.refuse());
    }
    false
}

/// The pairs of large clusters that touch, ordered by ascending numbers. In each pair the larger cluster comes first, on ties the one
/// with the smaller number.
pub(super) fn touching_pairs(clusters: &Clusters<'_>) -> Vec<[SegmentId; 2]> {
    let space = clusters.scene.space;
    let (least_px, least_touch) = (space.area_px(INSIDE_PX), space.length_px(INSIDE_TOUCH_PX) as u32);
    let size = |id: SegmentId| clusters.get(id).pixels.len();
    let mut pairs = Vec::new();
    for a in clusters.alive().into_iter().filter(|&id| size(id) >= least_px) {
        for (&b, borders) in &clusters.get(a).neighbours {
            let Some(b) = b.filter(|&b| b > a && size(b) >= least_px) else { continue };
            if borders.touch >= least_touch {
                pairs.push(if size(b) > size(a) { [b, a] } else { [a, b] });
            }
        }
    }
    pairs
}
