//! A frame with what its file says of it.

use std::ffi::OsString;

use glam::{DQuat, DVec3};
use objecthood::{Frame, Raster};

use crate::images::Resized;
use crate::organize::{CameraFit, GridCamera, PointList};

/// A frame, and what else its file says.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Capture {
    /// What the frame is called; unique within its source. Of frames in files of their own it is the name of the file
    /// without its ending. Empty for a frame that was decoded from memory.
    pub name: OsString,
    /// Depth, colour and camera.
    pub frame: Frame,
    /// When the depth was measured: nanoseconds by the clock of the source, most often since 1970.
    pub stamp_ns: Option<i64>,
    /// Where the camera was.
    pub pose: Option<Pose>,
    /// What the source itself says of camera and units, whether it was used or overridden.
    pub said: Said,
    /// Truth label of every pixel as the file has it, of the size of the frame; 0 where there is no depth.
    pub truth: Option<Raster<u32>>,
    /// How well the camera fits the points; `None` unless it was fitted to them.
    pub camera_fit: Option<CameraFit>,
    /// How the colour image came to the size of the depth; `None` if it had it.
    pub resized: Option<Resized>,
    /// What became of each point of an unorganized cloud.
    pub list: Option<PointList>,
    /// Whether it was made of points, which are in metres: no depth scale acts on it.
    pub is_metric: bool,
    /// Whether the points had the axes of computer graphics (x right, y up, z backward) and were turned by half about x.
    pub turned: bool,
}

impl Capture {
    /// A frame of which nothing else is known.
    pub fn new(frame: Frame) -> Self {
        Self {
            name: OsString::new(),
            frame,
            stamp_ns: None,
            pose: None,
            said: Said::default(),
            truth: None,
            camera_fit: None,
            resized: None,
            list: None,
            is_metric: false,
            turned: false,
        }
    }

    /// When the depth was measured (s). A frame without a stamp follows the one at `last_s` at the rate `rate_hz`; without such a frame it is
    /// the `number`th of the source, from 0.
    pub fn stamp_s(&self, number: usize, last_s: Option<f64>, rate_hz: f64) -> f64 {
        let counted_s = || last_s.map_or(number as f64 / rate_hz, |last_s| last_s + 1.0 / rate_hz);
        self.stamp_ns.map_or_else(counted_s, |stamp_ns| stamp_ns as f64 * 1e-9)
    }
}

impl Capture {
    /// A direction of the frame of the file's points, in the camera frame. They are the same, unless the points were turned by half about x, or
    /// are a list that a virtual camera looks at.
    pub fn to_camera_direction(&self, direction: [f32; 3]) -> [f32; 3] {
        let [x, y, z] = direction;
        match (&self.list, self.pose) {
            (Some(_), Some(pose)) => {
                (pose.rotation().inverse() * DVec3::from(direction.map(f64::from))).as_vec3().to_array()
            }
            _ if self.turned => [x, -y, -z],
            _ => direction,
        }
    }
}

/// What a source says of its camera and units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Said {
    /// The camera.
    pub camera: Option<GridCamera>,
    /// Units of the stored depth that make a metre.
    pub depth_scale: Option<f64>,
    /// How far, at most, the lens bends a pixel of the image from where a pinhole would see it (px); `None` if the source tells no
    /// distortion.
    pub distortion_px: Option<f64>,
}

/// Where a camera is in the world of its source: a point p of the camera frame (x right, y down, z forward) is at
/// rotation · p + position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position (m).
    pub position_m: [f64; 3],
    /// Rotation as a unit quaternion.
    pub rotation_xyzw: [f64; 4],
}

impl Pose {
    /// The world is the frame of the camera.
    pub const ORIGIN: Self = Self { position_m: [0.0; 3], rotation_xyzw: [0.0, 0.0, 0.0, 1.0] };

    /// The rotation from the camera frame to the world.
    pub(crate) fn rotation(&self) -> DQuat {
        DQuat::from_array(self.rotation_xyzw)
    }

    /// A point of the world (m) in the camera frame.
    pub(crate) fn to_camera(self, point_m: [f32; 3]) -> [f32; 3] {
        if self == Self::ORIGIN {
            return point_m;
        }
        let point = DVec3::from(point_m.map(f64::from)) - DVec3::from(self.position_m);
        (self.rotation().inverse() * point).as_vec3().to_array()
    }

    /// The z axis of the world in the camera frame: up, where the world's z points up, as in the TUM benchmark.
    pub fn up(&self) -> [f32; 3] {
        (self.rotation().inverse() * DVec3::Z).as_vec3().to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_the_worlds_z_axis_in_the_camera_frame() {
        let up = |rotation_xyzw| Pose { position_m: [0.0; 3], rotation_xyzw }.up();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!(up([0.0, 0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        // Turned by -90 degrees about x: forward along the world's y axis, upright.
        let upright = up([-half, 0.0, 0.0, half]);
        assert!((upright[1] + 1.0).abs() < 1e-6 && upright[0].abs() + upright[2].abs() < 1e-6, "{upright:?}");
    }
}
