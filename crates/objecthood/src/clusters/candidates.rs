//! Candidates: the clusters that are large enough for an object, as regions of the support graph (docs/CONTEXT.md 6.6).

use std::ops::Range;

use crate::check::{Bound, Check};
use crate::clusters::cluster::find_flat;
use crate::clusters::clustering::{Clustering, FinalCluster};
use crate::clusters::scene::Scene;
use crate::discovery::ids::NodeId;
use crate::discovery::join::Join;
use crate::facets::Facets;
use crate::facets::facet::Flat;
use crate::params;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};
use crate::surface::disparity::DisparitySpace;

/// The structure, and the clusters that are large enough for an object.
#[derive(Clone, Debug)]
pub(crate) struct Candidates {
    /// First the structure, including the clusters given to the background, then the clusters that are large enough.
    pub regions: Segments,
    /// The clusters by ascending number; cluster `found[k]` is region `structure` + k.
    found: Vec<SegmentId>,
    /// The number of regions that are structure.
    structure: usize,
}

/// Checks that a cluster of `size_px` pixels is too small for an object.
pub(crate) fn check_too_small(size_px: usize, space: &DisparitySpace, params: &params::Objectness) -> Check {
    let limit = space.area_px(params.min_size_px) as f64;
    Check::new("its pixels", "px", size_px as f64, Bound::Below, limit).set_by("objectness.min_size_px")
}

/// Finds the clusters that are large enough. Clusters that the rules gave to the background become a part of the support. O(pixels).
pub(crate) fn find_candidates(
    scene: &Scene<'_>,
    clusters: &Clustering,
    params: &params::Objectness,
) -> Candidates {
    let structure = scene.facets.structure;
    let is_kept =
        |cluster: &&FinalCluster| !check_too_small(cluster.pixels.len(), scene.space, params).holds();
    let kept: Vec<&FinalCluster> = clusters.clusters.iter().filter(is_kept).collect();
    let facets = &scene.facets.segments;
    let mut labels = facets.labels().map(|&l| if l < structure as i32 { l } else { Segments::NONE });
    let painted = labels.as_mut_slice();
    for &i in &clusters.remains {
        painted[i as usize] = scene.nearest_support(i as usize).map_or(Segments::NONE, |s| s.0 as i32);
    }
    for (k, cluster) in kept.iter().enumerate() {
        cluster.pixels.iter().for_each(|&i| painted[i as usize] = (structure + k) as i32);
    }
    let found: Vec<SegmentId> = kept.iter().map(|cluster| cluster.id).collect();
    Candidates { regions: Segments::from_numbered(labels, structure + found.len()), found, structure }
}

impl Candidates {
    /// Sets the inlier share of each structure plane to the final share of its region among all points. O(pixels).
    pub(crate) fn count_inliers(
        &self,
        planes: Vec<StructurePlane>,
        points_m: &Raster<[f32; 3]>,
        measured_px: usize,
    ) -> Vec<StructurePlane> {
        let mut size_px = vec![0_usize; self.regions.count()];
        // A hole that was bridged lies on a surface, but has no point.
        let points =
            |run: Range<usize>| points_m.as_slice()[run].iter().filter(|point| !point[2].is_nan()).count();
        self.regions.runs().for_each(|(run, region)| size_px[region] += points(run));
        let share = |size: usize| (size as f64 / measured_px as f64) as f32;
        let planes = planes.into_iter().zip(size_px);
        planes.map(|(plane, size)| StructurePlane { inlier_share: share(size), ..plane }).collect()
    }

    /// The structure of every pixel with depth: 0 = none, k = the surface at index k - 1.
    pub(crate) fn structure_labels(&self, points_m: &Raster<[f32; 3]>) -> Raster<u16> {
        let structure = 0..self.structure as i32;
        let label = |(label, point): (&i32, &[f32; 3])| {
            if structure.contains(label) && !point[2].is_nan() { *label as u16 + 1 } else { 0 }
        };
        let labels = self.regions.labels();
        let pixels = labels.as_slice().iter().zip(points_m.as_slice());
        labels.with_data(pixels.map(label).collect())
    }

    /// Height of the top of a region's cluster above the support (m); `None` without a support.
    pub(crate) fn top_m(&self, region: SegmentId, clusters: &Clustering) -> Option<f32> {
        clusters.get(self.cluster(region))?.top_m
    }

    /// The share of the border of a region's cluster that is with the background, in [0, 1].
    pub(crate) fn alone(&self, region: SegmentId, clusters: &Clustering) -> f32 {
        clusters.get(self.cluster(region)).map_or(0.0, |cluster| cluster.alone)
    }

    /// The flat thing in a region's cluster.
    pub(crate) fn flat<'a>(
        &self,
        region: SegmentId,
        clusters: &Clustering,
        facets: &'a Facets,
    ) -> Option<&'a Flat> {
        find_flat(facets, &clusters.of_facet, self.cluster(region))
    }

    /// The joins of a region's cluster: the evidence for its parts that do not touch as one surface.
    pub(crate) fn joins(&self, region: SegmentId, clusters: &Clustering) -> Vec<Join> {
        let id = self.cluster(region);
        let joins = clusters.get(id).map(|cluster| &cluster.joins[..]).unwrap_or_default();
        joins.iter().map(|join| self.resolve_hider(clusters, id, join)).collect()
    }

    fn cluster(&self, region: SegmentId) -> SegmentId {
        self.found[region.index() - self.structure]
    }

    /// Fills in the node that hides the gap of a join: `None` when the hider became a part of the cluster itself or is no node.
    fn resolve_hider(
        &self,
        clusters: &Clustering,
        own: SegmentId,
        (join, hider): &(Join, Option<SegmentId>),
    ) -> Join {
        let node = |facet: SegmentId| match facet.index().checked_sub(self.structure) {
            None => Some(NodeId(facet.0)),
            Some(free) => {
                let cluster = clusters.of_facet[free].filter(|&cluster| cluster != own)?;
                let place = self.found.binary_search(&cluster).ok()?;
                Some(NodeId((self.structure + place) as u32))
            }
        };
        Join { behind: hider.and_then(node), ..join.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::history::{Event, Rule, Source};
    use crate::clusters::testing::{Table, merge, single};
    use crate::discovery::join::{JoinEvidence, JoinedPart};

    fn three_things() -> Table {
        let rows = ["____________", "_aaa_bb_ccc_", "_aaa_bb_ccc_", "____________"];
        Table::drawn(&rows, &[0.1, 0.05, 0.2])
    }

    /// Parameters with which a candidate of the scene has at least this many pixels.
    fn least(scene: &Scene<'_>, size_px: usize) -> params::Objectness {
        let numbers = 0..10_000;
        let min_size_px = numbers.rev().find(|&px| scene.space.area_px(px) <= size_px).expect("0 is no more");
        params::Objectness { min_size_px, ..Default::default() }
    }

    #[test]
    fn small_clusters_are_nothing_and_remains_are_structure() {
        let table = three_things();
        let scene = table.scene();
        let mut clusters = single(&scene);
        merge(&mut clusters, None, SegmentId(0));
        let clusters = clusters.finish();
        let candidates = find_candidates(&scene, &clusters, &least(&scene, 5));
        let row: Vec<i32> = candidates.regions.labels().as_slice()[12..24].to_vec();
        assert_eq!(row, [0, 0, 0, 0, 0, -1, -1, 0, 1, 1, 1, 0]);
        assert_eq!(candidates.regions.count(), 2);
        let structure: Vec<u16> = candidates.structure_labels(scene.points_m).as_slice()[12..24].to_vec();
        assert_eq!(structure, [1, 1, 1, 1, 1, 0, 0, 1, 0, 0, 0, 1]);
        let top_m = candidates.top_m(SegmentId(1), &clusters);
        assert!(top_m.is_some_and(|top_m| (top_m - 0.2).abs() < 1e-3), "{top_m:?}");
    }

    #[test]
    fn an_object_is_not_behind_itself() {
        let table = three_things();
        let scene = table.scene();
        let part = JoinedPart { box_px: crate::PixelBox { u: 0, v: 0, width: 1, height: 1 }, size_px: 1 };
        let evidence = JoinEvidence::VesselRemainder { contact_share: 1.0 };
        let join = Join { parts: [part; 2], evidence, behind: None };
        // Facet 0 is the table, facet 2 is thing b. A small cluster is no node, and neither is a part of the object.
        let behind = |hider: u32, min_size_px: usize, merged: bool| {
            let mut clusters = single(&scene);
            clusters.give(Event {
                rule: Rule::Occlusion,
                from: Source::Cluster(SegmentId(2)),
                into: Some(SegmentId(0)),
                checks: Vec::new(),
                join: Some((join.clone(), Some(SegmentId(hider)))),
            });
            if merged {
                merge(&mut clusters, Some(SegmentId(0)), SegmentId(1));
            }
            let clusters = clusters.finish();
            let candidates = find_candidates(&scene, &clusters, &least(&scene, min_size_px));
            candidates.joins(SegmentId(1), &clusters)[0].behind
        };
        assert_eq!(behind(0, 1, false), Some(NodeId(0)));
        assert_eq!(behind(2, 1, false), Some(NodeId(2)));
        assert_eq!(behind(2, 5, false), None);
        assert_eq!(behind(2, 1, true), None);
    }
}
