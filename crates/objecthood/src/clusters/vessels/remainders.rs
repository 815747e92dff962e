//! Rule 3: a small cluster that touches hardly anything but a vessel belongs to it (docs/CONTEXT.md 4.4.3).

use std::collections::BTreeSet;

use super::limits::Limits;
use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Miss, Proposal, Rule, Source};
use crate::discovery::join::JoinEvidence;
use crate::regions::SegmentId;

/// A remainder touches its vessel along at least this many pixel pairs (px at a focal length of 525 px).
const REMAINDER_TOUCH_PX: usize = 6;
/// Least share of its contacts that a remainder has with the vessel.
const REMAINDER_SHARE: f64 = 0.8;
/// A remainder has at most this share of the vessel's pixels.
const REMAINDER_SIZE: f64 = 0.3;

/// Joins the first remainder that it finds to its vessel, and returns whether it found one.
pub(super) fn join_remainder(
    clusters: &mut Clusters<'_>,
    limits: Limits<'_>,
    vessels: &BTreeSet<SegmentId>,
    misses: &mut Vec<Miss>,
) -> bool {
    let least_touch = clusters.scene.space.length_px(REMAINDER_TOUCH_PX) as u32;
    for id in clusters.alive().into_iter().filter(|id| !vessels.contains(id)) {
        let Some((vessel, touch)) = find_nearest_vessel(clusters, id, vessels) else { continue };
        if touch < least_touch {
            continue;
        }
        let cluster = clusters.get(id);
        let all: u32 = cluster.neighbours.values().map(|borders| borders.touch).sum();
        let contact_share = f64::from(touch) / f64::from(all.max(1));
        let size_share = cluster.pixels.len() as f64 / clusters.get(vessel).pixels.len() as f64;
        let check = |what, share, bound, limit| Check::new(what, "", share, bound, limit);
        let of_contacts = "share of its contacts that are with the vessel";
        let mut join = Proposal::new(Rule::VesselRemainder, Source::Cluster(id), Some(vessel));
        let is_remainder = join.check(check(of_contacts, contact_share, Bound::AtLeast, REMAINDER_SHARE))
            && join.check(check("its pixels over the vessel's", size_share, Bound::AtMost, REMAINDER_SIZE))
            && join.check(limits.check_no_higher(clusters, id, vessel))
            && join.check(limits.check_color(clusters, id, &[vessel]));
        if is_remainder {
            clusters.join(join, JoinEvidence::VesselRemainder { contact_share });
            return true;
        }
        misses.push(join.refuse());
    }
    false
}

/// The vessel that a cluster touches most, on ties the first one, and the number of touching pixel pairs.
fn find_nearest_vessel(
    clusters: &Clusters<'_>,
    id: SegmentId,
    vessels: &BTreeSet<SegmentId>,
) -> Option<(SegmentId, u32)> {
    let touched = clusters.get(id).neighbours.iter().filter_map(|(&other, borders)| {
        other.filter(|other| vessels.contains(other)).map(|other| (other, borders.touch))
    });
    touched.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::testing::{Table, named, single};
    use crate::color::image::LabImage;
    use crate::params;

    #[test]
    fn what_touches_only_the_vessel_belongs_to_it_unless_its_colors_are_others() {
        let facet = |u: usize, v: usize| match (u, v) {
            (12..20, 12..20) => 2,
            (4..28, 4..28) => 1,
            _ => 0,
        };
        let mut table =
            Table::new((32, 32), |u, v| Some((facet(u, v), [0.0, 0.05, 0.053][facet(u, v) as usize])));
        let colors = [[30.0, 0.0, 0.0], [50.0, 50.0, 30.0], [40.0, 10.0, -40.0]];
        for (lab, expected) in [(false, vec![Some(0); 2]), (true, vec![Some(0), Some(1)])] {
            table.lab = lab.then(|| LabImage::drawn((32, 32), |u, v| colors[facet(u, v) as usize]));
            let scene = table.scene();
            let mut clusters = single(&scene);
            let limits = Limits { support: scene.ground().unwrap(), params: &params::Vessels::default() };
            let mut misses = Vec::new();
            join_remainder(&mut clusters, limits, &BTreeSet::from([SegmentId(0)]), &mut misses);
            assert_eq!(named(&clusters), expected, "{misses:?}");
        }
    }
}
