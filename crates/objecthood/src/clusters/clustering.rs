//! The clusters after all rules.

use crate::clusters::history::History;
use crate::discovery::join::Join;
use crate::regions::SegmentId;

/// A cluster that remains after all rules. Its number is the number of one of its shapes.
#[derive(Clone, Debug)]
pub(crate) struct FinalCluster {
    pub(crate) id: SegmentId,
    /// In scan order; at least one.
    pub(crate) pixels: Vec<u32>,
    /// Height of its top above the support surface (m), if there is one.
    pub(crate) top_m: Option<f32>,
    /// The share of its border that is with the background, in [0, 1].
    pub(crate) alone: f32,
    /// The joins of its parts that do not touch as one surface; each with the facet that hides the gap, if one does.
    pub(crate) joins: Vec<(Join, Option<SegmentId>)>,
}

/// The clusters after all rules, with their history.
#[derive(Clone, Debug)]
pub struct Clustering {
    /// The clusters that remain, by ascending number.
    pub(crate) clusters: Vec<FinalCluster>,
    /// The cluster of each facet outside the structure; these facets are counted from 0. `None` = background.
    pub(crate) of_facet: Vec<Option<SegmentId>>,
    /// Pixels of clusters that rules gave to the background.
    pub(crate) remains: Vec<u32>,
    /// The joins of the rules and their refusals.
    pub(crate) history: History,
}

impl Clustering {
    /// The joins of the rules and their refusals.
    pub fn history(&self) -> &History {
        &self.history
    }

    /// The number of pixels of a cluster; 0 if it does not remain.
    pub fn size_px(&self, cluster: SegmentId) -> usize {
        self.get(cluster).map_or(0, |cluster| cluster.pixels.len())
    }

    /// The cluster with this number, if it remains.
    pub(crate) fn get(&self, id: SegmentId) -> Option<&FinalCluster> {
        let place = self.clusters.binary_search_by_key(&id, |cluster| cluster.id).ok()?;
        self.clusters.get(place)
    }
}
