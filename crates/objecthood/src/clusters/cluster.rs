//! Clusters while the rules work on them: pixels, borders, top and convexity (docs/CONTEXT.md 4.1).

use std::collections::BTreeMap;
use std::sync::OnceLock;

use crate::clusters::borders::{BorderCounts, count_borders};
use crate::clusters::clustering::{Clustering, FinalCluster};
use crate::clusters::convexity::measure_convexity;
use crate::clusters::history::{Event, History, Proposal, Source};
use crate::clusters::scene::Scene;
use crate::discovery::join::{Join, JoinEvidence, JoinedPart};
use crate::facets::Facets;
use crate::facets::facet::Flat;
use crate::oversegment::structure::StructureSurface;
use crate::quantile::element_at;
use crate::raster::PixelBox;
use crate::regions::SegmentId;
use crate::shapes::contraction::Shapes;

/// A group of facets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cluster {
    /// In scan order; empty when it has been merged into another.
    pub pixels: Vec<u32>,
    /// Its borders with other clusters; `None` = the background: all structure, and the clusters given to it.
    pub neighbours: BTreeMap<Option<SegmentId>, BorderCounts>,
    /// Places in the history: the events that gave it something, and the events of the clusters merged into it.
    events: Vec<usize>,
    top_m: OnceLock<f64>,
    convexity: OnceLock<f64>,
}

impl Cluster {
    /// The share of its border that is with the background, in [0, 1]; 1 without a border.
    fn alone(&self) -> f32 {
        let all: u32 = self.neighbours.values().map(BorderCounts::all).sum();
        let bare = self.neighbours.get(&None).map_or(0, BorderCounts::all);
        if all == 0 { 1.0 } else { bare as f32 / all as f32 }
    }
}

/// The clusters of a frame. Merging keeps their borders, events and facets up to date.
pub(crate) struct Clusters<'a> {
    pub scene: &'a Scene<'a>,
    clusters: Vec<Cluster>,
    /// Cluster of each facet that is no structure; `None` = background.
    of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that rules gave to the background.
    remains: Vec<u32>,
    pub history: History,
}

/// The top of a cluster is this quantile of its heights: single noisy pixels stand high anywhere.
const TOP_SHARE: f64 = 0.98;
/// The top of a cluster is measured on every other of its pixels: half of them give nearly the same quantile.
const TOP_STEP: usize = 2;

impl<'a> Clusters<'a> {
    /// One cluster per shape. O(pixels + border pixels · log(border pixels)).
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
        let (mut clusters, borders) = rayon::join(gather, || count_borders(scene, shapes));
        for edge in borders.edges() {
            // Region 0 is the background.
            let [a, b] = [edge.a, edge.b].map(|k| k.0.checked_sub(1).map(SegmentId));
            for (own, other, counts) in [(a, b, edge.evidence), (b, a, edge.evidence.mirrored())] {
                if let Some(own) = own {
                    clusters[own.index()].neighbours.insert(other, counts);
                }
            }
        }
        Self { scene, clusters, of_facet, remains: Vec::new(), history: History::default() }
    }

    /// The clusters that have pixels, in ascending order.
    pub(crate) fn alive(&self) -> Vec<SegmentId> {
        let alive = (0..self.clusters.len()).filter(|&k| !self.clusters[k].pixels.is_empty());
        alive.map(|k| SegmentId(k as u32)).collect()
    }

    /// The cluster with this number.
    pub(crate) fn get(&self, id: SegmentId) -> &Cluster {
        &self.clusters[id.index()]
    }

    /// The cluster of a facet outside the structure; these facets are counted from 0. `None` = background.
    pub(crate) fn of_facet(&self, facet: usize) -> Option<SegmentId> {
        self.of_facet[facet]
    }

    /// The cluster that a pixel belongs to by its facet. `None` = background, or no facet.
    pub(crate) fn at_pixel(&self, i: usize) -> Option<SegmentId> {
        let facet = self.scene.facets.segments.at(i)?;
        self.of_facet(facet.index().checked_sub(self.scene.facets.structure)?)
    }

    /// The flat thing in a cluster, the surest if it has several (docs/CONTEXT.md 2.4).
    pub(crate) fn flat(&self, id: SegmentId) -> Option<&'a Flat> {
        find_flat(self.scene.facets, &self.of_facet, id)
    }

    /// The size of a cluster and its place in the image, as a part of a join.
    pub(crate) fn part(&self, id: SegmentId) -> JoinedPart {
        let pixels = self.get(id).pixels.iter().map(|&i| i as usize);
        JoinedPart { size_px: pixels.len(), box_px: PixelBox::around(pixels, self.scene.disparity.width()) }
    }

    /// The border of `a` with `b`.
    pub(crate) fn borders(&self, a: SegmentId, b: SegmentId) -> BorderCounts {
        self.get(a).neighbours.get(&Some(b)).copied().unwrap_or_default()
    }

    /// The joins of a cluster's parts that do not touch as one surface; each with the facet that hides the gap, if one does.
    pub(crate) fn joins(&self, id: SegmentId) -> impl Iterator<Item = &(Join, Option<SegmentId>)> {
        let events = self.get(id).events.iter().map(|&place| &self.history.events()[place]);
        events.filter_map(|event| event.join.as_ref())
    }

    /// The clusters that remain after all rules. O(clusters + the pixels whose heights are not computed yet).
    pub(crate) fn finish(mut self) -> Clustering {
        let left = self.alive().into_iter().map(|id| FinalCluster {
            id,
            top_m: self.own_top_m(id).map(|top_m| top_m as f32),
            alone: self.get(id).alone(),
            joins: self.joins(id).cloned().collect(),
            pixels: Vec::new(),
        });
        let mut left: Vec<FinalCluster> = left.collect();
        for cluster in &mut left {
            cluster.pixels = std::mem::take(&mut self.clusters[cluster.id.index()].pixels);
        }
        let Self { of_facet, remains, history, .. } = self;
        Clustering { clusters: left, of_facet, remains, history }
    }

    /// Carries out an event and records it: a cluster is merged. For a patch of background it only records; [`Self::extend`] adds the
    /// pixels. O(n log n + neighbours) for the n pixels between the first and the last one given.
    pub(crate) fn give(&mut self, event: Event) {
        if let Source::Cluster(from) = event.from {
            self.merge(event.into, from);
        }
        let into = event.into;
        let place = self.history.note(event);
        if let Some(into) = into {
            self.clusters[into.index()].events.push(place);
        }
    }

    /// Joins two clusters that do not touch as one surface, and records the evidence.
    pub(crate) fn join(&mut self, proposal: Proposal, evidence: JoinEvidence) {
        if let Some(pair) = proposal.clusters() {
            let parts = pair.map(|id| self.part(id));
            self.give(proposal.accept(Some((Join { parts, evidence, behind: None }, None))));
        }
    }

    /// Merges a cluster into another or into the background, with its borders and events.
    fn merge(&mut self, into: Option<SegmentId>, from: SegmentId) {
        let Cluster { pixels, neighbours, events, .. } = std::mem::take(&mut self.clusters[from.index()]);
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
            return;
        };
        let cluster = &mut self.clusters[into.index()];
        cluster.neighbours.remove(&Some(from));
        cluster.events.extend(events);
        cluster.extend(&pixels);
    }

    /// Adds pixels of the background to a cluster. O(n log n) for the n pixels between the first and the last one added.
    pub(crate) fn extend(&mut self, id: SegmentId, pixels: &[u32]) {
        self.clusters[id.index()].extend(pixels);
    }

    /// Height (m) of the top of a cluster above a surface, from every other pixel; kept until the cluster changes.
    pub(crate) fn top_m(&self, id: SegmentId, ground: &StructureSurface) -> f64 {
        *self.get(id).top_m.get_or_init(|| self.top_of_m(id, |i| self.scene.height_m(i, ground)))
    }

    /// Height of the top of a cluster above the support below it (m); `None` without a support.
    pub(crate) fn own_top_m(&self, id: SegmentId) -> Option<f64> {
        let support = self.scene.own_support(&self.get(id).pixels)?;
        Some(self.top_of_m(id, |i| self.scene.height_over_m(i, support)))
    }

    /// The quantile of the heights (m) of a cluster's pixels that is its top.
    fn top_of_m(&self, id: SegmentId, height_m: impl Fn(usize) -> f64) -> f64 {
        let sample = self.get(id).pixels.iter().step_by(TOP_STEP);
        let mut heights: Vec<f64> = sample.map(|&i| height_m(i as usize)).collect();
        element_at(&mut heights, TOP_SHARE)
    }

    /// The convexity of a cluster, see [`measure_convexity`]; kept until the cluster changes. O(1).
    pub(crate) fn convexity(&self, id: SegmentId) -> f64 {
        let cluster = self.get(id);
        *cluster.convexity.get_or_init(|| measure_convexity(self.scene, &cluster.pixels))
    }
}

/// The flat thing in a cluster, the surest if it has several. `of_facet`: the cluster of each facet outside the structure. O(flat things).
pub(crate) fn find_flat<'f>(
    facets: &'f Facets,
    of_facet: &[Option<SegmentId>],
    id: SegmentId,
) -> Option<&'f Flat> {
    let own = facets.flats.iter().filter(|flat| of_facet[flat.facet.index() - facets.structure] == Some(id));
    own.max_by_key(|flat| flat.is_proven)
}

impl Cluster {
    /// Adds pixels and keeps the scan order.
    fn extend(&mut self, pixels: &[u32]) {
        let (Some(first), Some(last)) = (pixels.iter().min(), pixels.iter().max()) else { return };
        // Only the pixels between the first and the last new one are out of order.
        let [from, to] = [first, last].map(|end| self.pixels.partition_point(|own| own < end));
        let behind = self.pixels.split_off(to);
        self.pixels.extend(pixels);
        self.pixels[from..].sort();
        self.pixels.extend(behind);
        self.top_m = OnceLock::new();
        self.convexity = OnceLock::new();
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;
    use crate::clusters::testing::{Table, merge, named, single};
    use crate::raster::Raster;
    use crate::testing::{raster, small_size};

    /// A small image of up to four facets on a table, with heights that are equal, a step apart or far apart; some pixels are missing.
    fn scenery() -> impl Strategy<Value = Table> {
        let pixel = (prop_oneof![1 => Just(None), 4 => (0_i32..5).prop_map(Some)], 0_u8..4);
        small_size().prop_flat_map(move |size| raster(size, pixel.clone())).prop_map(|pixels| {
            Table::new(pixels.size(), |u, v| {
                let (facet, level) = pixels.get(u, v)?;
                Some(((*facet)?, [0.0, 0.013, 0.016, 0.2][usize::from(*level)]))
            })
        })
    }

    /// The pixels of a cluster and its borders.
    type Counted = (Vec<u32>, BTreeMap<Option<SegmentId>, BorderCounts>);

    /// Pixels and borders of every cluster, from the cluster of each pixel: `None` = no facet, `Some(None)` = background.
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
            // Neighbours with only holes between them.
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
                // The events, in their order, give the cluster of every facet.
                let events = clusters.history.events();
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
    }
}
