//! What is known about the direction up before a frame is processed (docs/CONTEXT.md 1.1.4
//! to 1.1.7).

use glam::{DVec3, Vec3};

use crate::frame::Frame;
use crate::params;

/// What is known about the direction up before a frame is processed.
#[derive(Clone, Copy, Debug)]
pub struct Attitude {
    /// The camera's own up: a unit vector in the camera frame.
    pub(crate) up: DVec3,
    /// What it is worth.
    pub(crate) knowledge: Knowledge,
    /// The direction up that earlier frames told.
    pub(crate) earlier_up: Option<DVec3>,
}

/// How well the camera's own up is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Knowledge {
    /// Not at all: the camera is taken to be held horizontally, but may be turned by quarters about its optical axis.
    Assumed,
    /// The user gave tilt or roll, roughly.
    Given,
    /// It was measured.
    Measured,
}

impl Attitude {
    /// What a frame and the parameters say.
    pub fn of(frame: &Frame, gravity: &params::Gravity) -> Self {
        if let Some(up) = frame.up() {
            let up = Vec3::from(up).as_dvec3();
            return Self { up, knowledge: Knowledge::Measured, earlier_up: None };
        }
        let earlier = frame.estimates().and_then(|estimates| estimates.up);
        let is_given = gravity.is_attitude_given();
        Self {
            up: Vec3::from(gravity.camera_up()).as_dvec3(),
            knowledge: if is_given { Knowledge::Given } else { Knowledge::Assumed },
            earlier_up: earlier.map(|up| Vec3::from(up).as_dvec3()),
        }
    }
}
