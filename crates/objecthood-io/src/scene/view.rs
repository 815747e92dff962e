//! How the scene was seen: the camera, up, the large planes, the sensor.

use objecthood::discovery;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::capture::Pose;
use crate::organize::PointList;

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
