//! Disparity space: where the sensor's noise is constant and planes are affine (METHOD 0).
//!
//! A pixel (u, v) with inverse depth d = 1/(z Q), counted in *quanta* Q of the sensor. One tolerance in quanta serves near
//! and far alike, and a plane in space is exactly d = value + slope · (u, v).

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::params;
use crate::raster::Raster;

/// Depths (m) outside this range are no measurements for the method `context`.
const RANGE_M: std::ops::Range<f32> = 0.1..20.0;

/// The focal length (px) at which parameters in pixels hold; they scale with it.
const REFERENCE_FOCAL_PX: f64 = 525.0;

/// The camera and the sensor's noise: what takes pixels and disparities to space and back.
#[derive(Clone, Copy, Debug)]
pub struct DisparitySpace {
    camera: Camera,
    quantum_per_m: f64,
    lateral_noise_px: f64,
    scale: f64,
}

impl DisparitySpace {
    /// The space of a camera and a sensor.
    pub fn new(camera: Camera, sensor: &params::Sensor) -> Self {
        let scale = (camera.fx_px * camera.fy_px).sqrt() / REFERENCE_FOCAL_PX;
        Self {
            camera,
            quantum_per_m: sensor.disparity_quantum_per_m,
            lateral_noise_px: sensor.lateral_noise_px * scale,
            scale,
        }
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// The disparity of every pixel (quanta); `NaN` without depth, or with one outside 0.1 to 20 m.
    pub fn disparity(&self, depth_m: &Raster<f32>) -> Raster<f32> {
        let disparity = |z: &f32| {
            let is_measured = *z > RANGE_M.start && *z < RANGE_M.end;
            if is_measured { (1.0 / (f64::from(*z) * self.quantum_per_m)) as f32 } else { f32::NAN }
        };
        depth_m.with_data(depth_m.as_slice().par_iter().map(disparity).collect())
    }

    /// Depth (m) of a disparity (quanta).
    #[inline]
    pub fn depth_m(&self, disparity: f64) -> f64 {
        1.0 / (disparity * self.quantum_per_m)
    }

    /// The point (m) at pixel (u, v) with this disparity (quanta).
    #[inline]
    pub fn point_m(&self, [u, v]: [f64; 2], disparity: f64) -> DVec3 {
        DVec3::from(self.camera.ray(u, v)) * self.depth_m(disparity)
    }

    /// Unit normal, towards the camera, of the plane with this value (quanta) and slope (quanta/px) at pixel (u, v).
    #[inline]
    pub fn normal(&self, at: [f64; 2], value: f64, slope: [f64; 2]) -> DVec3 {
        -self.across(at, value, slope).normalize()
    }

    /// Distance (m) of the camera from that plane.
    pub fn distance_m(&self, at: [f64; 2], value: f64, slope: [f64; 2]) -> f64 {
        1.0 / (self.quantum_per_m * self.across(at, value, slope).length())
    }

    /// The vector g with g · X = 1/Q for every point X of that plane.
    #[inline]
    fn across(&self, [u, v]: [f64; 2], value: f64, [a, b]: [f64; 2]) -> DVec3 {
        let Camera { fx_px, fy_px, cx_px, cy_px } = self.camera;
        let at_principal_point = value + a * (cx_px - u) + b * (cy_px - v);
        DVec3::new(a * fx_px, b * fy_px, at_principal_point)
    }

    /// Depth (m) that a step of this many quanta spans at depth `z_m`.
    #[inline]
    pub fn step_m(&self, quanta: f64, z_m: f64) -> f64 {
        quanta * self.quantum_per_m * z_m * z_m
    }

    /// How often larger the noise of a surface is than that of one seen face-on: noise also moves points sideways, and
    /// on a slope (quanta/px) that looks like noise of disparity.
    #[inline]
    pub fn slope_noise(&self, slope: f64) -> f64 {
        let sideways = self.lateral_noise_px * slope;
        (1.0 + sideways * sideways).sqrt()
    }

    /// Sideways noise of a point (px of this image).
    #[inline]
    pub fn lateral_noise_px(&self) -> f64 {
        self.lateral_noise_px
    }

    /// A length in pixels at a focal length of 525 px, in whole pixels of this image; at least 1.
    #[inline]
    pub fn length_px(&self, at_525_px: usize) -> usize {
        ((at_525_px as f64 * self.scale).round() as usize).max(1)
    }

    /// A slope in quanta/px at a focal length of 525 px, in quanta/px of this image.
    #[inline]
    pub fn slope_per_px(&self, at_525_px: f64) -> f64 {
        at_525_px / self.scale
    }

    /// An area in pixels at a focal length of 525 px, in pixels of this image.
    #[inline]
    pub fn area_px(&self, at_525_px: usize) -> usize {
        (at_525_px as f64 * self.scale * self.scale).round() as usize
    }
}

/// Column and row of the pixel with row-major index `i`.
#[inline]
pub(crate) fn position(i: usize, width: usize) -> [f64; 2] {
    [(i % width) as f64, (i / width) as f64]
}
