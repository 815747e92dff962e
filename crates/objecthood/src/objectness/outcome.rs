//! What has become of the clusters: regions for the support graph, and hypotheses (METHOD 3.14).

use crate::discovery::ObjectnessParts;
use crate::objectness::clusters::Clusters;
use crate::objectness::decision::Hypothesis;
use crate::objectness::gravity::Up;
use crate::objectness::join::Join;
use crate::objectness::size::oriented_box;
use crate::objectness::support::{NodeId, SupportGraph};
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};

/// The outcome of stage 4.
pub(crate) struct Outcome {
    /// First the structure, with what turned out to be a part of it, then the clusters that are large enough.
    pub regions: Segments,
    /// Those clusters.
    found: Vec<SegmentId>,
    structure: usize,
}

/// Keeps the clusters of at least `min_size_px` pixels. `support`: the structure that remains of clusters belong to.
pub(crate) fn outcome(clusters: &Clusters<'_>, support: Option<usize>, min_size_px: usize) -> Outcome {
    let facets = clusters.scene.facets;
    let structure = facets.structure;
    let mut found = clusters.alive();
    found.retain(|&id| clusters.get(id).pixels.len() >= min_size_px);
    let mut labels = facets.segments.labels().map(|&l| if l < structure as i32 { l } else { Segments::NONE });
    let painted = labels.as_mut_slice();
    if let Some(support) = support {
        clusters.remains().iter().for_each(|&i| painted[i as usize] = support as i32);
    }
    for (k, &id) in found.iter().enumerate() {
        clusters.get(id).pixels.iter().for_each(|&i| painted[i as usize] = (structure + k) as i32);
    }
    Outcome { regions: Segments::from_numbered(labels, structure + found.len()), found, structure }
}

impl Outcome {
    /// The structure of every pixel: 0 = none, else k stands for the surface at index k - 1.
    pub(crate) fn structure_labels(&self) -> Raster<u16> {
        let structure = 0..self.structure as i32;
        self.regions.labels().map(|label| if structure.contains(label) { *label as u16 + 1 } else { 0 })
    }

    /// Every found cluster is an object; `support` has the regions as nodes.
    pub(crate) fn hypotheses(
        &self,
        clusters: &Clusters<'_>,
        support: &SupportGraph,
        up: &Up,
    ) -> Vec<Hypothesis> {
        let scene = clusters.scene;
        let parents = support.parents();
        let judge = |(k, &id): (usize, &SegmentId)| {
            let node = self.structure + k;
            let pixels: Vec<usize> = clusters.get(id).pixels.iter().map(|&i| i as usize).collect();
            let points: Vec<[f32; 3]> = pixels.iter().map(|&i| scene.points_m[i]).collect();
            let p_o = support.nodes[node].p_o;
            let p_s = parents[node].iter().map(|p| support.nodes[p.0 as usize].p_s).fold(0.0, f32::max);
            let top_m = scene.support.map(|surface| clusters.top_m(id, surface) as f32);
            Hypothesis {
                shape: SegmentId(node as u32),
                box_m: oriented_box(&points, up.direction),
                pixels,
                objectness: p_o,
                parts: ObjectnessParts::Context { p_s, p_o, top_m },
                joins: clusters.get(id).joins.iter().map(|join| self.resolve(clusters, id, join)).collect(),
            }
        };
        self.found.iter().enumerate().map(judge).collect()
    }

    /// Says of a join of a cluster which node it is behind: none when what hid the parts became a part of the cluster itself.
    fn resolve(
        &self,
        clusters: &Clusters<'_>,
        own: SegmentId,
        (join, hider): &(Join, Option<SegmentId>),
    ) -> Join {
        let node = |facet: SegmentId| match facet.index().checked_sub(self.structure) {
            None => Some(NodeId(facet.0)),
            Some(free) => {
                let cluster = clusters.of_facet(free).filter(|&cluster| cluster != own)?;
                let place = self.found.binary_search(&cluster).ok()?;
                Some(NodeId((self.structure + place) as u32))
            }
        };
        Join { behind: hider.and_then(node), ..join.clone() }
    }
}
