//! A surface of the structure (docs/CONTEXT.md 1.1.1).

use glam::DVec3;

use crate::surface::disparity::DisparitySpace;
use crate::surface::model::Model;

/// Height (m) given to a pixel whose ray meets no surface below it: it lies beyond the horizon of the surface.
pub(super) const BEYOND_M: f64 = 10.0;

/// A large surface: almost a plane.
#[derive(Clone, Debug)]
pub struct StructureSurface {
    /// Its disparity, a quadratic, because the sensor's distortion bends a table by more than the noise.
    pub model: Model,
    /// Unit normal, towards the camera, of the plane from which the fit started.
    pub(crate) normal: DVec3,
    /// Distance of the camera from that plane (m).
    pub offset_m: f64,
    /// Factor on the tolerances of `structure`: how far its pixels scatter, relative to a Kinect's table.
    pub scale: f64,
}

impl StructureSurface {
    /// Unit normal of the plane it started from, towards the camera.
    pub fn normal(&self) -> [f64; 3] {
        self.normal.to_array()
    }

    /// Height (m) of a point above the plane it started from, along its normal.
    pub(super) fn above_m(&self, point_m: DVec3) -> f64 {
        self.normal.dot(point_m) + self.offset_m
    }

    /// Height (m) of a pixel with this disparity (quanta) above the surface, along its normal.
    pub fn height_m(&self, at: [f64; 2], disparity: f64, space: &DisparitySpace) -> f64 {
        let below = self.model.value(at);
        if below < 1.0 {
            return BEYOND_M;
        }
        let ray = DVec3::from(space.camera().ray(at[0], at[1]));
        (space.depth_m(below) - space.depth_m(disparity)) * self.normal.dot(ray).abs()
    }
}
