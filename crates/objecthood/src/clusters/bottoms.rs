//! Bottoms: background that a plate or a bowl encloses is a part of it (ours, because a plate came out as a ring).
//!
//! The bottom of a plate lies as low as the table. Its border distinguishes it from the table: the plate encloses it without a step
//! in depth. The table continues behind the things on it, with a step at every near side. It is also seen through a handle or a
//! ring, again across a step.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::history::{Proposal, Rule, Source};
use crate::clusters::scene::Scene;
use crate::discovery::join::{Join, JoinEvidence, JoinedPart};
use crate::facets::Facets;
use crate::params;
use crate::raster::PixelBox;
use crate::regions::{SegmentId, Segments};
use crate::union_find::UnionFind;

/// The owner of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// Structure other than the support: a wall.
    Nobody,
    Background,
    Cluster(SegmentId),
}

/// Adjacent background pixels of a row.
type Run = Range<usize>;

/// A connected piece of background.
#[derive(Default)]
struct Patch {
    /// In scan order.
    runs: Vec<Run>,
    /// Length of its border: sides of its pixels beyond which it ends.
    border: u32,
    /// For each cluster, the sides of the border that touch it without a step in depth.
    touch: BTreeMap<SegmentId, u32>,
}

/// Depths that differ by more than this (m) are a step: the edge of the thinnest thing that is distinguished from the table.
const STEP_M: f64 = 0.01;
/// Smaller patches (px at a focal length of 525 px) are holes in a surface: they are filled but not recorded.
const BOTTOM_PX: usize = 100;
/// The vessel touches more than this share of the border: more than all other clusters together.
const MAJORITY: f64 = 0.5;

/// Gives patches of background to the cluster that encloses them. The background is the support, and the clusters that earlier rules
/// gave to it. Pixels touch unless there is a step between them or their depths differ by more than 1 cm. Does nothing without a
/// support surface. O(pixels log pixels).
pub(crate) fn join_bottoms(clusters: &mut Clusters<'_>, params: &params::Vessels) {
    let scene = clusters.scene;
    if scene.supports.is_empty() {
        return;
    }
    let least_px = scene.space.area_px(BOTTOM_PX);
    let mut misses = Vec::new();
    let mut gains: BTreeMap<SegmentId, Vec<u32>> = BTreeMap::new();
    for patch in find_patches(scene, &find_owners(clusters)) {
        // On ties the cluster with the smallest number wins.
        let Some((&id, &most)) = patch.touch.iter().rev().max_by_key(|(_, touch)| **touch) else { continue };
        let mut join = Proposal::new(Rule::VesselBottom, Source::Patch(patch.runs[0].start as u32), Some(id));
        let contact_share = patch.share_of_border(patch.touch.values().sum());
        let is_bottom = join.check(check_enclosed(contact_share, params))
            && join.check(Check::new(
                "share of its border with the vessel",
                "",
                patch.share_of_border(most),
                Bound::Above,
                MAJORITY,
            ));
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

fn check_enclosed(contact_share: f64, params: &params::Vessels) -> Check {
    let what = "share of its border without a step";
    Check::new(what, "", contact_share, Bound::AtLeast, params.bottom_contact_share)
        .set_by("vessels.bottom_contact_share")
}

impl Patch {
    fn size_px(&self) -> usize {
        self.runs.iter().map(Run::len).sum()
    }

    fn share_of_border(&self, sides: u32) -> f64 {
        f64::from(sides) / f64::from(self.border)
    }

    fn part(&self, width: usize) -> JoinedPart {
        let box_px = PixelBox::around(self.runs.iter().cloned().flatten(), width);
        JoinedPart { size_px: self.size_px(), box_px }
    }
}

/// The owner of every facet.
fn find_owners(clusters: &Clusters<'_>) -> Vec<Owner> {
    let Scene { facets: Facets { segments, structure, .. }, supports, .. } = clusters.scene;
    let owner = |facet: usize| match facet.checked_sub(*structure) {
        None if supports.contains(&facet) => Owner::Background,
        None => Owner::Nobody,
        Some(free) => clusters.of_facet(free).map_or(Owner::Background, Owner::Cluster),
    };
    (0..segments.count()).map(owner).collect()
}

/// Whether there is no step between two pixels side by side, neither in quanta nor in metres.
fn touches(scene: &Scene<'_>, i: usize, j: usize) -> bool {
    let depth_m = |i: usize| scene.space.depth_m(scene.disparity[i].into());
    scene.steps.touch(scene.disparity, i, j) && (depth_m(i) - depth_m(j)).abs() <= STEP_M
}

/// The patches of background, in the order of their first pixels. Runs above each other belong to one patch. Where a run has no
/// other run above or below, its patch ends. O(pixels + border pixels).
fn find_patches(scene: &Scene<'_>, owners: &[Owner]) -> Vec<Patch> {
    let (width, height) = scene.disparity.size();
    let mut sides = Sides::of(scene, owners);
    for v in 0..height {
        for run in sides.row(v) {
            let Run { start, end } = sides.runs[run];
            sides.end(run, start, (start % width > 0).then(|| start - 1));
            sides.end(run, end - 1, (end % width > 0).then_some(end));
            let (step, above) = (width as isize, v.checked_sub(1).map(|above| sides.row(above)));
            sides.meet(run, above, -step);
            sides.meet(run, (v + 1 < height).then(|| sides.row(v + 1)), step);
        }
    }
    sides.into_patches()
}

/// Runs of background, and the sides of their pixels where patches end.
struct Sides<'a> {
    scene: &'a Scene<'a>,
    owners: &'a [Owner],
    runs: Vec<Run>,
    /// The runs of row v are `first_of[v]..first_of[v + 1]`.
    first_of: Vec<usize>,
    /// One set of runs for each patch.
    sets: UnionFind,
    /// For each run the number of sides where its patch ends.
    borders: Vec<u32>,
    /// The sides that touch a cluster: the run, and the cluster.
    touches: Vec<(usize, SegmentId)>,
}

impl<'a> Sides<'a> {
    fn of(scene: &'a Scene<'a>, owners: &'a [Owner]) -> Self {
        let (width, height) = scene.disparity.size();
        let runs = find_background(&scene.facets.segments, owners);
        let first_of = (0..=height).map(|v| runs.partition_point(|run| run.start < v * width)).collect();
        let (sets, borders) = (UnionFind::new(runs.len()), vec![0; runs.len()]);
        Self { scene, owners, runs, first_of, sets, borders, touches: Vec::new() }
    }

    /// The runs of a row.
    fn row(&self, v: usize) -> Range<usize> {
        self.first_of[v]..self.first_of[v + 1]
    }

    /// Counts a side of pixel `i` where its patch ends. `beyond`: the pixel on the other side; `None` at the border of the image.
    fn end(&mut self, run: usize, i: usize, beyond: Option<usize>) {
        self.borders[run] += 1;
        let Some((j, facet)) = beyond.and_then(|j| Some((j, self.scene.facets.segments.at(j)?))) else {
            return;
        };
        if let Owner::Cluster(id) = self.owners[facet.index()]
            && touches(self.scene, i, j)
        {
            self.touches.push((run, id));
        }
    }

    /// Joins a run with the runs beside it among the `others`, the runs of the row `step` pixels farther, and counts its sides without a
    /// run beside them. `None`: there is no such row in the image.
    fn meet(&mut self, run: usize, others: Option<Range<usize>>, step: isize) {
        let Run { start, end } = self.runs[run];
        let Some(others) = others else {
            (start..end).for_each(|i| self.end(run, i, None));
            return;
        };
        let beyond = |i: usize| i.wrapping_add_signed(step);
        let mut i = start;
        let first = self.runs[others.clone()].partition_point(|other| other.end <= beyond(start));
        for other in others.start + first..others.end {
            let Run { start: other_start, end: other_end } = self.runs[other];
            if other_start >= beyond(end) {
                break;
            }
            while beyond(i) < other_start {
                self.end(run, i, Some(beyond(i)));
                i += 1;
            }
            i = end.min(other_end.wrapping_add_signed(-step));
            let [a, b] = [run, other].map(|run| self.sets.find(run));
            self.sets.link(a.min(b), a.max(b));
        }
        (i..end).for_each(|i| self.end(run, i, Some(beyond(i))));
    }

    fn into_patches(self) -> Vec<Patch> {
        let (patch_of, count) = self.sets.groups();
        let mut patches: Vec<Patch> = (0..count).map(|_| Patch::default()).collect();
        for ((run, border), &patch) in self.runs.into_iter().zip(self.borders).zip(&patch_of) {
            let patch = &mut patches[patch as usize];
            patch.runs.push(run);
            patch.border += border;
        }
        for (run, id) in self.touches {
            *patches[patch_of[run] as usize].touch.entry(id).or_default() += 1;
        }
        patches
    }
}

/// The longest runs of background along the rows, in scan order. O(pixels).
fn find_background(segments: &Segments, owners: &[Owner]) -> Vec<Run> {
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
    use crate::clusters::testing::{Table, single};
    use crate::neighbours::four_neighbours;
    use crate::testing::{raster, small_size};

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

    proptest! {
        /// The patches pixel by pixel, each from the first pixel that belongs to no patch yet.
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
            // Facet 3 was given to the table.
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
                            Some(Owner::Cluster(id)) if touches(&scene, i, j) => *touch.entry(id).or_insert(0) += 1,
                            _ => {}
                        }
                    }
                }
                flood.sort_unstable();
                expected.push((flood, border, touch));
            }
            let patches = find_patches(&scene, owners).into_iter();
            let got: Vec<_> = patches.map(|p| (p.runs.into_iter().flatten().collect::<Vec<_>>(), p.border, p.touch)).collect();
            prop_assert_eq!(got, expected);
        }
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
