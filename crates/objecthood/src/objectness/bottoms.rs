//! Bottoms: what lies as low as the table within a plate or a bowl is a part of it (ours, because a plate came out as a
//! ring).
//!
//! A patch of background that an object encloses, without a step in depth between them, is no table: the table goes on
//! behind what stands on it, with a step at every near side. Through a handle or a ring it is seen across such a step.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::facets::Facets;
use crate::objectness::check::{Bound, Check, Checks};
use crate::objectness::clusters::{Clusters, Scene};
use crate::objectness::history::{Event, Miss, Rule, Source};
use crate::objectness::join::{Join, JoinEvidence, JoinedPart};
use crate::objectness::objects::pixel_box;
use crate::params;
use crate::regions::{SegmentId, Segments};
use crate::union_find::UnionFind;

/// Who a facet belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// It is a wall.
    Nobody,
    Background,
    Cluster(SegmentId),
}

/// Pixels of the background side by side in a row.
type Run = Range<usize>;

/// A connected piece of background.
#[derive(Default)]
struct Patch {
    /// In scan order.
    runs: Vec<Run>,
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
    let mut misses = Vec::new();
    let mut gains: BTreeMap<SegmentId, Vec<u32>> = BTreeMap::new();
    for Patch { runs, border, touch } in scene.patches(&owners(clusters, support)) {
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
        let size_px = runs.iter().map(Run::len).sum();
        let is_noted = size_px >= least_px;
        let (rule, from) = (Rule::VesselBottom, Source::Patch(runs[0].start as u32));
        if !is_bottom {
            misses.extend(is_noted.then_some(Miss { rule, from, into: Some(id), checks: checks.0 }));
            continue;
        }
        if is_noted {
            let box_px = pixel_box(runs.iter().cloned().flatten(), scene.disparity.width());
            let parts = [clusters.part(id), JoinedPart { size_px, box_px }];
            let join = Join { parts, evidence: JoinEvidence::VesselBottom { contact_share }, behind: None };
            clusters.give(Event { rule, from, into: Some(id), checks: checks.0, join: Some((join, None)) });
        }
        gains.entry(id).or_default().extend(runs.into_iter().flatten().map(|i| i as u32));
    }
    for (id, pixels) in gains {
        clusters.extend(id, &pixels);
    }
    clusters.note_misses(misses);
}

/// The owner of every facet.
fn owners(clusters: &Clusters<'_>, support: usize) -> Vec<Owner> {
    let Facets { segments, structure, .. } = clusters.scene.facets;
    let owner = |facet: usize| match facet.checked_sub(*structure) {
        None if facet == support => Owner::Background,
        None => Owner::Nobody,
        Some(free) => clusters.of_facet(free).map_or(Owner::Background, Owner::Cluster),
    };
    (0..segments.count()).map(owner).collect()
}

impl Scene<'_> {
    fn touch(&self, i: usize, j: usize) -> bool {
        let [d_i, d_j] = [i, j].map(|i| self.disparity[i]);
        let [z_i, z_j] = [d_i, d_j].map(|d| self.space.depth_m(d.into()));
        (d_i - d_j).abs() <= self.steps.touch_quanta && (z_i - z_j).abs() <= STEP_M
    }

    /// The patches of background in the order of their first pixels: runs that lie above each other are of one. What ends a
    /// patch lies where they do not. O(pixels + border pixels).
    fn patches(&self, owners: &[Owner]) -> Vec<Patch> {
        let segments = &self.facets.segments;
        let (width, height) = segments.labels().size();
        let runs = background(segments, owners);
        // The runs of row v are first_of[v]..first_of[v + 1].
        let first_of: Vec<usize> =
            (0..=height).map(|v| runs.partition_point(|run| run.start < v * width)).collect();
        let mut sets = UnionFind::new(runs.len());
        let mut borders = vec![0_u32; runs.len()];
        let mut touches: Vec<(usize, SegmentId)> = Vec::new();
        let mut end = |run: usize, i: usize, beyond: Option<usize>| {
            borders[run] += 1;
            let Some((j, facet)) = beyond.and_then(|j| Some((j, segments.at(j)?))) else { return };
            if let Owner::Cluster(id) = owners[facet.index()]
                && self.touch(i, j)
            {
                touches.push((run, id));
            }
        };
        for v in 0..height {
            for run in first_of[v]..first_of[v + 1] {
                let Run { start, end: last } = runs[run];
                end(run, start, (start % width > 0).then(|| start - 1));
                end(run, last - 1, (last % width > 0).then_some(last));
                let above = v.checked_sub(1).map(|above| first_of[above]..first_of[v]);
                let below = (v + 1 < height).then(|| first_of[v + 1]..first_of[v + 2]);
                for (others, step) in [(above, -(width as isize)), (below, width as isize)] {
                    let Some(others) = others else {
                        (start..last).for_each(|i| end(run, i, None));
                        continue;
                    };
                    let beyond = |i: usize| i.wrapping_add_signed(step);
                    let mut i = start;
                    let from = others.start
                        + runs[others.clone()].partition_point(|other| other.end <= beyond(start));
                    for other in (from..others.end).take_while(|&other| runs[other].start < beyond(last)) {
                        while beyond(i) < runs[other].start {
                            end(run, i, Some(beyond(i)));
                            i += 1;
                        }
                        i = last.min(runs[other].end.wrapping_add_signed(-step));
                        let [a, b] = [run, other].map(|run| sets.find(run));
                        sets.link(a.min(b), a.max(b));
                    }
                    (i..last).for_each(|i| end(run, i, Some(beyond(i))));
                }
            }
        }
        let (patch_of, count) = sets.groups();
        let mut patches: Vec<Patch> = (0..count).map(|_| Patch::default()).collect();
        for ((run, border), &patch) in runs.into_iter().zip(borders).zip(&patch_of) {
            let patch = &mut patches[patch as usize];
            patch.runs.push(run);
            patch.border += border;
        }
        for (run, id) in touches {
            *patches[patch_of[run] as usize].touch.entry(id).or_default() += 1;
        }
        patches
    }
}

/// The longest runs of background along the rows, in scan order. O(pixels).
fn background(segments: &Segments, owners: &[Owner]) -> Vec<Run> {
    let width = segments.labels().width();
    let mut background: Vec<Run> = Vec::new();
    for (run, _) in segments.runs().filter(|&(_, facet)| owners[facet] == Owner::Background) {
        match background.last_mut() {
            Some(last) if last.end == run.start && run.start % width > 0 => last.end = run.end,
            _ => background.push(run),
        }
    }
    background
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::neighbours::four_neighbours;
    use crate::objectness::testing::{Table, single};
    use crate::testing::{raster, small_size};

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

    proptest! {
        /// Pixel by pixel, from the first one that belongs to no patch yet.
        #[test]
        fn patches_are_those_of_a_flood(
            pixels in small_size().prop_flat_map(|size| raster(size, prop_oneof![
                1 => Just(None), 4 => Just(Some((0, 0.0))), 1 => Just(Some((1, 0.005))), 1 => Just(Some((2, 0.03))),
                1 => Just(Some((3, 0.004))),
            ])),
        ) {
            let (width, height) = pixels.size();
            let table = Table::new((width, height), |u, v| pixels[v * width + u]);
            let scene = table.scene();
            let segments = &scene.facets.segments;
            // Facet 3 was found to be a part of the table.
            let all = [Owner::Background, Owner::Cluster(SegmentId(0)), Owner::Cluster(SegmentId(1)), Owner::Background];
            let owners = &all[..segments.count()];
            let owner = |i: usize| segments.at(i).map(|facet| owners[facet.index()]);
            let mut is_taken = vec![false; pixels.len()];
            let mut expected = Vec::new();
            for start in 0..pixels.len() {
                if is_taken[start] || owner(start) != Some(Owner::Background) {
                    continue;
                }
                let (mut open, mut flood, mut border, mut touch) = (vec![start], Vec::new(), 0, BTreeMap::new());
                is_taken[start] = true;
                while let Some(i) = open.pop() {
                    flood.push(i);
                    border += 4;
                    for (j, _) in four_neighbours(i, width, height) {
                        match owner(j) {
                            Some(Owner::Background) => {
                                border -= 1;
                                if !std::mem::replace(&mut is_taken[j], true) {
                                    open.push(j);
                                }
                            }
                            Some(Owner::Cluster(id)) if scene.touch(i, j) => *touch.entry(id).or_insert(0) += 1,
                            _ => {}
                        }
                    }
                }
                flood.sort_unstable();
                expected.push((flood, border, touch));
            }
            let patches = scene.patches(owners).into_iter();
            let got: Vec<_> = patches.map(|p| (p.runs.into_iter().flatten().collect::<Vec<_>>(), p.border, p.touch)).collect();
            prop_assert_eq!(got, expected);
        }
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
