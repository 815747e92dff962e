//! Bottoms: what lies as low as the table within a plate or a bowl is a part of it (ours, because a plate came out as a
//! ring).
//!
//! A patch of background that an object encloses, without a step in depth between them, is no table: the table goes on
//! behind what stands on it, with a step at every near side. Through a handle or a ring it is seen across such a step.

use std::collections::BTreeMap;

use crate::facets::Facets;
use crate::objectness::check::{Bound, Check, Checks};
use crate::objectness::clusters::{Clusters, Scene};
use crate::objectness::history::{Event, Miss, Rule, Source};
use crate::objectness::join::{Join, JoinEvidence, JoinedPart};
use crate::objectness::objects::pixel_box;
use crate::oversegment::watershed::neighbours;
use crate::params;
use crate::raster::Raster;
use crate::regions::SegmentId;

/// Who a pixel belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// Not measured, or of a wall.
    Nobody,
    Background,
    /// Background that has been looked at.
    Visited,
    Cluster(SegmentId),
}

/// A connected piece of background.
#[derive(Default)]
struct Patch {
    pixels: Vec<u32>,
    /// Sides of its pixels beyond which it ends.
    border: u32,
    /// Those without a step in depth, by cluster.
    touch: BTreeMap<SegmentId, u32>,
}

/// A smaller step in depth (m) is none: the edge of the thinnest thing that is told from the table.
const STEP_M: f64 = 0.01;
/// Smaller patches (px at a focal length of 525 px) are holes in a surface: they are filled without a word.
const BOTTOM_PX: usize = 100;

/// Gives patches of the support, and of what was found to be a part of it, to the object that encloses them. Beyond a step,
/// or when depths differ by more than 1 cm, nothing touches. Without a support surface nothing is done.
/// O(pixels + patches · clusters).
pub(crate) fn join_bottoms(clusters: &mut Clusters<'_>, support: Option<usize>, params: &params::Vessels) {
    let Some(support) = support else { return };
    let scene = clusters.scene;
    let least_px = scene.space.area_px(BOTTOM_PX);
    let mut owners = owners(clusters, support);
    let mut misses = Vec::new();
    let mut gains: BTreeMap<SegmentId, Vec<u32>> = BTreeMap::new();
    for start in 0..owners.len() {
        if owners[start] != Owner::Background {
            continue;
        }
        let Patch { pixels, border, touch } = scene.patch(start, &mut owners);
        // The first of those touched most.
        let Some((&id, &most)) = touch.iter().rev().max_by_key(|(_, touch)| **touch) else { continue };
        let contact_share = f64::from(touch.values().sum::<u32>()) / f64::from(border);
        let mut checks = Checks::default();
        let share = |of: u32| f64::from(of) / f64::from(border);
        let is_bottom = checks.that(
            Check::new(
                "share of its border without a step",
                "",
                contact_share,
                Bound::AtLeast,
                params.bottom_contact_share,
            )
            .set_by("vessels.bottom_contact_share"),
        ) && checks.that(Check::new(
            "share of its border with the vessel",
            "",
            share(most),
            Bound::Above,
            0.5,
        ));
        let is_noted = pixels.len() >= least_px;
        let (rule, from) = (Rule::VesselBottom, Source::Patch(start as u32));
        if !is_bottom {
            misses.extend(is_noted.then_some(Miss { rule, from, into: Some(id), checks: checks.0 }));
            continue;
        }
        if is_noted {
            let box_px = pixel_box(pixels.iter().map(|&i| i as usize), scene.disparity.width());
            let parts = [clusters.part(id), JoinedPart { size_px: pixels.len(), box_px }];
            let join = Join { parts, evidence: JoinEvidence::VesselBottom { contact_share }, behind: None };
            clusters.give(Event { rule, from, into: Some(id), checks: checks.0, join: Some((join, None)) });
        }
        gains.entry(id).or_default().extend(pixels);
    }
    for (id, pixels) in gains {
        clusters.extend(id, &pixels);
    }
    clusters.note_misses(misses);
}

fn owners(clusters: &Clusters<'_>, support: usize) -> Raster<Owner> {
    let Facets { segments, structure, .. } = clusters.scene.facets;
    let owner = |facet: usize| match facet.checked_sub(*structure) {
        None if facet == support => Owner::Background,
        None => Owner::Nobody,
        Some(free) => clusters.of_facet(free).map_or(Owner::Background, Owner::Cluster),
    };
    segments.labels().map(|&facet| usize::try_from(facet).map_or(Owner::Nobody, owner))
}

impl Scene<'_> {
    fn touch(&self, i: usize, j: usize) -> bool {
        let [d_i, d_j] = [i, j].map(|i| self.disparity[i]);
        let [z_i, z_j] = [d_i, d_j].map(|d| self.space.depth_m(d.into()));
        (d_i - d_j).abs() <= self.steps.touch_quanta && (z_i - z_j).abs() <= STEP_M
    }

    /// The patch that holds `start`, which is marked as visited.
    fn patch(&self, start: usize, owners: &mut Raster<Owner>) -> Patch {
        let (width, height) = owners.size();
        let owners = owners.as_mut_slice();
        owners[start] = Owner::Visited;
        let mut patch = Patch { pixels: vec![start as u32], ..Patch::default() };
        let mut looked_at = 0;
        while let Some(&i) = patch.pixels.get(looked_at) {
            let i = i as usize;
            looked_at += 1;
            let mut inside = 0;
            for (j, _) in neighbours(i, width, height) {
                match owners[j] {
                    Owner::Visited => inside += 1,
                    Owner::Background => {
                        inside += 1;
                        owners[j] = Owner::Visited;
                        patch.pixels.push(j as u32);
                    }
                    Owner::Cluster(id) if self.touch(i, j) => *patch.touch.entry(id).or_default() += 1,
                    Owner::Cluster(_) | Owner::Nobody => {}
                }
            }
            patch.border += 4 - inside;
        }
        patch
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objectness::testing::{Table, single};

    /// How many pixels of the table each of the facets a, b, .. gets.
    fn gained(rows: &[&str], heights_m: &[f64]) -> Vec<usize> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        let mut clusters = single(&scene);
        let sizes = |clusters: &Clusters<'_>| -> Vec<usize> {
            clusters.alive().iter().map(|&id| clusters.get(id).pixels.len()).collect()
        };
        let before = sizes(&clusters);
        join_bottoms(&mut clusters, Some(0), &params::Vessels::default());
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
        // Beyond a step it is the table, seen through a ring.
        assert_eq!(gained(&rows, &[0.012]), [0]);
        // And where it is open it is the table as well.
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
        // Between two books of one height it is neither's.
        let rows = ["aaabbb", "aa__bb", "aaabbb"];
        assert_eq!(gained(&rows, &[0.005, 0.005]), [0, 0]);
    }

    #[test]
    fn a_wall_is_no_bottom() {
        let table = Table::drawn(&["aaaa", "a__a", "aaaa"], &[0.005]);
        let scene = table.scene();
        let mut clusters = single(&scene);
        for support in [None, Some(7)] {
            join_bottoms(&mut clusters, support, &params::Vessels::default());
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
        join_bottoms(&mut clusters, Some(0), &params::Vessels::default());
        assert_eq!((clusters.get(SegmentId(0)).pixels.len(), clusters.joins(SegmentId(0)).count()), (400, 0));

        let table = plate(10);
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_bottoms(&mut clusters, Some(0), &params::Vessels::default());
        let [(join, _)] = clusters.joins(SegmentId(0)).collect::<Vec<_>>()[..] else { panic!("one bottom") };
        assert_eq!(join.evidence, JoinEvidence::VesselBottom { contact_share: 1.0 });
        assert_eq!(join.parts.map(|part| part.size_px), [300, 100]);
        // Above 1 it never is.
        let mut clusters = single(&scene);
        let never = params::Vessels { bottom_contact_share: 1.1, ..Default::default() };
        join_bottoms(&mut clusters, Some(0), &never);
        assert_eq!(clusters.joins(SegmentId(0)).count(), 0);
        let [(0, miss)] = clusters.misses() else { panic!("one miss") };
        assert_eq!((miss.from, miss.into), (Source::Patch(2 * 20 + 2), Some(SegmentId(0))));
        assert!(!miss.checks[0].holds() && miss.checks.len() == 1, "{miss:?}");
    }
}
