//! Limits that the rules for vessels share.

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::regions::SegmentId;

/// Pieces of one inside touch along at least this many pixel pairs (px at a focal length of 525 px). The same limit applies
/// to a piece that touches an inside within the rim.
pub(super) const INSIDE_TOUCH_PX: usize = 8;

/// The parameter that sets the limits on convexity.
pub(super) const CONCAVITY: &str = "vessels.concavity";
/// The parameter that sets the limits on differences of tops.
pub(super) const RIM_HEIGHT: &str = "vessels.rim_height_m";

/// The surface above which the rules measure heights, and their parameters.
#[derive(Clone, Copy)]
pub(super) struct Limits<'a> {
    pub support: &'a StructureSurface,
    pub params: &'a params::Vessels,
}

impl Limits<'_> {
    /// Height of a cluster's top above the support (m).
    pub(super) fn top_m(&self, clusters: &Clusters<'_>, id: SegmentId) -> f64 {
        clusters.top_m(id, self.support)
    }

    /// Checks that the top of `id` is not higher than the top of `other` by more than the tops of one vessel differ.
    pub(super) fn check_no_higher(&self, clusters: &Clusters<'_>, id: SegmentId, other: SegmentId) -> Check {
        let above_m = self.top_m(clusters, id) - self.top_m(clusters, other);
        Check::new("its top above the other's", "m", above_m, Bound::AtMost, self.params.rim_height_m)
            .set_by(RIM_HEIGHT)
    }
}
