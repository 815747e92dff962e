//! The camera and the truth of a scene as JSON.

use serde::Serialize;

use super::DEPTH_SCALE;
use crate::contact::Contact;
use crate::error::{Error, Result};
use crate::family::Family;
use crate::holes::Holes;
use crate::pose::Pose;
use crate::render::Rendered;
use crate::sensor::Sensor;
use crate::solid::Role;
use crate::world::World;

#[derive(Serialize)]
struct CameraFile {
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    width: usize,
    height: usize,
    depth_scale: f64,
}

/// `camera.json` of the colour and depth images: fx, fy, cx, cy (px), width, height, `depth_scale` (units per metre).
///
/// # Errors
/// [`Error::Json`] never in practice.
pub fn camera_json(world: &World) -> Result<String> {
    let viewpoint = world.viewpoint();
    let camera = viewpoint.camera;
    let (width, height) = viewpoint.size_px;
    to_json(&CameraFile {
        fx: camera.fx_px,
        fy: camera.fy_px,
        cx: camera.cx_px,
        cy: camera.cy_px,
        width,
        height,
        depth_scale: DEPTH_SCALE,
    })
}

#[derive(Serialize)]
struct SceneTruth<'a> {
    schema_version: u32,
    family: Family,
    seed: u64,
    sensor: Sensor,
    #[serde(skip_serializing_if = "Holes::is_none")]
    holes: Holes,
    /// Takes the camera frame to the world.
    camera_pose: PoseFile,
    solids: Vec<SolidFile>,
    contacts: &'a [Contact],
}

#[derive(Serialize)]
struct SolidFile {
    instance: u16,
    kind: &'static str,
    role: Role,
    /// Takes its own frame to the world.
    pose: PoseFile,
    /// Lowest and highest coordinates in its own frame.
    bounds_m: [[f64; 3]; 2],
    /// First and last number of its faces in the surface truth.
    surfaces: [usize; 2],
    /// Label in the mOSD-style point cloud; 1 when it is no object.
    mosd_label: u32,
    /// Pixels with depth measured on it.
    size_px: usize,
    visible_fraction: f64,
}

#[derive(Serialize)]
pub(super) struct PoseFile {
    origin_m: [f64; 3],
    rotation_xyzw: [f64; 4],
}

impl PoseFile {
    pub(super) fn new(pose: &Pose) -> Self {
        Self { origin_m: pose.origin_m(), rotation_xyzw: pose.rotation_xyzw() }
    }
}

/// The truth of a scene. World frame: z up, metres.
///
/// * `family`, `seed`, `sensor`, and `holes` if there are any: what it was made from; `camera_pose` takes the camera frame to the world.
/// * `solids`, each with `instance` (its value in the truth image), `kind`, `role`, `pose` and `bounds_m` of its own frame,
///   `surfaces` (first and last of its values in the image of surfaces), `mosd_label` (in the point cloud; 1 = no object),
///   `size_px` (pixels with depth) and `visible_fraction`.
/// * `contacts`, each with the instances `upper` and `lower`, `kind`, `point_m` and `normal`: those of [`World::contacts`].
///
/// # Errors
/// [`Error::Json`] never in practice.
pub fn scene_json(family: Family, sensor: Sensor, world: &World, rendered: &Rendered) -> Result<String> {
    let mut size_px = vec![0; world.solids().len() + 1];
    rendered.truth.instance.as_slice().iter().for_each(|&k| size_px[usize::from(k)] += 1);
    let mut next_surface = 1;
    let mut next_label = 20;
    let mut solids = Vec::new();
    for (k, solid) in world.solids().iter().enumerate() {
        let surfaces = [next_surface, next_surface + solid.surfaces() - 1];
        next_surface = surfaces[1] + 1;
        let mosd_label = if solid.role() == Role::Object { next_label } else { 1 };
        next_label += if solid.role() == Role::Object { 10 } else { 0 };
        solids.push(SolidFile {
            instance: k as u16 + 1,
            kind: solid.kind(),
            role: solid.role(),
            pose: PoseFile::new(solid.pose()),
            bounds_m: solid.bounds_m(),
            surfaces,
            mosd_label,
            size_px: size_px[k + 1],
            visible_fraction: rendered.visible_fraction[k],
        });
    }
    to_json(&SceneTruth {
        schema_version: 1,
        family,
        seed: world.seed(),
        sensor,
        holes: rendered.holes,
        camera_pose: PoseFile::new(&world.viewpoint().pose),
        solids,
        contacts: world.contacts(),
    })
}

pub(super) fn to_json<T: Serialize>(value: &T) -> Result<String> {
    let mut json = serde_json::to_string_pretty(value).map_err(|reason| Error::Json { reason })?;
    json.push('\n');
    Ok(json)
}
