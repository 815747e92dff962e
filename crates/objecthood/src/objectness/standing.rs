//! What stands on what in `context`: the clusters that are large enough, the structure, and the forest between them.

use crate::frame::Frame;
use crate::objectness::clustering::Clustering;
use crate::objectness::clusters::Scene;
use crate::objectness::forest::forest;
use crate::objectness::gravity::{StructurePlane, Up, up};
use crate::objectness::hypotheses::{Evidence, Hypothesis, hypotheses};
use crate::objectness::outcome::{Outcome, outcome};
use crate::objectness::support::SupportGraph;
use crate::params::Params;

/// What stands on what, and the regions that do.
#[derive(Clone, Debug)]
pub(crate) struct Standing {
    /// The regions: first the structure, then the clusters that are large enough.
    pub(crate) outcome: Outcome,
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
    let outcome = outcome(scene, clusters, &params.objectness);
    let planes = outcome.counted(planes.to_vec(), frame.measured_px());
    let up = up(scene.support_facet.map(|facet| &planes[facet.index()]), &params.gravity);
    let graph = forest(&outcome.regions, scene.points_m, scene.normals, &planes, &up, scene.space, params);
    Standing { outcome, planes, up, graph }
}

/// The large clusters with their objectness, how high they stand, and why their parts are one. As [`hypotheses`].
pub(crate) fn find_hypotheses(
    scene: &Scene<'_>,
    clusters: &Clustering,
    standing: &Standing,
    params: &Params,
) -> Vec<Hypothesis> {
    let Standing { outcome, planes, up, graph } = standing;
    let &Scene { points_m, normals, space, .. } = scene;
    let evidence = Evidence { regions: &outcome.regions, points_m, normals, support: graph, up, space };
    let mut hypotheses = hypotheses(&evidence, planes.len(), 1, params);
    outcome.describe(&mut hypotheses, clusters);
    hypotheses
}
