//! Joins: parts of an object that do not touch as one surface, with the evidence that they belong together.

use crate::discovery::ids::NodeId;
use crate::raster::PixelBox;

/// Two parts of one object, and the evidence that they belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Join {
    /// The two parts in the image at the time of the join.
    pub parts: [JoinedPart; 2],
    /// The evidence.
    pub evidence: JoinEvidence,
    /// The node of the support graph that hides the gap between them, if one does.
    pub behind: Option<NodeId>,
}

/// A part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JoinedPart {
    /// The smallest upright rectangle around it.
    pub box_px: PixelBox,
    /// Number of its pixels.
    pub size_px: usize,
}

/// Evidence that two parts are one object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JoinEvidence {
    /// A surface that goes on behind something nearer (docs/CONTEXT.md 4.6).
    Occlusion(Continuation),
    /// Two pieces of the inside of one vessel (docs/CONTEXT.md 4.4.1).
    VesselInside {
        /// Convexity of the larger and of the smaller piece; both are below 0, concave.
        convexity: [f64; 2],
    },
    /// The inside of a vessel and the wall in front of it (docs/CONTEXT.md 4.4.2).
    VesselWall {
        /// Convexity of the inside; below 0 or hardly above.
        convexity: f64,
        /// Number of pixel pairs in which the wall is in front of the inside.
        wall_in_front: u32,
        /// The circle on which both rims lie, if it decided.
        rim: Option<RimCircle>,
    },
    /// A part within the circle of a vessel's rim (docs/CONTEXT.md 4.4.2).
    VesselRim {
        /// The circle.
        rim: RimCircle,
    },
    /// Two pieces of one surface of revolution about up (docs/CONTEXT.md 4.4.4).
    VesselTurned {
        /// Radius of the surface (m).
        radius_m: f64,
        /// Share of the circle about its axis on which the pieces lie.
        covered: f64,
    },
    /// The bottom of a plate or bowl, which lies as low as the table, or is flat and surrounded by its inside (docs/CONTEXT.md 4.5, 4.4.1).
    VesselBottom {
        /// Share of its border that touches the vessel without a step, but for what stands on it.
        contact_share: f64,
    },
    /// The walls of an open box, or its bottom (docs/CONTEXT.md 4.4.6).
    OpenBox {
        /// Share of the bottom's border that the walls bound, but for what lies in the box.
        enclosed_share: f64,
    },
    /// A small part that touches hardly anything but a vessel (docs/CONTEXT.md 4.4.3).
    VesselRemainder {
        /// Share of its contacts that are with the vessel.
        contact_share: f64,
    },
}

/// The measurements that show whether one surface continues another behind an occluder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Continuation {
    /// Disagreement of the common surface with both parts (quanta).
    pub disagreement_quanta: f64,
    /// Angle between the surfaces (degrees).
    pub angle_deg: f64,
    /// Distance of the parts (m).
    pub distance_m: f64,
    /// Share of the gap in which something nearer is seen.
    pub hidden_share: f64,
    /// Share of the gap in which something farther is seen.
    pub seen_through_share: f64,
    /// Overlap of the colour histograms, in [0, 1]; `None` without colour.
    pub color_overlap: Option<f64>,
}

/// The rim of a vessel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RimCircle {
    /// Its centre on the support plane, along the plane's two tangents (m).
    pub center_m: [f64; 2],
    /// Its radius (m).
    pub radius_m: f64,
    /// Root mean square distance of the rim's points from it (m).
    pub residual_m: f64,
    /// Share of its circumference on which points lie.
    pub covered: f64,
}
