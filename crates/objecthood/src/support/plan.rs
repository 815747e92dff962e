//! The plan view: the scene seen from straight above, and heights along up.

use glam::{DVec2, DVec3, Vec3};

use crate::discovery::up::Up;
use crate::tangents::tangents;

/// Number of directions in which the outline of a region is measured in the plan view.
pub(crate) const DIRECTIONS: usize = 16;
/// Least sine of the angle (6 degrees) between the line of sight and gravity, or between the line of sight and a face: below it,
/// directions are noise.
pub(crate) const FORESHORTENED: f64 = 0.1;

/// Sine of 22.5 degrees, half the angle between neighbours of a pixel.
const OFF_AXIS: f64 = 0.38;

/// Converts points to heights and to places in the plan view.
pub(crate) struct Plan {
    /// The direction against gravity.
    pub(crate) up: DVec3,
    /// The axes of the plan view.
    pub(crate) across: [DVec3; 2],
    /// The unit vectors along which the outline of a region is measured.
    pub(crate) directions: [DVec2; DIRECTIONS],
}

impl Plan {
    pub(crate) fn new(up: &Up) -> Self {
        let up = Vec3::from(up.direction).as_dvec3();
        let directions = std::array::from_fn(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
            DVec2::new(cos, sin)
        });
        Self { up, across: tangents(up), directions }
    }

    /// Height along up, relative to the camera (m).
    #[inline(always)]
    pub(crate) fn height_m(&self, point_m: [f32; 3]) -> f64 {
        self.up.dot(Vec3::from(point_m).as_dvec3())
    }

    /// The component of a normal along up.
    #[inline(always)]
    pub(crate) fn upward(&self, normal: [f32; 3]) -> f64 {
        self.height_m(normal)
    }

    /// Place in the plan view (m).
    pub(crate) fn place_m(&self, point_m: [f32; 3]) -> DVec2 {
        let point = Vec3::from(point_m).as_dvec3();
        DVec2::new(self.across[0].dot(point), self.across[1].dot(point))
    }

    /// The step to one of the eight neighbouring pixels that is nearest to the direction of gravity at a point; pixels count as square.
    /// `None` where the line of sight is within about 6 degrees of gravity.
    pub(crate) fn step_down(&self, point_m: [f32; 3]) -> Option<[i64; 2]> {
        let [x, y, z] = point_m.map(f64::from);
        let down = DVec2::new(-self.up.x + x / z * self.up.z, -self.up.y + y / z * self.up.z);
        let down = (down.length() > FORESHORTENED).then(|| down.normalize())?;
        Some(down.to_array().map(|along| if along.abs() > OFF_AXIS { along.signum() as i64 } else { 0 }))
    }
}
