//! Clusters: shapes on their way to objects, and what is known of each (METHOD 3.9).

use std::collections::{BTreeMap, VecDeque};
use std::ops::{AddAssign, Range};
use std::sync::OnceLock;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::facets::Facets;
use crate::neighbours::four_neighbours;
use crate::objectness::history::{Event, Miss, Source};
use crate::objectness::join::{Join, JoinedPart};
use crate::objectness::objects::pixel_box;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::quantile::element_at;
use crate::raster::{Raster, marked};
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::shapes::contraction::Shapes;
use crate::simd::vectorized;
use crate::surface::disparity::{DisparitySpace, position};

/// What stage 4 looks at besides the clusters: it stays as it is.
pub(crate) struct Scene<'a> {
    /// Facets and structure after [`fill`].
    pub facets: &'a Facets,
    pub disparity: &'a Raster<f32>,
    pub normals: &'a Raster<[f32; 3]>,
    pub points_m: &'a Raster<[f32; 3]>,
    pub color: Option<&'a Raster<[u8; 3]>>,
    pub space: &'a DisparitySpace,
    /// What objects stand on.
    pub support: Option<&'a StructureSurface>,
    pub steps: Steps,
}

/// Largest differences in disparity (quanta) that are no step in depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps {
    /// Between pixels side by side.
    pub touch_quanta: f32,
    /// Across a gap.
    pub level_quanta: f32,
}

impl Steps {
    /// What a link of the watershed allows; side by side one quantum more, as much as rounding makes.
    pub(crate) fn of(params: &params::Watershed) -> Self {
        Self { touch_quanta: params.link_jump_quanta + 1.0, level_quanta: params.link_jump_quanta }
    }

    /// Whether there is no step between two pixels side by side.
    fn touch(self, disparity: &Raster<f32>, i: usize, j: usize) -> bool {
        (disparity[j] - disparity[i]).abs() <= self.touch_quanta
    }
}

/// How two clusters lie to each other in the image: pairs of neighbouring pixels, also across a gap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Borders {
    /// Next to each other without a step in depth.
    pub touch: u32,
    /// The same across a gap.
    pub level: u32,
    /// This one before the other.
    pub in_front: u32,
    /// The other before this one.
    pub behind: u32,
}

/// A group of facets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cluster {
    /// In scan order; empty when it has been merged into another.
    pub pixels: Vec<u32>,
    /// How it lies to others; `None` = the background, which is all structure.
    pub neighbours: BTreeMap<Option<SegmentId>, Borders>,
    /// What was given to it, and before that to what was given to it; each with the number of events before it.
    history: Vec<(usize, Event)>,
    top_m: OnceLock<f64>,
    convexity: OnceLock<f64>,
}

/// The clusters of a frame. Merging keeps everything known of them in step.
pub(crate) struct Clusters<'a> {
    pub scene: &'a Scene<'a>,
    clusters: Vec<Cluster>,
    /// Cluster of each facet that is no structure; `None` = background.
    of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that turned out to be background, and how that came.
    remains: Vec<u32>,
    remains_history: Vec<(usize, Event)>,
    /// How many events there were.
    events: usize,
    /// What rules looked at and left alone; each with the number of events before it.
    misses: Vec<(usize, Miss)>,
}

/// Pixels farther apart in a row or column (px at a focal length of 525 px) are no neighbours.
pub(crate) const REACH_PX: usize = 24;
/// How high a cluster is: this share of its pixels is lower.
const TOP_SHARE: f64 = 0.98;
/// Fewer pixels (at 525 px) tell nothing about convexity.
const CONVEXITY_PX: usize = 80;
/// Convexity looks at about so many points ...
const CONVEXITY_SAMPLES: usize = 48;
/// ... and at pairs of them whose squared distance (m^2) is at least this.
const CONVEXITY_APART_M2: f64 = 1e-5;

/// Gives measured pixels without a facet to the facet of a neighbour that they touch, breadth first, in scan order at first.
/// O(pixels).
pub(crate) fn fill(facets: Facets, disparity: &Raster<f32>, steps: Steps) -> Facets {
    let count = facets.segments.count();
    let mut labels = facets.segments.into_labels();
    let (width, height) = labels.size();
    let mut open = VecDeque::from(givers(&labels, disparity, steps));
    let slice = labels.as_mut_slice();
    while let Some(i) = open.pop_front() {
        for (j, _) in four_neighbours(i, width, height) {
            if slice[j] < 0 && steps.touch(disparity, i, j) {
                slice[j] = slice[i];
                open.push_back(j);
            }
        }
    }
    Facets { segments: Segments::from_numbered(labels, count), ..facets }
}

/// The pixels with a facet that touch one that is measured and has none, in scan order. O(pixels + theirs · log of them); parallel
/// over rows.
fn givers(labels: &Raster<i32>, disparity: &Raster<f32>, steps: Steps) -> Vec<usize> {
    let (width, height) = labels.size();
    let around = |bare: &mut Vec<i32>, v: usize| {
        let row = v * width..(v + 1) * width;
        let pixels = labels.as_slice()[row.clone()].iter().zip(&disparity.as_slice()[row.clone()]);
        vectorized(
            #[inline(always)]
            || {
                for (bare, (label, d)) in bare.iter_mut().zip(pixels) {
                    *bare = i32::from(*label < 0) & i32::from(!d.is_nan());
                }
            },
        );
        let mut givers = Vec::new();
        for i in marked(bare).map(|u| row.start + u) {
            let near = four_neighbours(i, width, height).map(|(j, _)| j);
            givers.extend(near.filter(|&j| labels[j] >= 0 && steps.touch(disparity, i, j)));
        }
        givers
    };
    let rows = (0..height).into_par_iter().map_init(|| vec![0; width], around);
    let mut givers: Vec<usize> = rows.flatten_iter().collect();
    givers.sort_unstable();
    givers.dedup();
    givers
}

impl AddAssign for Borders {
    fn add_assign(&mut self, other: Self) {
        self.touch += other.touch;
        self.level += other.level;
        self.in_front += other.in_front;
        self.behind += other.behind;
    }
}

impl Borders {
    /// As the other cluster sees it.
    fn mirrored(self) -> Self {
        Self { in_front: self.behind, behind: self.in_front, ..self }
    }
}

impl<'a> Clusters<'a> {
    /// The shapes. O(pixels).
    pub(crate) fn new(scene: &'a Scene<'a>, shapes: &Shapes) -> Self {
        let Shapes { of_facet: shape_of, count } = shapes;
        let of_facet: Vec<_> = shape_of.iter().map(|&shape| Some(SegmentId(shape))).collect();
        let gather = || {
            let mut clusters = vec![Cluster::default(); *count];
            let Facets { segments, structure, .. } = scene.facets;
            for (run, facet) in segments.runs() {
                if let Some(shape) = facet.checked_sub(*structure) {
                    clusters[shape_of[shape] as usize].pixels.extend(run.map(|i| i as u32));
                }
            }
            clusters
        };
        scene.facets.segments.find_runs();
        let (mut clusters, lie) = rayon::join(gather, || lie_of_clusters(scene, shapes));
        for edge in lie.edges() {
            // Region 0 is the background.
            let [a, b] = [edge.a, edge.b].map(|k| k.0.checked_sub(1).map(SegmentId));
            for (own, other, borders) in [(a, b, edge.evidence), (b, a, edge.evidence.mirrored())] {
                if let Some(own) = own {
                    clusters[own.index()].neighbours.insert(other, borders);
                }
            }
        }
        Self {
            scene,
            clusters,
            of_facet,
            remains: Vec::new(),
            remains_history: Vec::new(),
            events: 0,
            misses: Vec::new(),
        }
    }

    /// The clusters that have pixels, in ascending order.
    pub(crate) fn alive(&self) -> Vec<SegmentId> {
        let alive = (0..self.clusters.len()).filter(|&k| !self.clusters[k].pixels.is_empty());
        alive.map(|k| SegmentId(k as u32)).collect()
    }

    /// A cluster.
    pub(crate) fn get(&self, id: SegmentId) -> &Cluster {
        &self.clusters[id.index()]
    }

    /// The cluster of a facet that comes after the structure, counted from 0.
    pub(crate) fn of_facet(&self, facet: usize) -> Option<SegmentId> {
        self.of_facet[facet]
    }

    /// What a cluster looks like as a part of something.
    pub(crate) fn part(&self, id: SegmentId) -> JoinedPart {
        let pixels = self.get(id).pixels.iter().map(|&i| i as usize);
        JoinedPart { size_px: pixels.len(), box_px: pixel_box(pixels, self.scene.disparity.width()) }
    }

    /// How `a` lies to `b`.
    pub(crate) fn borders(&self, a: SegmentId, b: SegmentId) -> Borders {
        self.get(a).neighbours.get(&Some(b)).copied().unwrap_or_default()
    }

    /// Which parts of a cluster were joined although they do not touch as one surface, each with the facet that hides what is
    /// between.
    pub(crate) fn joins(&self, id: SegmentId) -> impl Iterator<Item = &(Join, Option<SegmentId>)> {
        self.get(id).history.iter().filter_map(|(_, event)| event.join.as_ref())
    }

    /// Notes what a rule looked at and left alone.
    pub(crate) fn note_misses(&mut self, misses: impl IntoIterator<Item = Miss>) {
        let events = self.events;
        self.misses.extend(misses.into_iter().map(|miss| (events, miss)));
    }

    /// All that was given to what, each with the number of events before it, in no order.
    pub(crate) fn events(&self) -> impl Iterator<Item = &(usize, Event)> {
        self.clusters.iter().flat_map(|cluster| &cluster.history).chain(&self.remains_history)
    }

    /// All that was left alone, each with the number of events before it, rule by rule.
    pub(crate) fn misses(&self) -> &[(usize, Miss)] {
        &self.misses
    }

    /// Pixels of clusters that were merged into the background.
    pub(crate) fn remains(&self) -> &[u32] {
        &self.remains
    }

    /// Gives a cluster to where the event says, and notes the event. Of a patch of the background the event is only noted: see
    /// [`Self::extend`]. O(n log n + neighbours) for the n pixels from the first to the last that are given.
    pub(crate) fn give(&mut self, event: Event) {
        if let Source::Cluster(from) = event.from {
            self.merge(event.into, from);
        }
        let history = match event.into {
            Some(into) => &mut self.clusters[into.index()].history,
            None => &mut self.remains_history,
        };
        history.push((self.events, event));
        self.events += 1;
    }

    fn merge(&mut self, into: Option<SegmentId>, from: SegmentId) {
        let Cluster { pixels, neighbours, history, .. } = std::mem::take(&mut self.clusters[from.index()]);
        for cluster in self.of_facet.iter_mut().filter(|cluster| **cluster == Some(from)) {
            *cluster = into;
        }
        for (other, borders) in neighbours.into_iter().filter(|&(other, _)| other != into) {
            if let Some(other) = other {
                let seen = &mut self.clusters[other.index()].neighbours;
                seen.remove(&Some(from));
                *seen.entry(into).or_default() += borders.mirrored();
            }
            if let Some(into) = into {
                *self.clusters[into.index()].neighbours.entry(other).or_default() += borders;
            }
        }
        let Some(into) = into else {
            self.remains.extend(pixels);
            self.remains_history.extend(history);
            return;
        };
        let cluster = &mut self.clusters[into.index()];
        cluster.neighbours.remove(&Some(from));
        cluster.history.extend(history);
        cluster.extend(&pixels);
    }

    /// Adds pixels of the background to a cluster. O(n log n) for the n pixels from the first to the last that are added.
    pub(crate) fn extend(&mut self, id: SegmentId, pixels: &[u32]) {
        self.clusters[id.index()].extend(pixels);
    }

    /// How high a cluster stands (m) above a surface: nearly its highest pixel. Single noisy pixels stand high anywhere.
    pub(crate) fn top_m(&self, id: SegmentId, support: &StructureSurface) -> f64 {
        let cluster = self.get(id);
        *cluster.top_m.get_or_init(|| {
            let every_other = cluster.pixels.iter().step_by(2);
            let mut heights: Vec<f64> =
                every_other.map(|&i| self.scene.height_m(i as usize, support)).collect();
            element_at(&mut heights, TOP_SHARE)
        })
    }

    /// How far a cluster bends outwards: the mean over pairs of its points of how much the normals turn apart along the way, above 0
    /// when it is convex, below 0 when it is concave, 0 when it is flat or small. Between -2 and 2. O(1).
    pub(crate) fn convexity(&self, id: SegmentId) -> f64 {
        let cluster = self.get(id);
        *cluster.convexity.get_or_init(|| self.scene.convexity(&cluster.pixels))
    }
}

impl Cluster {
    fn extend(&mut self, pixels: &[u32]) {
        let (Some(first), Some(last)) = (pixels.iter().min(), pixels.iter().max()) else { return };
        // Only between them there is something to sort.
        let [from, to] = [first, last].map(|end| self.pixels.partition_point(|own| own < end));
        let behind = self.pixels.split_off(to);
        self.pixels.extend(pixels);
        self.pixels[from..].sort();
        self.pixels.extend(behind);
        self.top_m = OnceLock::new();
        self.convexity = OnceLock::new();
    }
}

impl Scene<'_> {
    /// Height (m) of a pixel above a surface.
    pub(crate) fn height_m(&self, i: usize, support: &StructureSurface) -> f64 {
        support.height_m(position(i, self.disparity.width()), f64::from(self.disparity[i]), self.space)
    }

    fn convexity(&self, pixels: &[u32]) -> f64 {
        if pixels.len() < self.space.area_px(CONVEXITY_PX) {
            return 0.0;
        }
        let step = (pixels.len() / CONVEXITY_SAMPLES).max(1);
        let sampled = pixels.iter().map(|&i| i as usize).skip(step / 2).step_by(step);
        let samples: Vec<(DVec3, DVec3)> = sampled
            .filter(|&i| self.normals[i] != [0.0; 3])
            .map(|i| {
                let at = position(i, self.disparity.width());
                let point = self.space.point_m(at, f64::from(self.disparity[i]));
                (point, Vec3::from(self.normals[i]).as_dvec3())
            })
            .collect();
        let (mut sum, mut pairs) = (0.0, 0);
        for (k, (x, n)) in samples.iter().enumerate() {
            for (y, m) in &samples[k + 1..] {
                let apart = *x - *y;
                if apart.length_squared() >= CONVEXITY_APART_M2 {
                    sum += apart.dot(*n - *m) / apart.length();
                    pairs += 1;
                }
            }
        }
        if pairs == 0 { 0.0 } else { sum / f64::from(pairs) }
    }
}

/// How any two clusters lie to each other; region 0 is the background, region k + 1 is cluster k. Neighbours in a row or column
/// are those with nothing but holes between them. O(pixels + border pixels · log of them).
fn lie_of_clusters(scene: &Scene<'_>, shapes: &Shapes) -> RegionGraph<Borders> {
    let width = scene.facets.segments.labels().width();
    // A strip for each thread: pairs are counted, so it does not matter which comes first.
    let columns = width.div_ceil(rayon::current_num_threads());
    let strips: Vec<Range<usize>> =
        (0..width).step_by(columns).map(|left| left..width.min(left + columns)).collect();
    let met: Vec<Vec<Meeting>> = strips.into_par_iter().map(|strip| meetings(scene, shapes, strip)).collect();
    let add = |sum: &mut Borders, borders| *sum += borders;
    RegionGraph::gather(shapes.count + 1, met.into_iter().flatten(), add)
}

/// How two regions lie to each other at some pairs of pixels.
type Meeting = (SegmentId, SegmentId, Borders);

/// Where regions meet above each other in these columns, or side by side, the right one in these columns.
fn meetings(scene: &Scene<'_>, shapes: &Shapes, strip: Range<usize>) -> Vec<Meeting> {
    /// What was seen last in a row or column: the region, and where.
    #[derive(Clone, Copy)]
    struct Last {
        region: u32,
        pixel: usize,
    }
    let Facets { segments, structure, .. } = scene.facets;
    let width = segments.labels().width();
    let Steps { touch_quanta, level_quanta } = scene.steps;
    let reach = scene.space.length_px(REACH_PX);
    let region = |facet: usize| facet.checked_sub(*structure).map_or(0, |shape| shapes.of_facet[shape] + 1);
    let mut met: Vec<Meeting> = Vec::new();
    // Two regions that meet at pixels so many steps apart.
    let mut meet = |a: Last, b: Last, apart: usize| {
        if a.region == b.region || apart > reach {
            return;
        }
        let [d_a, d_b] = [a, b].map(|last| scene.disparity[last.pixel]);
        let rise = if a.region < b.region { d_a - d_b } else { d_b - d_a };
        let borders = match (rise.abs(), apart) {
            (step, 1) if step <= touch_quanta => Borders { touch: 1, ..Default::default() },
            (step, _) if step <= level_quanta => Borders { level: 1, ..Default::default() },
            _ if rise > 0.0 => Borders { in_front: 1, ..Default::default() },
            _ => Borders { behind: 1, ..Default::default() },
        };
        let [a, b] = [a, b].map(|last| SegmentId(last.region));
        // Along a row the same two often meet again, and then are sorted once.
        match met.last_mut() {
            Some((last_a, last_b, sum)) if (*last_a, *last_b) == (a, b) => *sum += borders,
            _ => met.push((a, b, borders)),
        }
    };
    let mut left: Option<Last> = None;
    // Column by column of the strip: the region, and the row.
    let mut above: Vec<u32> = vec![NOTHING; strip.len()];
    let mut row_of_above = vec![0; strip.len()];
    for (run, facet) in segments.runs() {
        let (own, v) = (region(facet), run.start / width);
        let at = |pixel: usize| Last { region: own, pixel };
        let (first, end) = (run.start - v * width, run.end - v * width);
        if let Some(left) = left.filter(|left| left.pixel / width == v && strip.contains(&first)) {
            meet(left, at(run.start), run.start - left.pixel);
        }
        left = Some(at(run.end - 1));
        let (first, end) = (first.max(strip.start), end.min(strip.end));
        if first >= end {
            continue;
        }
        let lanes = first - strip.start..end - strip.start;
        let seen = above[lanes.clone()].iter().zip(&row_of_above[lanes.clone()]);
        for (u, (&region, &row)) in (first..end).zip(seen) {
            if region != own && region != NOTHING {
                meet(Last { region, pixel: row * width + u }, at(v * width + u), v - row);
            }
        }
        above[lanes.clone()].fill(own);
        row_of_above[lanes].fill(v);
    }
    met
}

/// Of no region.
const NOTHING: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;
    use crate::objectness::history::History;
    use crate::objectness::testing::{Table, merge, named, single};
    use crate::testing::{coarse_disparity, raster, small_size};

    /// A small image of up to four facets on a table, at heights that are level, a step or far apart; some pixels are missing.
    fn scenery() -> impl Strategy<Value = Table> {
        let pixel = (prop_oneof![1 => Just(None), 4 => (0_i32..5).prop_map(Some)], 0_u8..4);
        small_size().prop_flat_map(move |size| raster(size, pixel.clone())).prop_map(|pixels| {
            Table::new(pixels.size(), |u, v| {
                let (facet, level) = pixels.get(u, v)?;
                Some(((*facet)?, [0.0, 0.013, 0.016, 0.2][usize::from(*level)]))
            })
        })
    }

    /// The pixels of a cluster and how it lies to its neighbours.
    type Counted = (Vec<u32>, BTreeMap<Option<SegmentId>, Borders>);

    /// Pixels and neighbours of every cluster, from the cluster of every pixel: `None` = no facet, `Some(None)` = background.
    fn counted(
        cluster: &[Option<Option<SegmentId>>],
        disparity: &Raster<f32>,
    ) -> BTreeMap<SegmentId, Counted> {
        let (width, height) = disparity.size();
        let mut counted: BTreeMap<SegmentId, Counted> = BTreeMap::new();
        for (i, id) in cluster.iter().enumerate() {
            if let Some(Some(id)) = id {
                counted.entry(*id).or_default().0.push(i as u32);
            }
        }
        let rows = (0..height).map(|v| (0..width).map(|u| v * width + u).collect::<Vec<_>>());
        let columns = (0..width).map(|u| (0..height).map(|v| v * width + u).collect());
        for line in rows.chain(columns) {
            // Neighbours, with nothing but holes between them.
            let seen: Vec<usize> = (0..line.len()).filter(|&t| cluster[line[t]].is_some()).collect();
            for pair in seen.windows(2) {
                let [i, j] = [line[pair[0]], line[pair[1]]];
                let (Some(a), Some(b)) = (cluster[i], cluster[j]) else { continue };
                if a == b || pair[1] - pair[0] > 24 {
                    continue;
                }
                for (own, other, rise) in
                    [(a, b, disparity[i] - disparity[j]), (b, a, disparity[j] - disparity[i])]
                {
                    let Some(own) = own else { continue };
                    let borders = counted.entry(own).or_default().1.entry(other).or_default();
                    let is_next = pair[1] == pair[0] + 1;
                    let count = match rise {
                        rise if is_next && rise.abs() <= 6.0 => &mut borders.touch,
                        rise if rise.abs() <= 5.0 => &mut borders.level,
                        rise if rise > 0.0 => &mut borders.in_front,
                        _ => &mut borders.behind,
                    };
                    *count += 1;
                }
            }
        }
        counted
    }

    #[test]
    fn borders_are_counted_alike_on_any_number_of_threads() {
        // Wider than there are threads, with holes that strips cut.
        let rows = ["aaaa..bbbb_cc", "aa..bb.bb__cc", "d.........ccc", "dddd__aaa_a_a"];
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let table = Table::drawn(&rows, &[0.1, 0.11, 0.3, 0.2]);
                let scene = table.scene();
                let clusters = single(&scene);
                let neighbours = |id: SegmentId| clusters.get(id).neighbours.clone();
                clusters.alive().into_iter().map(neighbours).collect::<Vec<_>>()
            })
        };
        assert!([2, 3, 5, 16].into_iter().all(|threads| on(threads) == on(1)));
    }

    proptest! {
        #[test]
        fn what_is_added_stands_in_its_place(
            own in prop::collection::btree_set(0_u32..60, 0..20),
            new in prop::collection::btree_set(0_u32..60, 0..20),
            turn in 0_usize..20,
        ) {
            let mut new: Vec<u32> = new.difference(&own).copied().collect();
            let middle = turn % new.len().max(1);
            new.rotate_left(middle);
            let mut cluster = Cluster { pixels: own.iter().copied().collect(), ..Default::default() };
            cluster.extend(&new);
            let expected: BTreeSet<u32> = own.into_iter().chain(new).collect();
            prop_assert_eq!(cluster.pixels, expected.into_iter().collect::<Vec<_>>());
        }

        #[test]
        fn merging_keeps_clusters_in_step_with_their_pixels(
            table in scenery(),
            merges in prop::collection::vec((0_u32..5, 0_u32..5), 0..5),
        ) {
            let scene = table.scene();
            let mut clusters = single(&scene);
            let segments = &scene.facets.segments;
            let mut cluster: Vec<_> = (0..scene.disparity.len())
                .map(|i| segments.at(i).map(|facet| facet.0.checked_sub(1).map(SegmentId)))
                .collect();
            for (into, from) in merges {
                // The last is the background.
                let into = Some(SegmentId(into)).filter(|_| into < 4);
                let from = SegmentId(from);
                let alive = clusters.alive();
                if alive.contains(&from) && into != Some(from) && into.is_none_or(|id| alive.contains(&id)) {
                    merge(&mut clusters, into, from);
                    cluster.iter_mut().filter(|k| **k == Some(Some(from))).for_each(|k| *k = Some(into));
                }
                let expected = counted(&cluster, scene.disparity);
                prop_assert_eq!(clusters.alive(), expected.keys().copied().collect::<Vec<_>>());
                // The events, in their order, say which cluster every facet is in.
                let events = History::of(&clusters).events().into_iter().cloned().collect::<Vec<_>>();
                for (facet, own) in named(&clusters).into_iter().enumerate() {
                    let start = Some(SegmentId(facet as u32));
                    let end = events.iter().fold(start, |own, e| if own.is_some() && e.from.cluster() == own { e.into } else { own });
                    prop_assert_eq!(end.map(|id| id.0), own);
                }
                for (id, (pixels, neighbours)) in expected {
                    prop_assert_eq!(&clusters.get(id).pixels, &pixels);
                    prop_assert_eq!(&clusters.get(id).neighbours, &neighbours, "{:?}", id);
                }
                for (i, facet) in segments.members().filter(|m| m.1 > 0) {
                    prop_assert_eq!(Some(clusters.of_facet(facet - 1)), cluster[i]);
                }
            }
        }

        #[test]
        fn what_is_not_labelled_is_filled_from_its_neighbours(
            (disparity, labels) in
                small_size().prop_flat_map(|size| (raster(size, coarse_disparity()), raster(size, -1_i32..2))),
        ) {
            let labels = disparity.with_data(
                (0..labels.len()).map(|i| if disparity[i].is_nan() { -1 } else { labels[i] }).collect(),
            );
            let facets = Facets { segments: Segments::from_numbered(labels.clone(), 2), models: Vec::new(), structure: 0 };
            let steps = Steps { touch_quanta: 3.0, level_quanta: 2.0 };
            let filled = fill(facets, &disparity, steps).segments;
            let (width, height) = labels.size();
            // Breadth first from every pixel that has a facet.
            let mut expected = labels.as_slice().to_vec();
            let mut open: VecDeque<usize> = (0..expected.len()).filter(|&i| expected[i] >= 0).collect();
            while let Some(i) = open.pop_front() {
                for (j, _) in four_neighbours(i, width, height) {
                    if expected[j] < 0 && (disparity[j] - disparity[i]).abs() <= 3.0 {
                        expected[j] = expected[i];
                        open.push_back(j);
                    }
                }
            }
            prop_assert_eq!(filled.labels().as_slice(), expected);
            for i in 0..labels.len() {
                let own = filled.labels()[i];
                let near = four_neighbours(i, width, height).map(|(j, _)| j);
                let mut near = near.filter(|&j| (disparity[j] - disparity[i]).abs() <= 3.0);
                if labels[i] >= 0 {
                    prop_assert_eq!(own, labels[i], "a label stays");
                } else if own >= 0 {
                    prop_assert!(near.any(|j| filled.labels()[j] == own), "it comes from a neighbour");
                } else {
                    prop_assert!(near.all(|j| filled.labels()[j] < 0), "what can be reached is filled");
                }
            }
        }
    }

    #[test]
    fn what_lies_far_apart_is_no_neighbour() {
        for (holes, is_near) in [(0, true), (23, true), (24, false)] {
            let row = format!("a{}b", ".".repeat(holes));
            let table = Table::drawn(&[&row], &[0.1, 0.1]);
            let scene = table.scene();
            let borders = single(&scene).borders(SegmentId(0), SegmentId(1));
            assert_eq!(borders.touch + borders.level, u32::from(is_near), "{holes} holes");
        }
    }

    #[test]
    fn a_ball_is_convex_a_bowl_concave_and_a_board_neither() {
        let round = |sign: f64| {
            Table::new((90, 90), |u, v| {
                let square = 1.0 - ((u as f64 - 45.0).powi(2) + (v as f64 - 45.0).powi(2)) / 1600.0;
                // Half a ball of 7 cm; and half a bowl of that size.
                Some(if square < 0.1 { (0, 0.0) } else { (1, 0.08 + sign * 0.07 * square.sqrt()) })
            })
        };
        let board = Table::new((90, 90), |u, _| Some((1, 0.05 + 1e-4 * u as f64)));
        let convexity = |table: &Table| {
            let scene = table.scene();
            single(&scene).convexity(SegmentId(0))
        };
        assert!(convexity(&round(1.0)) > 0.4, "{}", convexity(&round(1.0)));
        assert!(convexity(&round(-1.0)) < -0.4, "{}", convexity(&round(-1.0)));
        assert!(convexity(&board).abs() < 0.02, "{}", convexity(&board));
    }
}
