//! The objects, and what they are made of.

use objecthood::discovery;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One thing that can be grasped and moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneObject {
    /// Its number in the label image.
    #[schemars(range(min = 1))]
    pub id: u16,
    /// How sure it is.
    #[schemars(range(min = 0, max = 1))]
    pub objectness: f32,
    /// What the objectness is made of.
    pub parts: ObjectnessParts,
    /// Its pixels in the label image (px).
    #[schemars(range(min = 1))]
    pub size_px: usize,
    /// The smallest upright rectangle around its pixels.
    pub box_px: PixelBox,
    /// Mean of its points, camera frame (m).
    pub centroid_m: [f32; 3],
    /// Oriented box around its points, one axis along up.
    pub box_m: OrientedBox,
    /// How high it stands above the support plane (m); absent where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f32")]
    pub top_m: Option<f32>,
    /// Whether it is a thing 0.2 to 12 mm thick that lies flat on its support; absent where it is not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub flat: bool,
    /// Number of facets it is made of.
    pub facets: usize,
    /// Its node: index into the nodes of the support graph.
    pub node: u32,
    /// The nodes that it stands on, lies in or leans against.
    pub parents: Vec<u32>,
    /// Which of its parts were joined although they do not touch as one surface, and why.
    pub joins: Vec<Join>,
}

/// What an objectness is made of: 1 speaks for an object, or at least not against one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectnessParts {
    /// Whether it has the size of something graspable: not too long, and not thin in two directions.
    #[schemars(range(min = 0, max = 1))]
    pub size: f32,
    /// Whether something carries it: P(O), half of it lost when what carries it is merely guessed.
    #[schemars(range(min = 0, max = 1))]
    pub support: f32,
    /// Whether it stands on the structure, itself or on what carries it, and does not hang in the air.
    #[schemars(range(min = 0, max = 1))]
    pub footing: f32,
    /// How much of its hull in the image it fills, as far as nothing hides it.
    #[schemars(range(min = 0, max = 1))]
    pub compactness: f32,
    /// How clear its borders are: steps in depth and valleys, not flat or convex folds.
    #[schemars(range(min = 0, max = 1))]
    pub separation: f32,
    /// How much of its outline is its own, and neither something nearer's nor the border of the image.
    #[schemars(range(min = 0, max = 1))]
    pub visibility: f32,
}

/// Two parts of one object, and why they belong together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Join {
    /// Where the two parts were when they were joined.
    pub parts: [JoinedPart; 2],
    /// Node of what hides the object between them; absent when nothing known does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u32")]
    pub behind: Option<u32>,
    /// Why.
    pub evidence: JoinEvidence,
}

/// A part of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JoinedPart {
    /// The smallest upright rectangle around it.
    pub box_px: PixelBox,
    /// Its pixels (px).
    #[schemars(range(min = 1))]
    pub size_px: usize,
}

/// Why two parts are one object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum JoinEvidence {
    /// One surface that goes on behind something nearer.
    Occlusion {
        /// How far the common surface is from both parts (quanta of disparity).
        disagreement_quanta: f64,
        /// Angle between the surfaces (degrees).
        angle_deg: f64,
        /// Distance of the parts (m).
        distance_m: f64,
        /// Share of the gap in which something nearer is seen.
        #[schemars(range(min = 0, max = 1))]
        hidden_share: f64,
        /// Share of the gap in which something farther is seen.
        #[schemars(range(min = 0, max = 1))]
        seen_through_share: f64,
        /// Overlap of the colour histograms; absent without colour.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "f64", range(min = 0, max = 1))]
        color_overlap: Option<f64>,
    },
    /// Two pieces of the inside of one vessel.
    VesselInside {
        /// How far the larger and the smaller piece bend outwards: both inwards, below 0.
        convexity: [f64; 2],
    },
    /// The inside of a vessel and the wall before it.
    VesselWall {
        /// How far the inside bends outwards: inwards, below 0, or hardly.
        convexity: f64,
        /// Pixel pairs in which the wall is before the inside.
        wall_in_front: u32,
        /// Radius of the circle on which both rims lie (m), if that decided.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "f64", extend("exclusiveMinimum" = 0))]
        rim_radius_m: Option<f64>,
        /// Root mean square distance of the rim from that circle (m).
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "f64", range(min = 0))]
        rim_residual_m: Option<f64>,
    },
    /// What stands within the circle of a vessel's rim and as high.
    VesselRim {
        /// Radius of the circle (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        rim_radius_m: f64,
        /// Root mean square distance of the rim from it (m).
        #[schemars(range(min = 0))]
        rim_residual_m: f64,
    },
    /// Pieces of one round vessel, whose surface turns about an upright axis.
    VesselTurned {
        /// Radius of the surface (m).
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius_m: f64,
        /// Share of the circle about its axis on which the pieces lie.
        #[schemars(range(min = 0, max = 1))]
        covered: f64,
    },
    /// The bottom of a plate or bowl, which lies as low as the table, or is flat and surrounded by its inside.
    VesselBottom {
        /// Share of its border that touches the vessel without a step, but for what stands on it.
        #[schemars(range(min = 0, max = 1))]
        contact_share: f64,
    },
    /// The walls of an open box, or its bottom.
    OpenBox {
        /// Share of the bottom's border that the walls bound, but for what lies in the box.
        #[schemars(range(min = 0, max = 1))]
        enclosed_share: f64,
    },
    /// A small part that touches hardly anything but a vessel.
    VesselRemainder {
        /// Share of its contacts that are with the vessel.
        #[schemars(range(min = 0, max = 1))]
        contact_share: f64,
    },
}

/// An upright rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PixelBox {
    /// Leftmost column (px).
    pub u: usize,
    /// Topmost row (px).
    pub v: usize,
    /// Number of columns (px).
    #[schemars(range(min = 1))]
    pub width: usize,
    /// Number of rows (px).
    #[schemars(range(min = 1))]
    pub height: usize,
}

/// A box with any orientation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OrientedBox {
    /// Its middle, camera frame (m).
    pub center_m: [f32; 3],
    /// Rotation that takes its axes to the camera frame, as a unit quaternion x, y, z, w.
    pub rotation_xyzw: [f32; 4],
    /// Full length of its sides (m), along its own x, y and z axes.
    #[schemars(inner(range(min = 0)))]
    pub extents_m: [f32; 3],
}

impl From<&objecthood::Object> for SceneObject {
    fn from(object: &objecthood::Object) -> Self {
        let objecthood::OrientedBox { center_m, rotation_xyzw, extents_m } = object.box_m;
        let objecthood::ObjectnessParts { size, support, footing, compactness, separation, visibility } =
            object.parts;
        Self {
            id: object.id.0,
            objectness: object.objectness,
            parts: ObjectnessParts { size, support, footing, compactness, separation, visibility },
            size_px: object.size_px,
            box_px: object.box_px.into(),
            centroid_m: object.centroid_m,
            box_m: OrientedBox { center_m, rotation_xyzw, extents_m },
            top_m: object.top_m,
            flat: object.is_flat,
            facets: object.facets,
            node: object.node.0,
            parents: object.parents.iter().map(|node| node.0).collect(),
            joins: object.joins.iter().map(Join::from).collect(),
        }
    }
}

impl From<&discovery::Join> for Join {
    fn from(join: &discovery::Join) -> Self {
        let parts = join.parts.map(|part| JoinedPart { box_px: part.box_px.into(), size_px: part.size_px });
        Self { parts, behind: join.behind.map(|node| node.0), evidence: join.evidence.into() }
    }
}

impl From<discovery::JoinEvidence> for JoinEvidence {
    fn from(evidence: discovery::JoinEvidence) -> Self {
        match evidence {
            discovery::JoinEvidence::Occlusion(continuation) => {
                let discovery::Continuation {
                    disagreement_quanta,
                    angle_deg,
                    distance_m,
                    hidden_share,
                    seen_through_share,
                    color_overlap,
                } = continuation;
                Self::Occlusion {
                    disagreement_quanta,
                    angle_deg,
                    distance_m,
                    hidden_share,
                    seen_through_share,
                    color_overlap,
                }
            }
            discovery::JoinEvidence::VesselInside { convexity } => Self::VesselInside { convexity },
            discovery::JoinEvidence::VesselWall { convexity, wall_in_front, rim } => Self::VesselWall {
                convexity,
                wall_in_front,
                rim_radius_m: rim.map(|rim| rim.radius_m),
                rim_residual_m: rim.map(|rim| rim.residual_m),
            },
            discovery::JoinEvidence::VesselRim { rim } => {
                Self::VesselRim { rim_radius_m: rim.radius_m, rim_residual_m: rim.residual_m }
            }
            discovery::JoinEvidence::VesselTurned { radius_m, covered } => {
                Self::VesselTurned { radius_m, covered }
            }
            discovery::JoinEvidence::VesselBottom { contact_share } => Self::VesselBottom { contact_share },
            discovery::JoinEvidence::OpenBox { enclosed_share } => Self::OpenBox { enclosed_share },
            discovery::JoinEvidence::VesselRemainder { contact_share } => {
                Self::VesselRemainder { contact_share }
            }
        }
    }
}

impl From<objecthood::PixelBox> for PixelBox {
    fn from(objecthood::PixelBox { u, v, width, height }: objecthood::PixelBox) -> Self {
        Self { u, v, width, height }
    }
}
