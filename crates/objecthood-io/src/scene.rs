//! The scene file: what was found in a frame, as JSON.
//!
//! These types are the contract with whoever reads the files; they follow [`Discovery`] but change only with
//! [`SCHEMA_VERSION`]. Their schema, made from the texts below, is published as `docs/scene.schema.json`.

mod fingerprint;
mod object;
mod support;
mod view;

use objecthood::discovery::{Doubt, Notice};
use objecthood::{Discovery, Params};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::{Deserialize, Serialize};

pub use fingerprint::fingerprint;
pub use object::{Join, JoinEvidence, JoinedPart, ObjectnessParts, OrientedBox, PixelBox, SceneObject};
pub use support::{Support, SupportEdge, SupportKind, SupportNode};
pub use view::{ImageSize, PinholeCamera, SensorNoise, StructurePlane, UpDirection, UpSource, VirtualView};

use crate::capture::Capture;
use crate::error::Result;
use crate::images::Resized;
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
    let of_colors = capture.resized.map(|Resized { from, with_camera }| {
        let (width, height) = capture.frame.size();
        let and_camera =
            if with_camera { "; the camera is that of the colour and was scaled likewise" } else { "" };
        format!(
            "colour of {}x{} px was brought to the {width}x{height} px of the depth{and_camera}",
            from.0, from.1
        )
    });
    let of_looking =
        discovery.notices.iter().map(|notice| notice.to_string() + &unit_advice(notice, capture));
    of_reading.into_iter().chain(of_view).chain(of_colors).chain(of_looking).collect()
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

/// The JSON Schema (2020-12) of scene files.
pub fn schema() -> String {
    let generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let schema = generator.into_root_schema_for::<SceneFile>();
    serde_json::to_string_pretty(&schema).expect("a schema is JSON") + "\n"
}
