//! Support in `context`: the candidates, the structure, and the forest between them.

use crate::attitude::Attitude;
use crate::clusters::candidates::{Candidates, find_candidates};
use crate::clusters::clustering::Clustering;
use crate::clusters::scene::Scene;
use crate::discovery::support_graph::SupportGraph;
use crate::discovery::up::Up;
use crate::frame::Frame;
use crate::params::{self, Params};
use crate::planes::StructurePlane;
use crate::regions::Segments;
use crate::support::footing::{Footing, measure_footing};
use crate::support::forest::build_forest;
use crate::support::gravity::find_up;
use crate::support::scene::SupportScene;

/// The support graph of `context`, and the regions that are its nodes.
#[derive(Clone, Debug)]
pub struct Standing {
    /// The regions: first the structure, then the clusters that are large enough.
    pub(crate) candidates: Candidates,
    /// The planes of the structure, with their shares of the points.
    pub(crate) planes: Vec<StructurePlane>,
    /// The direction against gravity.
    pub(crate) up: Up,
    /// Node k is region k.
    pub(crate) graph: SupportGraph,
    /// What the columns below the regions tell.
    pub(crate) footing: Footing,
}

/// The parameters of [`find_standing`].
#[derive(Clone, Copy, Debug)]
pub struct StandingParams<'a> {
    /// For regions in contact.
    pub contact: &'a params::Contact,
    /// For the direction up.
    pub gravity: &'a params::Gravity,
    /// For the size of candidates and of vessels.
    pub objectness: &'a params::Objectness,
}

impl<'a> StandingParams<'a> {
    /// Selects the groups of [`find_standing`] from all parameters.
    pub fn of(params: &'a Params) -> Self {
        let Params { contact, gravity, objectness, .. } = params;
        Self { contact, gravity, objectness }
    }
}

/// Finds the candidates, the direction up and the support graph. O(pixels), plus the cost of
/// [`build_forest`].
pub fn find_standing(
    frame: &Frame,
    scene: &Scene<'_>,
    clusters: &Clustering,
    params: StandingParams<'_>,
) -> Standing {
    let candidates = find_candidates(scene, clusters, params.objectness);
    let planes = candidates.count_inliers(scene.planes.to_vec(), scene.points_m, frame.measured_px());
    let ground = scene.ground_facet().map(|facet| &planes[facet.index()]);
    let up = find_up(ground, &Attitude::of(frame, params.gravity), params.gravity.up_from);
    let &Scene { points_m, normals, space, .. } = scene;
    let support_scene =
        SupportScene { regions: &candidates.regions, points_m, normals, planes: &planes, up: &up, space };
    let graph = build_forest(&support_scene, params.contact, params.objectness);
    let footing = measure_footing(&support_scene, &graph, params.objectness);
    Standing { candidates, planes, up, graph, footing }
}

impl Standing {
    /// The regions: first the structure, then the clusters that are large enough for an object.
    pub fn regions(&self) -> &Segments {
        &self.candidates.regions
    }

    /// The support graph: node k is region k.
    pub fn graph(&self) -> &SupportGraph {
        &self.graph
    }
}
