//! The scene file: what was found in a frame, as JSON.
//!
//! These types are the contract with whoever reads the files; they follow [`Discovery`] but change only with
//! [`SCHEMA_VERSION`]. Their schema, made from the texts below, is published as `docs/scene.schema.json`.

use objecthood::discovery::{self, Doubt, NodeKind, Notice};
use objecthood::{Discovery, Params};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::capture::{Capture, Pose};
use crate::error::Result;
use crate::json;
use crate::organize::PointList;

/// Version of the schema that is written. A reader of version 1 can read every file of version 1.
pub const SCHEMA_VERSION: u32 = 1;

/// What objecthood found in one RGB-D frame.
///
/// Camera frame: x right, y down, z forward along the optical axis, metres. Pixels: u counts columns to the right,
/// v rows downwards, both from 0; the centres of pixels lie at integers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "objecthood scene")]
pub struct SceneFile {
    /// Version of this schema: 1.
    #[schemars(range(min = 1, max = 1))]
    pub schema_version: u32,
    /// Version of objecthood that wrote the file.
    #[schemars(length(min = 1))]
    pub objecthood_version: String,
    /// Path of the input, as it was given.
    pub input: String,
    /// Method that looked at the frame.
    #[schemars(length(min = 1))]
    pub method: String,
    /// SHA-256 of all parameters, in hexadecimal. Equal inputs with equal fingerprints and versions give equal outputs.
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub parameters_fingerprint: String,
    /// Size of the image.
    pub image: ImageSize,
    /// The camera that saw it.
    pub camera: PinholeCamera,
    /// Where the camera is in the frame of the points; absent unless it was chosen to fit an unorganized cloud.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "VirtualView")]
    pub virtual_view: Option<VirtualView>,
    /// The direction against gravity.
    pub up: UpDirection,
    /// Large planes of the scene: the table, the floor.
    pub structure_planes: Vec<StructurePlane>,
    /// The objects, in the order of their numbers in the label image.
    pub objects: Vec<SceneObject>,
    /// What stands on what.
    pub support: Support,
    /// The noise of the sensor that was estimated; absent when no tolerance follows it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "SensorNoise")]
    pub noise: Option<SensorNoise>,
    /// What the user should know about how this came about.
    pub notices: Vec<String>,
}

/// The noise of a depth sensor, relative to a Kinect v1 whose disparity has the steps that the parameters name.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorNoise {
    /// Standard deviation of single pixels.
    #[schemars(range(min = 0))]
    pub white: f64,
    /// Waves of 16 to 40 px, which do not average out in a window.
    #[schemars(range(min = 0))]
    pub waves: f64,
}

/// Size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ImageSize {
    /// Number of columns (px).
    #[schemars(range(min = 1))]
    pub width_px: usize,
    /// Number of rows (px).
    #[schemars(range(min = 1))]
    pub height_px: usize,
}

/// A pinhole camera: a point (x, y, z) is seen at u = `fx_px` x/z + `cx_px`, v = `fy_px` y/z + `cy_px`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PinholeCamera {
    /// Focal length along the columns (px).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub fx_px: f64,
    /// Focal length along the rows (px).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub fy_px: f64,
    /// Column of the principal point (px).
    pub cx_px: f64,
    /// Row of the principal point (px).
    pub cy_px: f64,
    /// Root mean square distance between points and their pixels (px) when the camera was fitted to the points;
    /// absent when it was given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 0))]
    pub fit_residual_px: Option<f64>,
}

/// A camera that was chosen to look at points without one: a point p of the camera frame is at rotation · p + position
/// in the frame of the file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VirtualView {
    /// Its position (m).
    pub position_m: [f64; 3],
    /// Its rotation as a unit quaternion.
    pub rotation_xyzw: [f64; 4],
    /// Points of the file.
    pub points: usize,
    /// Those that it sees: the others are missing, outside the image or hidden, and belong to no object.
    pub seen_points: usize,
}

/// The direction against gravity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UpDirection {
    /// Unit vector in the camera frame.
    pub direction: [f32; 3],
    /// Where it was taken from.
    pub source: UpSource,
}

/// Where the direction against gravity was taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum UpSource {
    /// The normal of the ground: the surface on which most things stand; in `paper` the dominant plane.
    Plane,
    /// Measured gravity.
    Measured,
    /// What earlier frames told, because this one shows no ground.
    Earlier,
    /// The camera's own up, by its tilt and roll: asked for, or there is no plane.
    Camera,
}

/// A plane: the points X with normal · X + `offset_m` = 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructurePlane {
    /// Unit normal in the camera frame, towards the side of the camera.
    pub normal: [f32; 3],
    /// Distance of the camera from the plane (m).
    pub offset_m: f32,
    /// Share of the frame's valid points that lie on it.
    #[schemars(range(min = 0, max = 1))]
    pub inlier_share: f32,
}

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
    /// The bottom of a plate or bowl, which lies as low as the table.
    VesselBottom {
        /// Share of its border that touches, without a step in depth.
        #[schemars(range(min = 0, max = 1))]
        contact_share: f64,
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

/// What stands on what: a directed graph without cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// The shapes; others refer to them by index, from 0.
    pub nodes: Vec<SupportNode>,
    /// Which carries which, sorted by (lower, upper).
    pub edges: Vec<SupportEdge>,
}

/// A shape in the support graph.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportNode {
    /// Number of the object that it is; absent when it is none: the table, or what too little speaks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u16", range(min = 1))]
    pub object: Option<u16>,
    /// Index of the structure plane that it is; absent when it is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize")]
    pub plane: Option<usize>,
    /// P(S): how well it can carry something.
    #[schemars(range(min = 0, max = 1))]
    pub p_s: f32,
    /// P(O): the probability that it is an object by what carries it.
    #[schemars(range(min = 0, max = 1))]
    pub p_o: f32,
    /// Mean height along up, relative to the camera (m).
    pub height_m: f32,
    /// Its pixels with depth (px).
    pub size_px: usize,
}

/// How one thing carries another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupportKind {
    /// The upper stands on the lower; in `paper` whatever is higher.
    On,
    /// The upper stands or lies in the lower, below its rim.
    In,
    /// The upper is tilted and held by the lower from the side; it stands on something else besides.
    Leans,
}

/// One node carries another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportEdge {
    /// Node of the carrier.
    pub lower: u32,
    /// Node of what it carries.
    pub upper: u32,
    /// How.
    pub kind: SupportKind,
    /// How sure it is that this carries it: of what stands, the share of the contacts of its foot; of what lies in
    /// something, the share of directions in which the rim is seen; of what leans, the share of its sides that are tilted
    /// alike; of a hidden contact, half of that, and of what stands half the share of the foot that something hides. 1 in `paper`.
    #[schemars(range(min = 0, max = 1))]
    pub confidence: f32,
    /// Whether the contact itself is not seen.
    pub hidden: bool,
    /// Pairs of neighbouring points in contact there.
    pub contacts: u32,
}

impl SceneFile {
    /// The scene file of a frame. `input` is its path as the user gave it.
    pub fn new(input: &str, capture: &Capture, params: &Params, discovery: &Discovery) -> Self {
        let (width_px, height_px) = capture.frame.size();
        let objecthood::Camera { fx_px, fy_px, cx_px, cy_px } = capture.frame.camera();
        let fit_residual_px = capture.camera_fit.map(|fit| fit.residual_px);
        Self {
            schema_version: SCHEMA_VERSION,
            objecthood_version: env!("CARGO_PKG_VERSION").to_owned(),
            input: input.to_owned(),
            method: params.method.to_string(),
            parameters_fingerprint: fingerprint(params),
            image: ImageSize { width_px, height_px },
            camera: PinholeCamera { fx_px, fy_px, cx_px, cy_px, fit_residual_px },
            virtual_view: virtual_list(capture).map(VirtualView::from),
            up: (&discovery.up).into(),
            structure_planes: discovery.structure_planes.iter().map(StructurePlane::from).collect(),
            objects: discovery.objects.iter().map(SceneObject::from).collect(),
            support: (&discovery.support).into(),
            noise: discovery.estimates.map(|e| SensorNoise { white: e.noise.white, waves: e.noise.waves() }),
            notices: notices(capture, discovery),
        }
    }

    /// The content of the file.
    ///
    /// # Errors
    /// [`Error::NotFinite`](crate::Error::NotFinite) names the place of a value that JSON cannot hold, [`Error::NoJson`](crate::Error::NoJson) tells of a kind of
    /// value that this version of the schema does not know. Neither happens to what [`objecthood::discover`] found.
    pub fn to_json(&self) -> Result<String> {
        json::pretty(self)
    }
}

/// What the user should know about a frame although it was done: of how it was read, and of how it was looked at.
pub fn notices(capture: &Capture, discovery: &Discovery) -> Vec<String> {
    let turned = "every point lies behind the camera: the cloud is read as x right, y up, z backward";
    let of_reading = capture.turned.then(|| turned.to_owned());
    let of_view = virtual_list(capture).map(|list| {
        let ((width, height), focal_px) = (capture.frame.size(), capture.frame.camera().fx_px);
        let (seen, points) = (list.seen, list.points_m.len());
        let whence = if list.viewpoint.is_some_and(|viewpoint| viewpoint.position_m == list.camera_pose.position_m) {
            "the VIEWPOINT of the file"
        } else {
            "their origin"
        };
        let percent = 100.0 * seen as f64 / points as f64;
        format!(
            "no camera is given: the points are looked at from {whence} by a virtual one of {width}x{height} px with a \
             focal length of {focal_px:.1} px, which sees {percent:.1} % of them"
        )
    });
    let of_looking =
        discovery.notices.iter().map(|notice| notice.to_string() + &unit_advice(notice, capture));
    of_reading.into_iter().chain(of_view).chain(of_looking).collect()
}

/// What a doubt about the unit means for how the frame was given; empty for other notices.
fn unit_advice(notice: &Notice, capture: &Capture) -> String {
    let (times, is_too_far) = match notice {
        Notice::Doubt(Doubt::TooFar { times, .. }) => (times, true),
        Notice::Doubt(Doubt::TooNear { times, .. }) => (times, false),
        _ => return String::new(),
    };
    match (capture.is_metric, is_too_far) {
        (true, true) => format!(", and points are in metres: divide their coordinates by {times}"),
        (true, false) => format!(", and points are in metres: multiply their coordinates by {times}"),
        (false, true) => format!(", so the depth scale, units in a metre, would be {times} times as large"),
        (false, false) => format!(", so the depth scale, units in a metre, would be 1/{times} of what it is"),
    }
}

/// The points, if their camera is virtual.
fn virtual_list(capture: &Capture) -> Option<&PointList> {
    capture.list.as_ref().filter(|list| list.is_virtual)
}

impl From<&PointList> for VirtualView {
    fn from(list: &PointList) -> Self {
        let Pose { position_m, rotation_xyzw } = list.camera_pose;
        Self { position_m, rotation_xyzw, points: list.points_m.len(), seen_points: list.seen }
    }
}

impl From<&discovery::Up> for UpDirection {
    fn from(up: &discovery::Up) -> Self {
        let source = match up.source {
            discovery::UpSource::Plane => UpSource::Plane,
            discovery::UpSource::Measured => UpSource::Measured,
            discovery::UpSource::Earlier => UpSource::Earlier,
            discovery::UpSource::Camera => UpSource::Camera,
        };
        Self { direction: up.direction, source }
    }
}

impl From<&discovery::StructurePlane> for StructurePlane {
    fn from(
        &discovery::StructurePlane { normal, offset_m, inlier_share }: &discovery::StructurePlane,
    ) -> Self {
        Self { normal, offset_m, inlier_share }
    }
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
            discovery::JoinEvidence::VesselBottom { contact_share } => Self::VesselBottom { contact_share },
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

impl From<&objecthood::discovery::SupportGraph> for Support {
    fn from(graph: &objecthood::discovery::SupportGraph) -> Self {
        let nodes = graph.nodes.iter().map(|node| SupportNode {
            object: match node.kind {
                NodeKind::Object { object } => Some(object.0),
                NodeKind::Structure { .. } | NodeKind::Surface => None,
            },
            plane: match node.kind {
                NodeKind::Structure { plane } => Some(plane),
                NodeKind::Object { .. } | NodeKind::Surface => None,
            },
            p_s: node.p_s,
            p_o: node.p_o,
            height_m: node.height_m,
            size_px: node.size_px,
        });
        let edges = graph.edges.iter().map(|edge| SupportEdge {
            lower: edge.lower.0,
            upper: edge.upper.0,
            kind: match edge.kind {
                discovery::SupportKind::On => SupportKind::On,
                discovery::SupportKind::In => SupportKind::In,
                discovery::SupportKind::Leans => SupportKind::Leans,
            },
            confidence: edge.confidence,
            hidden: edge.hidden,
            contacts: edge.contacts,
        });
        Self { nodes: nodes.collect(), edges: edges.collect() }
    }
}

/// SHA-256 of all parameters as canonical JSON (keys sorted, no spaces), in hexadecimal.
pub fn fingerprint(params: &Params) -> String {
    let value = serde_json::to_value(params).expect("parameters are numbers, switches and words");
    let mut text = String::new();
    write_canonical(&value, &mut text);
    crate::sha256(text.as_bytes())
}

/// Writes JSON with sorted keys, whatever order the map has in this build of `serde_json`.
fn write_canonical(value: &Value, text: &mut String) {
    let Value::Object(map) = value else {
        return *text += &value.to_string();
    };
    let mut entries: Vec<(&String, &Value)> = map.iter().collect();
    entries.sort_by_key(|(key, _)| *key);
    for (k, (key, value)) in entries.into_iter().enumerate() {
        *text += if k == 0 { "{" } else { "," };
        *text += &Value::from(key.as_str()).to_string();
        *text += ":";
        write_canonical(value, text);
    }
    *text += if map.is_empty() { "{}" } else { "}" };
}

/// The JSON Schema (2020-12) of scene files.
pub fn schema() -> String {
    let generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let schema = generator.into_root_schema_for::<SceneFile>();
    serde_json::to_string_pretty(&schema).expect("a schema is JSON") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_json_does_not_depend_on_order() {
        let text = |json: &str| {
            let mut text = String::new();
            write_canonical(&serde_json::from_str(json).unwrap(), &mut text);
            text
        };
        assert_eq!(
            text(r#"{"b": {"z": 1, "y": [1.5, "a\n"]}, "a": {}}"#),
            r#"{"a":{},"b":{"y":[1.5,"a\n"],"z":1}}"#
        );
    }

    #[test]
    fn the_fingerprint_tells_parameters_apart() {
        let default = fingerprint(&Params::default());
        assert_eq!(default.len(), 64);
        assert_eq!(default, fingerprint(&Params::default()));
        let mut other = Params::default();
        other.curvature.threshold += 0.01;
        assert_ne!(default, fingerprint(&other));
    }
}
