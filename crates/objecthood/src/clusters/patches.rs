//! Patches: connected pieces of the background, and what bounds them.
//!
//! The background is the support, and the clusters that earlier rules gave to it. Pixels touch unless there is a step between them or their
//! depths differ by more than 1 cm.

use std::collections::BTreeMap;
use std::iter::Sum;
use std::ops::{AddAssign, Range};

use crate::clusters::borders::REACH_PX;
use crate::clusters::cluster::Clusters;
use crate::clusters::scene::Scene;
use crate::discovery::join::JoinedPart;
use crate::facets::Facets;
use crate::raster::PixelBox;
use crate::regions::{SegmentId, Segments};
use crate::union_find::UnionFind;

/// Depths that differ by more than this (m) are a step: the edge of the thinnest thing that is distinguished from the table.
const STEP_M: f64 = 0.01;

/// The owner of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    /// Structure other than the support: a wall.
    Nobody,
    Background,
    Cluster(SegmentId),
}

/// Adjacent background pixels of a row.
type Run = Range<usize>;

/// The sides of a patch's border beyond which a cluster is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Shared {
    /// Those without a step in depth.
    pub touch: u32,
    /// Those where the cluster is in front, across a step, or across few enough pixels without a facet to be
    /// neighbours.
    pub hidden: u32,
}

impl Shared {
    pub(super) fn sides(self) -> u32 {
        self.touch + self.hidden
    }
}

impl AddAssign for Shared {
    fn add_assign(&mut self, other: Self) {
        self.touch += other.touch;
        self.hidden += other.hidden;
    }
}

impl Sum for Shared {
    fn sum<I: Iterator<Item = Self>>(shared: I) -> Self {
        shared.fold(Self::default(), |mut sum, next| {
            sum += next;
            sum
        })
    }
}

/// A connected piece of background.
#[derive(Default)]
pub(super) struct Patch {
    /// In scan order.
    pub runs: Vec<Run>,
    /// Length of its border: sides of its pixels beyond which it ends.
    border: u32,
    /// What it shares with each cluster beside it.
    pub shared: BTreeMap<SegmentId, Shared>,
}

impl Patch {
    pub(super) fn size_px(&self) -> usize {
        self.runs.iter().map(Run::len).sum()
    }

    pub(super) fn share_of_border(&self, sides: u32) -> f64 {
        f64::from(sides) / f64::from(self.border)
    }

    /// The length of its border without what it shares with `others`.
    pub(super) fn border_without(&self, others: Shared) -> u32 {
        self.border - others.sides()
    }

    /// Its first pixel in scan order.
    pub(super) fn first(&self) -> u32 {
        self.runs[0].start as u32
    }

    pub(super) fn part(&self, width: usize) -> JoinedPart {
        let box_px = PixelBox::around(self.runs.iter().cloned().flatten(), width);
        JoinedPart { size_px: self.size_px(), box_px }
    }
}

/// The owner of every facet.
pub(super) fn find_owners(clusters: &Clusters<'_>) -> Vec<Owner> {
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

/// The patches of background that no cluster was given, in the order of their first pixels. O(pixels + border pixels).
pub(super) fn find_patches(clusters: &Clusters<'_>) -> Vec<Patch> {
    let mut patches = patches_of(clusters.scene, &find_owners(clusters));
    let is_given =
        |patch: &Patch, id: SegmentId| clusters.get(id).pixels.binary_search(&patch.first()).is_ok();
    patches.retain(|patch| !patch.shared.keys().any(|&id| is_given(patch, id)));
    patches
}

/// The same for owners of the facets. Runs above each other belong to one patch. Where a run has no
/// other run above or below, its patch ends.
fn patches_of(scene: &Scene<'_>, owners: &[Owner]) -> Vec<Patch> {
    let (width, height) = scene.disparity.size();
    let mut sides = Sides::of(scene, owners);
    for v in 0..height {
        for run in sides.row(v) {
            let Run { start, end } = sides.runs[run];
            let row = v * width;
            sides.end(run, start, (row..start).rev());
            sides.end(run, end - 1, end..row + width);
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
    /// Pixels farther apart in a row or column are no neighbours.
    reach: usize,
    runs: Vec<Run>,
    /// The runs of row v are `first_of[v]..first_of[v + 1]`.
    first_of: Vec<usize>,
    /// One set of runs for each patch.
    sets: UnionFind,
    /// For each run the number of sides where its patch ends.
    borders: Vec<u32>,
    /// The sides that a cluster bounds: the run, the cluster, and what they share there.
    shared: Vec<(usize, SegmentId, Shared)>,
}

impl<'a> Sides<'a> {
    fn of(scene: &'a Scene<'a>, owners: &'a [Owner]) -> Self {
        let (width, height) = scene.disparity.size();
        let runs = find_background(&scene.facets.segments, owners);
        let first_of = (0..=height).map(|v| runs.partition_point(|run| run.start < v * width)).collect();
        let (sets, borders) = (UnionFind::new(runs.len()), vec![0; runs.len()]);
        let reach = scene.space.length_px(REACH_PX);
        Self { scene, owners, reach, runs, first_of, sets, borders, shared: Vec::new() }
    }

    /// The runs of a row.
    fn row(&self, v: usize) -> Range<usize> {
        self.first_of[v]..self.first_of[v + 1]
    }

    /// Counts a side of pixel `i` where its patch ends. `beyond`: the pixels on the other side up to the border of the image, the nearest
    /// first.
    fn end(&mut self, run: usize, i: usize, beyond: impl Iterator<Item = usize>) {
        self.borders[run] += 1;
        let segments = &self.scene.facets.segments;
        let mut places = beyond.take(self.reach).enumerate();
        let Some((gap, j, facet)) = places.find_map(|(gap, j)| Some((gap, j, segments.at(j)?))) else {
            return;
        };
        if let Owner::Cluster(id) = self.owners[facet.index()] {
            let (steps, rise) = (&self.scene.steps, self.scene.disparity[j] - self.scene.disparity[i]);
            let touch = gap == 0 && touches(self.scene, i, j);
            let hidden = !touch && rise > if gap == 0 { 0.0 } else { steps.level_quanta };
            self.shared.push((run, id, Shared { touch: touch.into(), hidden: hidden.into() }));
        }
    }

    /// Joins a run with the runs beside it among the `others`, the runs of the row `step` pixels farther, and counts its sides without a
    /// run beside them. `None`: there is no such row in the image.
    fn meet(&mut self, run: usize, others: Option<Range<usize>>, step: isize) {
        let Run { start, end } = self.runs[run];
        let Some(others) = others else {
            (start..end).for_each(|i| self.end(run, i, std::iter::empty()));
            return;
        };
        let beyond = |i: usize| i.wrapping_add_signed(step);
        let count = self.scene.disparity.len();
        let column = |i: usize| {
            std::iter::successors(i.checked_add_signed(step), move |j| j.checked_add_signed(step))
                .take_while(move |&j| j < count)
        };
        let mut i = start;
        let first = self.runs[others.clone()].partition_point(|other| other.end <= beyond(start));
        for other in others.start + first..others.end {
            let Run { start: other_start, end: other_end } = self.runs[other];
            if other_start >= beyond(end) {
                break;
            }
            while beyond(i) < other_start {
                self.end(run, i, column(i));
                i += 1;
            }
            i = end.min(other_end.wrapping_add_signed(-step));
            let [a, b] = [run, other].map(|run| self.sets.find(run));
            self.sets.link(a.min(b), a.max(b));
        }
        (i..end).for_each(|i| self.end(run, i, column(i)));
    }

    fn into_patches(self) -> Vec<Patch> {
        let (patch_of, count) = self.sets.groups();
        let mut patches: Vec<Patch> = (0..count).map(|_| Patch::default()).collect();
        for ((run, border), &patch) in self.runs.into_iter().zip(self.borders).zip(&patch_of) {
            let patch = &mut patches[patch as usize];
            patch.runs.push(run);
            patch.border += border;
        }
        for (run, id, side) in self.shared {
            *patches[patch_of[run] as usize].shared.entry(id).or_default() += side;
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
    use crate::clusters::testing::Table;
    use crate::neighbours::four_neighbours;
    use crate::testing::{raster, small_size};

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
                let (mut open, mut flood, mut border, mut shared) = (vec![start], Vec::new(), 0, BTreeMap::<_, Shared>::new());
                is_taken[start] = true;
                while let Some(i) = open.pop() {
                    flood.push(i);
                    border += 4;
                    for (j, _) in four_neighbours(i, width, height) {
                        let step = j as isize - i as isize;
                        let in_line = |&k: &usize| {
                            k < width * height && (k / width == i / width || step.unsigned_abs() == width)
                        };
                        let ahead = |count: usize| i.checked_add_signed(step * count as isize);
                        let line = (1..=REACH_PX).map_while(|count| ahead(count).filter(in_line));
                        match line.enumerate().find_map(|(gap, j)| Some((gap, j, owner(j)?))) {
                            Some((0, j, Owner::Background)) => {
                                border -= 1;
                                if !std::mem::replace(&mut is_taken[j], true) {
                                    open.push(j);
                                }
                            }
                            Some((gap, j, Owner::Cluster(id))) => {
                                let shared = shared.entry(id).or_default();
                                let rise = table.disparity[j] - table.disparity[i];
                                if gap == 0 && touches(&scene, i, j) {
                                    shared.touch += 1;
                                } else if rise > if gap == 0 { 0.0 } else { scene.steps.level_quanta } {
                                    shared.hidden += 1;
                                }
                            }
                            _ => {}
                        }
                    }
                }
                flood.sort_unstable();
                expected.push((flood, border, shared));
            }
            let patches = patches_of(&scene, owners).into_iter();
            let got: Vec<_> = patches.map(|p| (p.runs.into_iter().flatten().collect::<Vec<_>>(), p.border, p.shared)).collect();
            prop_assert_eq!(got, expected);
        }
    }

    #[test]
    fn a_cluster_is_seen_across_as_many_holes_as_neighbours_are() {
        for (holes, hidden) in [(REACH_PX - 1, 1), (REACH_PX, 0)] {
            let table = Table::new((REACH_PX + 2, 1), |u, _| match u {
                0 => Some((0, 0.0)),
                _ if u <= holes => None,
                _ => Some((1, 0.05)),
            });
            let scene = table.scene();
            let [patch] = &patches_of(&scene, &[Owner::Background, Owner::Cluster(SegmentId(0))])[..] else {
                panic!("one patch")
            };
            let sides: u32 = patch.shared.values().map(|shared| shared.hidden).sum();
            assert_eq!(sides, hidden, "{holes} holes");
        }
    }
}
