//! The rules in their order (docs/CONTEXT.md 4.2 to 4.7).

use crate::clusters::bottoms::join_bottoms;
use crate::clusters::bumps::drop_bumps;
use crate::clusters::cluster::Clusters;
use crate::clusters::clustering::Clustering;
use crate::clusters::deep_bottoms::join_deep_bottoms;
use crate::clusters::fragments::absorb_fragments;
use crate::clusters::height::drop_low;
use crate::clusters::necks::join_necks;
use crate::clusters::occlusion::join_behind_occluders;
use crate::clusters::scene::Scene;
use crate::clusters::vessels::join_vessels;
use crate::params::{self, Params};
use crate::shapes::contraction::Shapes;

/// The parameters of the rules.
#[derive(Clone, Copy, Debug)]
pub struct Rules<'a> {
    /// For small clusters.
    pub fragments: &'a params::Fragments,
    /// For clusters that hardly rise above the support.
    pub height: &'a params::Height,
    /// For vessels and their bottoms.
    pub vessels: &'a params::Vessels,
    /// For the convex parts of one body.
    pub necks: &'a params::Necks,
    /// For parts behind something nearer.
    pub occlusion: &'a params::Occlusion,
}

impl<'a> Rules<'a> {
    /// Selects the rules' groups from all parameters.
    pub fn of(params: &'a Params) -> Self {
        let Params { fragments, height, vessels, necks, occlusion, .. } = params;
        Self { fragments, height, vessels, necks, occlusion }
    }
}

/// Decides which shapes are one thing and which are background, by their surroundings.
///
/// Each rule checks the clusters that the rules before it left. Source: ours, because the paper leaves this to future work.
/// O(pixels + border pixels · log(border pixels)), plus the cost of each rule.
pub fn find_clusters(scene: &Scene<'_>, shapes: &Shapes, rules: Rules<'_>) -> Clustering {
    let mut clusters = Clusters::new(scene, shapes);
    absorb_fragments(&mut clusters, rules.fragments);
    drop_low(&mut clusters, rules.height);
    drop_bumps(&mut clusters);
    join_vessels(&mut clusters, rules.vessels);
    join_bottoms(&mut clusters, rules.vessels);
    join_deep_bottoms(&mut clusters, rules.vessels);
    join_necks(&mut clusters, rules.necks);
    join_behind_occluders(&mut clusters, rules.occlusion);
    clusters.finish()
}
