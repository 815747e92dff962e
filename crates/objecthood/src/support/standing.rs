//! What stands on what in `context`: the clusters that are large enough, the structure, and the forest between them.

use crate::clusters::candidates::{Candidates, find_candidates};
use crate::clusters::clustering::Clustering;
use crate::clusters::scene::Scene;
use crate::discovery::support_graph::SupportGraph;
use crate::discovery::up::Up;
use crate::frame::Frame;
use crate::params::Params;
use crate::planes::StructurePlane;
use crate::support::forest::forest;
use crate::support::gravity::up;

/// What stands on what, and the regions that do.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    /// The regions: first the structure, then the clusters that are large enough.
    pub(crate) candidates: Candidates,
    /// The planes of the structure, with the share of the points that is theirs.
    pub(crate) planes: Vec<StructurePlane>,
    /// The direction against gravity.
    pub(crate) up: Up,
    /// Node k is region k.
    pub(crate) graph: SupportGraph,
}

/// Finds up and what stands on what. `planes`: those of the structure. O(pixels) and what [`forest`] says.
pub(crate) fn find_standing(
    frame: &Frame,
    scene: &Scene<'_>,
    clusters: &Clustering,
    planes: &[StructurePlane],
    params: &Params,
) -> Standing {
    let candidates = find_candidates(scene, clusters, &params.objectness);
    let planes = candidates.count_inliers(planes.to_vec(), frame.measured_px());
    let up = up(scene.support_facet.map(|facet| &planes[facet.index()]), &params.gravity);
    let graph = forest(&candidates.regions, scene.points_m, scene.normals, &planes, &up, scene.space, params);
    Standing { candidates, planes, up, graph }
}
