//! Clusters: what the surroundings of shapes make of them, rule by rule (METHOD 3.9 to 3.13).

use crate::clusters::bottoms::join_bottoms;
use crate::clusters::cluster::Clusters;
use crate::clusters::fragments::absorb_fragments;
use crate::clusters::height::drop_low;
use crate::clusters::history::History;
use crate::clusters::occlusion::join_behind_occluders;
use crate::clusters::scene::Scene;
use crate::clusters::vessels::join_vessels;
use crate::discovery::join::Join;
use crate::params::{self, Params};
use crate::regions::SegmentId;
use crate::shapes::contraction::Shapes;

/// The parameters of the rules.
#[derive(Clone, Copy, Debug)]
pub struct Rules<'a> {
    /// Of what is small.
    pub fragments: &'a params::Fragments,
    /// Of what hardly rises above the support.
    pub height: &'a params::Height,
    /// Of vessels and their bottoms.
    pub vessels: &'a params::Vessels,
    /// Of parts behind something nearer.
    pub occlusion: &'a params::Occlusion,
}

impl<'a> Rules<'a> {
    /// Those of a whole set of parameters.
    pub fn of(params: &'a Params) -> Self {
        let Params { fragments, height, vessels, occlusion, .. } = params;
        Self { fragments, height, vessels, occlusion }
    }
}

/// A group of shapes that the rules left as one thing. It has the number of one of these shapes.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    pub(crate) id: SegmentId,
    /// In scan order; at least one.
    pub(crate) pixels: Vec<u32>,
    /// How high it stands above the support plane (m), where there is one.
    pub(crate) top_m: Option<f32>,
    /// Which of its parts were joined although they do not touch as one surface, each with the facet that hides what is between.
    pub(crate) joins: Vec<(Join, Option<SegmentId>)>,
}

/// What became of the shapes.
#[derive(Clone, Debug)]
pub struct Clustering {
    /// The clusters that are left, by ascending number.
    pub(crate) clusters: Vec<Cluster>,
    /// The cluster of each facet that is no structure, counted from the first such; `None` = background.
    pub(crate) of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that turned out to be background.
    pub(crate) remains: Vec<u32>,
    pub(crate) history: History,
}

/// Lets the surroundings of shapes decide what is one thing and what is background: fragments, what hardly rises above the
/// support, vessels with their bottoms, and surfaces that go on behind something nearer.
///
/// Each rule is a list of checks on the clusters that the rules before it left. Source: ours, in the place of what the paper
/// calls future work. O(pixels + border pixels · log of them) and what the rules say of themselves.
pub fn find_clusters(scene: &Scene<'_>, shapes: &Shapes, rules: Rules<'_>) -> Clustering {
    let mut clusters = Clusters::new(scene, shapes);
    absorb_fragments(&mut clusters, rules.fragments);
    drop_low(&mut clusters, rules.height);
    join_vessels(&mut clusters, rules.vessels);
    join_bottoms(&mut clusters, rules.vessels);
    join_behind_occluders(&mut clusters, rules.occlusion);
    clusters.finish()
}

impl Clustering {
    /// What the rules did with the clusters, and what they left alone.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The number of pixels of a cluster (px); 0 of one that is not left.
    pub fn size_px(&self, cluster: SegmentId) -> usize {
        self.get(cluster).map_or(0, |cluster| cluster.pixels.len())
    }

    /// A cluster, if it is left.
    pub(crate) fn get(&self, id: SegmentId) -> Option<&Cluster> {
        let place = self.clusters.binary_search_by_key(&id, |cluster| cluster.id).ok()?;
        self.clusters.get(place)
    }
}
