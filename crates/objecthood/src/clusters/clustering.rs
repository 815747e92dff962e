//! What became of the shapes when all rules are done.

use crate::clusters::history::History;
use crate::discovery::join::Join;
use crate::regions::SegmentId;

/// A group of shapes that the rules left as one thing. Its number is that of one of these shapes.
#[derive(Clone, Debug)]
pub(crate) struct FinalCluster {
    pub(crate) id: SegmentId,
    /// In scan order; at least one.
    pub(crate) pixels: Vec<u32>,
    /// How high it stands above the support plane (m), where there is one.
    pub(crate) top_m: Option<f32>,
    /// Why those of its parts are one that do not touch as one surface; each with the facet that hides the gap, if one does.
    pub(crate) joins: Vec<(Join, Option<SegmentId>)>,
}

/// What became of the shapes.
#[derive(Clone, Debug)]
pub struct Clustering {
    /// The clusters that are left, by ascending number.
    pub(crate) clusters: Vec<FinalCluster>,
    /// The cluster of each facet that is no structure, counted from the first such; `None` = background.
    pub(crate) of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that turned out to be background.
    pub(crate) remains: Vec<u32>,
    /// What the rules did and what they refused.
    pub(crate) history: History,
}

impl Clustering {
    /// What the rules did and what they refused.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The number of pixels of a cluster (px); 0 of one that is not left.
    pub fn size_px(&self, cluster: SegmentId) -> usize {
        self.get(cluster).map_or(0, |cluster| cluster.pixels.len())
    }

    /// A cluster, if it is left.
    pub(crate) fn get(&self, id: SegmentId) -> Option<&FinalCluster> {
        let place = self.clusters.binary_search_by_key(&id, |cluster| cluster.id).ok()?;
        self.clusters.get(place)
    }
}
