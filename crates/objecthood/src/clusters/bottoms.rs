//! Bottoms: background that a plate or a bowl encloses is a part of it (ours, because otherwise a plate is
//! left as a ring).
//!
//! The bottom of a plate lies as low as the table. Its border distinguishes it from the table: the plate encloses it without a step
//! in depth. The table continues behind the things on it, with a step at every near side. It is also seen through a handle or a
//! ring, again across a step.

use std::collections::BTreeMap;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::clusters::patches::find_patches;
use crate::discovery::join::{Join, JoinEvidence};
use crate::params;
use crate::regions::SegmentId;

/// Smaller patches (px at a focal length of 525 px) are holes in a surface: they are filled but not recorded.
const BOTTOM_PX: usize = 100;
/// The vessel touches more than this share of the border: more than all other clusters together.
const MAJORITY: f64 = 0.5;

/// Gives [patches](crate::clusters::patches) of background to the cluster that encloses them. Does nothing without a support surface.
/// O(pixels log pixels).
pub(crate) fn join_bottoms(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let scene = clusters.scene;
    if scene.supports.is_empty() {
        return;
    }
    let least_px = scene.space.area_px(BOTTOM_PX);
    let mut misses = Vec::new();
    let mut gains: BTreeMap<SegmentId, Vec<u32>> = BTreeMap::new();
    for patch in find_patches(clusters) {
        // On ties the cluster with the smallest number wins.
        let touching = patch.shared.iter().filter(|(_, shared)| shared.touch > 0);
        let Some((&id, most)) = touching.rev().max_by_key(|(_, shared)| shared.touch) else { continue };
        let mut join = Proposal::new(Rule::VesselBottom, Source::Patch(patch.first()), Some(id));
        let others = patch.shared.iter().filter(|&(&other, _)| other != id).map(|(_, &shared)| shared);
        let contact_share = f64::from(most.touch) / f64::from(patch.border_without(others.sum()));
        let is_bottom = join.check(check_contact(contact_share, params))
            && join.check(check_majority(patch.share_of_border(most.touch)));
        let is_noted = patch.size_px() >= least_px;
        if !is_bottom {
            misses.extend(is_noted.then(|| join.refuse()));
            continue;
        }
        if is_noted {
            let parts = [clusters.part(id), patch.part(scene.disparity.width())];
            let evidence = JoinEvidence::VesselBottom { contact_share };
            clusters.give(join.accept(Some((Join { parts, evidence, behind: None }, None))));
        }
        gains.entry(id).or_default().extend(patch.runs.into_iter().flatten().map(|i| i as u32));
    }
    for (id, pixels) in gains {
        clusters.extend(id, &pixels);
    }
    clusters.history.note_misses(misses);
}

pub(super) fn check_contact(contact_share: f64, params: &params::Vessels) -> Check {
    let what = "share of its border without a step, but for what stands on it";
    Check::new(what, "", contact_share, Bound::AtLeast, params.bottom_contact_share)
        .set_by("vessels.bottom_contact_share")
}

pub(super) fn check_majority(share: f64) -> Check {
    Check::new("share of its border with the vessel", "", share, Bound::Above, MAJORITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::scene::Scene;
    use crate::clusters::testing::{Table, single};

    /// The number of table pixels given to each of the facets a, b, ..
    fn gained(rows: &[&str], heights_m: &[f64]) -> Vec<usize> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        let mut clusters = single(&scene);
        let sizes = |clusters: &Clusters<'_>| -> Vec<usize> {
            clusters.alive().iter().map(|&id| clusters.get(id).pixels.len()).collect()
        };
        let before = sizes(&clusters);
        join_bottoms(&mut clusters, &params::Vessels::default());
        for id in clusters.alive() {
            let pixels = &clusters.get(id).pixels;
            assert!(
                pixels.is_sorted() && pixels.iter().all(|&i| scene.facets.segments.at(i as usize).is_some())
            );
        }
        sizes(&clusters).iter().zip(before).map(|(after, before)| after - before).collect()
    }

    #[test]
    fn an_enclosed_bottom_belongs_to_the_plate() {
        let rows = ["________", "_aaaaaa_", "_aa__aa_", "_aa___a_", "_aaaaaa_", "________"];
        assert_eq!(gained(&rows, &[0.005]), [5]);
        // Across a step it is the table, seen through a ring.
        assert_eq!(gained(&rows, &[0.012]), [0]);
        // An open patch is the table, too.
        let open = ["________", "_aaaaaa_", "_aa__aa_", "_aa_____", "_aaaaaa_", "________"];
        assert_eq!(gained(&open, &[0.005]), [0]);
    }

    #[test]
    fn what_ends_in_shadow_or_at_the_edge_of_the_image_is_not_enclosed() {
        assert_eq!(gained(&["aaaaaa", "aa__aa", "aa..aa", "aaaaaa"], &[0.005]), [0]);
        assert_eq!(gained(&["aaaaaa", "aaaaaa", "aa__aa"], &[0.005]), [0]);
    }

    #[test]
    fn the_bottom_belongs_to_what_it_touches_most() {
        // A ball on a plate covers a part of its bottom.
        let rows = ["aaaaaaaa", "aa____aa", "aa_bb_aa", "aa____aa", "aaaaaaaa"];
        assert_eq!(gained(&rows, &[0.005, 0.005]), [10, 0]);
        // Things that stand on the bottom hide a part of it.
        let rows = ["aaaaaaaa", "aa____aa", "aa_bb_aa", "aa_bb_aa", "aa____aa", "aaaaaaaa"];
        assert_eq!(gained(&rows, &[0.005, 0.04]), [12, 0]);
        // A patch between two books of equal height belongs to neither.
        let rows = ["aaabbb", "aa__bb", "aaabbb"];
        assert_eq!(gained(&rows, &[0.005, 0.005]), [0, 0]);
    }

    #[test]
    fn a_wall_is_no_bottom() {
        let table = Table::drawn(&["aaaa", "a__a", "aaaa"], &[0.005]);
        for supports in [&[][..], &[7]] {
            let scene = Scene { supports, ..table.scene() };
            let mut clusters = single(&scene);
            join_bottoms(&mut clusters, &params::Vessels::default());
            assert_eq!(clusters.get(SegmentId(0)).pixels.len(), 10);
        }
    }

    #[test]
    fn a_bottom_is_noted_and_a_pinhole_is_not() {
        let plate = |hole: usize| {
            Table::new((20, 20), |u, v| {
                let within = |x: usize| (2..2 + hole).contains(&x);
                Some(if within(u) && within(v) { (0, 0.0) } else { (1, 0.005) })
            })
        };
        let table = plate(3);
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_bottoms(&mut clusters, &params::Vessels::default());
        assert_eq!((clusters.get(SegmentId(0)).pixels.len(), clusters.joins(SegmentId(0)).count()), (400, 0));

        let table = plate(10);
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_bottoms(&mut clusters, &params::Vessels::default());
        let [(join, _)] = clusters.joins(SegmentId(0)).collect::<Vec<_>>()[..] else { panic!("one bottom") };
        assert_eq!(join.evidence, JoinEvidence::VesselBottom { contact_share: 1.0 });
        assert_eq!(join.parts.map(|part| part.size_px), [300, 100]);
        // With a share above 1 there is no bottom.
        let mut clusters = single(&scene);
        let never = params::Vessels { bottom_contact_share: 1.1, ..Default::default() };
        join_bottoms(&mut clusters, &never);
        assert_eq!(clusters.joins(SegmentId(0)).count(), 0);
        let [(0, miss)] = clusters.history.misses() else { panic!("one miss") };
        assert_eq!((miss.from, miss.into), (Source::Patch(2 * 20 + 2), Some(SegmentId(0))));
        assert!(!miss.checks[0].holds() && miss.checks.len() == 1, "{miss:?}");
    }
}
