//! Limits that the rules for vessels share.

use crate::check::{Bound, Check};
use crate::clusters::cluster::Clusters;
use crate::clusters::colors::Colors;
use crate::clusters::scene::Scene;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::regions::SegmentId;

/// Least number of pixels of an inside, of a wall, and of a piece of a round vessel (px at a focal length of 525 px).
pub(super) const PART_PX: usize = 100;

/// Pieces of one inside touch along at least this many pixel pairs (px at a focal length of 525 px). The same limit applies
/// to a piece that touches an inside within the rim.
pub(super) const INSIDE_TOUCH_PX: usize = 8;

/// Parts of one vessel share at least this much of their colours (overlap of histograms, 0 to 1): less than the parts of a body across
/// a neck, because an inside lies in its own shadow. Contents of another colour share next to nothing.
const COLOR_OVERLAP: f64 = 0.2;

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

    /// Checks that a convexity is as far below 0 as that of an inside, or this share of it.
    pub(super) fn check_concave(&self, what: &'static str, convexity: f64, share: f64) -> Check {
        Check::new(what, "", convexity, Bound::AtMost, -self.params.concavity * share).set_by(CONCAVITY)
    }

    /// Checks that the top of `id` is not higher than the top of `other` by more than the tops of one vessel differ.
    pub(super) fn check_no_higher(&self, clusters: &Clusters<'_>, id: SegmentId, other: SegmentId) -> Check {
        let above_m = self.top_m(clusters, id) - self.top_m(clusters, other);
        Check::new("its top above the other's", "m", above_m, Bound::AtMost, self.params.rim_height_m)
            .set_by(RIM_HEIGHT)
    }

    /// Checks that a cluster shares colours with one of the parts of a vessel; without colour it holds.
    pub(super) fn check_color(&self, clusters: &Clusters<'_>, id: SegmentId, parts: &[SegmentId]) -> Check {
        let colors = |id: SegmentId| Colors::of(clusters.scene, &clusters.get(id).pixels);
        let overlap = clusters.scene.lab.map_or(1.0, |_| {
            let own = colors(id);
            parts.iter().map(|&part| own.overlap(&colors(part))).fold(0.0, f64::max)
        });
        Check::new("overlap of their colours", "", overlap, Bound::AtLeast, COLOR_OVERLAP)
    }
}

/// Checks that two walls share colours in the same light, which falls on each from another side; without colour it holds.
pub(super) fn check_walls_color(scene: &Scene<'_>, [a, b]: [&Colors; 2]) -> Check {
    let overlap = scene.lab.map_or(1.0, |_| a.overlap_in_light(b));
    Check::new("overlap of their colours in the same light", "", overlap, Bound::AtLeast, COLOR_OVERLAP)
}
