//! Bottoms: what lies as low as the table within a plate or a bowl is a part of it (ours, because a plate came out as a
//! ring).
//!
//! A patch of background that an object encloses, without a step in depth between them, is no table: the table goes on
//! behind what stands on it, with a step at every near side. Through a handle or a ring it is seen across such a step.

use std::collections::BTreeMap;

use crate::facets::Facets;
use crate::objectness::clusters::Clusters;
use crate::objectness::join::{Join, JoinEvidence, JoinedPart};
use crate::objectness::objects::pixel_box;
use crate::oversegment::watershed::neighbours;
use crate::params;
use crate::raster::Raster;
use crate::regions::SegmentId;

/// Who a pixel belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// Not measured, or of no surface.
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

/// Gives patches of background to the object that encloses them. Neighbours further apart than `jump_quanta` do not
/// touch. O(pixels).
pub(crate) fn join_bottoms(clusters: &mut Clusters<'_>, jump_quanta: f32, params: &params::Vessels) {
    let scene = clusters.scene;
    let mut owners = owners(clusters);
    for start in 0..owners.len() {
        if owners[start] != Owner::Background {
            continue;
        }
        let Patch { pixels, border, touch } = patch(start, &mut owners, scene.disparity, jump_quanta);
        // The first of those touched most.
        let Some((&id, &most)) = touch.iter().rev().max_by_key(|(_, touch)| **touch) else { continue };
        let contact_share = f64::from(touch.values().sum::<u32>()) / f64::from(border);
        if contact_share >= params.bottom_contact_share && 2 * most > border {
            let box_px = pixel_box(pixels.iter().map(|&i| i as usize), scene.disparity.width());
            let parts = [clusters.part(id), JoinedPart { size_px: pixels.len(), box_px }];
            let join = Join { parts, evidence: JoinEvidence::VesselBottom { contact_share }, behind: None };
            clusters.note(id, join, None);
            clusters.extend(id, &pixels);
        }
    }
}

fn owners(clusters: &Clusters<'_>) -> Raster<Owner> {
    let Facets { segments, structure, .. } = clusters.scene.facets;
    let cluster = |facet: usize| facet.checked_sub(*structure).and_then(|free| clusters.of_facet(free));
    let owner = |facet: &i32| {
        let facet = usize::try_from(*facet);
        facet.map_or(Owner::Nobody, |facet| cluster(facet).map_or(Owner::Background, Owner::Cluster))
    };
    segments.labels().map(owner)
}

/// The patch that holds `start`, which is marked as visited.
fn patch(start: usize, owners: &mut Raster<Owner>, disparity: &Raster<f32>, jump_quanta: f32) -> Patch {
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
                Owner::Cluster(id) if (disparity[i] - disparity[j]).abs() <= jump_quanta => {
                    *patch.touch.entry(id).or_default() += 1;
                }
                Owner::Cluster(_) | Owner::Nobody => {}
            }
        }
        patch.border += 4 - inside;
    }
    patch
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objectness::testing::{Table, single};

    /// A step of more than this parts the table from what stands on it; 5 mm is less, 100 mm more.
    const JUMP_QUANTA: f32 = 6.0;

    /// How many pixels of the table each of the facets a, b, .. gets.
    fn gained(rows: &[&str], heights_m: &[f64]) -> Vec<usize> {
        let table = Table::drawn(rows, heights_m);
        let scene = table.scene();
        let mut clusters = single(&scene);
        let sizes = |clusters: &Clusters<'_>| -> Vec<usize> {
            clusters.alive().iter().map(|&id| clusters.get(id).pixels.len()).collect()
        };
        let before = sizes(&clusters);
        join_bottoms(&mut clusters, JUMP_QUANTA, &params::Vessels::default());
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
        assert_eq!(gained(&rows, &[0.1]), [0]);
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
    fn the_join_is_noted() {
        let table = Table::drawn(&["aaaa", "a__a", "aaaa"], &[0.005]);
        let scene = table.scene();
        let mut clusters = single(&scene);
        join_bottoms(&mut clusters, JUMP_QUANTA, &params::Vessels::default());
        let (join, _) = &clusters.get(SegmentId(0)).joins[0];
        assert_eq!(join.evidence, JoinEvidence::VesselBottom { contact_share: 1.0 });
        assert_eq!(join.parts.map(|part| part.size_px), [10, 2]);
        // Above 1 it never is.
        let mut clusters = single(&scene);
        let never = params::Vessels { bottom_contact_share: 1.1, ..Default::default() };
        join_bottoms(&mut clusters, JUMP_QUANTA, &never);
        assert!(clusters.get(SegmentId(0)).joins.is_empty());
    }
}
