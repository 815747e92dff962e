//! A frame with what its file says of it.

use std::ffi::OsString;

use objecthood::{Frame, Raster};

use crate::organize::{CameraFit, GridCamera};

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
            turned: false,
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
