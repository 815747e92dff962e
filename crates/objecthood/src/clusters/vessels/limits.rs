//! Limits that the rules for vessels share.

use crate::clusters::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::regions::SegmentId;

/// Pieces of one inside touch along at least this many pixels (px at a focal length of 525 px); so does what clings to an inside.
pub(super) const INSIDE_TOUCH_PX: usize = 8;

/// The parameter that limits how far an inside bends outwards.
pub(super) const CONCAVITY: &str = "vessels.concavity";
/// The parameter that limits how far tops of one vessel differ.
pub(super) const RIM_HEIGHT: &str = "vessels.rim_height_m";

/// What the rules measure heights from, and their parameters.
#[derive(Clone, Copy)]
pub(super) struct Limits<'a> {
    pub support: &'a StructureSurface,
    pub params: &'a params::Vessels,
}

impl Limits<'_> {
    /// How high a cluster stands above the support (m).
    pub(super) fn top_m(&self, clusters: &Clusters<'_>, id: SegmentId) -> f64 {
        clusters.top_m(id, self.support)
    }

    /// Checks that `id` stands no higher above `other` than tops of one vessel differ.
    pub(super) fn check_no_higher(&self, clusters: &Clusters<'_>, id: SegmentId, other: SegmentId) -> Check {
        let above_m = self.top_m(clusters, id) - self.top_m(clusters, other);
        Check::new("its top above the other's", "m", above_m, Bound::AtMost, self.params.rim_height_m)
            .set_by(RIM_HEIGHT)
    }
}
