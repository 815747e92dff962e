//! One image of a depth camera. The conventions of units and missing values are defined here.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::estimates::Estimates;
use crate::raster::Raster;
use crate::simd::vectorized;

/// Coordinates beyond this (m) count as missing, so that sums of their squares stay finite in 32 bits.
const FARTHEST_M: f64 = 1e15;

/// One registered RGB-D image.
///
/// * depth: metres along the optical axis (z, not range); `NaN` where there is none. Depths that are not positive, or that put a
///   coordinate of the point beyond 1e15 m, count as missing and are stored as `NaN`.
/// * colour: sRGB, 8 bits a channel, registered to the depth pixel by pixel; a frame may have none.
/// * points are not stored: [`Frame::points_m`] computes them from depth and camera.
///
/// A frame never changes, and a clone shares its images.
#[derive(Clone, Debug)]
pub struct Frame {
    depth_m: Arc<Raster<f32>>,
    color: Option<Arc<Raster<[u8; 3]>>>,
    camera: Camera,
    /// Pixels with depth.
    measured_px: usize,
    /// The measured direction against gravity: a unit vector in the camera frame.
    up: Option<[f32; 3]>,
    /// Estimates from earlier frames.
    estimates: Option<Estimates>,
}

impl Frame {
    /// Joins depth (m), colour and camera to a frame.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`] when colour and depth differ in size, [`Error::BadCamera`] as [`Camera::check`],
    /// [`Error::NoValidDepth`] when no pixel has depth.
    pub fn new(mut depth_m: Raster<f32>, color: Option<Raster<[u8; 3]>>, camera: Camera) -> Result<Self> {
        if let Some(color) = &color
            && color.size() != depth_m.size()
        {
            return Err(Error::SizeMismatch { color: color.size(), depth: depth_m.size() });
        }
        let camera = camera.check()?;
        // The rays through the corners are the most oblique.
        let (right, bottom) = (depth_m.width() as f64, depth_m.height() as f64);
        let corners = [camera.ray(0.0, 0.0), camera.ray(right, bottom)];
        let lean = corners.as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let farthest_m = (FARTHEST_M / lean) as f32;
        let mut measured_px = 0;
        for z in depth_m.as_mut_slice() {
            if *z > 0.0 && *z < farthest_m {
                measured_px += 1;
            } else {
                *z = f32::NAN;
            }
        }
        if measured_px > 0 {
            let (depth_m, color) = (Arc::new(depth_m), color.map(Arc::new));
            Ok(Self { depth_m, color, camera, measured_px, up: None, estimates: None })
        } else {
            Err(Error::NoValidDepth { size: depth_m.size() })
        }
    }

    /// The same frame with a measured direction against gravity, from an accelerometer at rest or from the
    /// camera's pose. It is a vector of any length in the camera frame (x right, y down, z forward).
    ///
    /// It decides what up is, and only surfaces that face it can be the ground. The tilt and roll of the
    /// parameters then have no effect.
    ///
    /// # Errors
    /// [`Error::BadUp`] when it has no length, or is not finite.
    pub fn with_up(self, up: [f32; 3]) -> Result<Self> {
        let unit = Vec3::from(up).as_dvec3().try_normalize().ok_or(Error::BadUp { up })?;
        Ok(Self { up: Some(unit.as_vec3().to_array()), ..self })
    }

    /// The measured direction against gravity, if there is one: a unit vector in the camera frame.
    pub fn up(&self) -> Option<[f32; 3]> {
        self.up
    }

    /// The same frame with other depth (m), as [`Frame::new`] takes it.
    ///
    /// # Errors
    /// As [`Frame::new`].
    pub fn with_depth_m(&self, depth_m: Raster<f32>) -> Result<Self> {
        let other = Self::new(depth_m, self.color().cloned(), self.camera)?;
        Ok(Self { up: self.up, estimates: self.estimates, ..other })
    }

    /// The same frame with other depths (m) at the pixels that have depth.
    pub(crate) fn with_restored_depth(&self, depth_m: Raster<f32>) -> Self {
        Self { depth_m: Arc::new(depth_m), ..self.clone() }
    }

    /// The same frame with estimates from earlier frames. The noise of the sensor is then a mean over all of
    /// them. If this frame does not clearly show which surface is its ground, their direction up decides
    /// (`context`).
    ///
    /// Without this call the result depends on the frame alone.
    ///
    /// ```
    /// # use objecthood::{Camera, Frame, Params, Pipeline, Raster};
    /// # let camera = Camera::new(52.5, 52.5, 31.5, 23.5)?;
    /// # let stream = vec![Frame::new(Raster::filled(64, 48, 1.2)?, None, camera)?; 2];
    /// let (mut pipeline, params) = (Pipeline::default(), Params::default());
    /// let mut estimates = None;
    /// for frame in stream {
    ///     let found = pipeline.discover(&frame.with_estimates(estimates), &params)?;
    ///     estimates = found.estimates;
    /// }
    /// # Ok::<(), objecthood::Error>(())
    /// ```
    pub fn with_estimates(self, estimates: impl Into<Option<Estimates>>) -> Self {
        Self { estimates: estimates.into(), ..self }
    }

    /// The estimates from earlier frames, if they were handed on.
    pub fn estimates(&self) -> Option<&Estimates> {
        self.estimates.as_ref()
    }

    /// Depth in metres, `NaN` = none.
    pub fn depth_m(&self) -> &Raster<f32> {
        &self.depth_m
    }

    /// Colour, if the frame has any.
    pub fn color(&self) -> Option<&Raster<[u8; 3]>> {
        self.color.as_deref()
    }

    /// The camera that took the image.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        self.depth_m.size()
    }

    /// Number of pixels with depth; never zero.
    pub fn measured_px(&self) -> usize {
        self.measured_px
    }

    /// Whether both frames share their images in memory, as clones do, and are equal in everything else.
    pub(crate) fn is_clone_of(&self, other: &Self) -> bool {
        let shares_color = match (&self.color, &other.color) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.depth_m, &other.depth_m)
            && shares_color
            && (self.camera, self.up, self.estimates) == (other.camera, other.up, other.estimates)
    }

    /// Whether the pixel with index `i` has depth.
    #[inline]
    pub fn is_valid(&self, i: usize) -> bool {
        !self.depth_m[i].is_nan()
    }

    /// The point of every pixel in the camera frame (m); all `NaN` where there is no depth.
    pub fn points_m(&self) -> Raster<[f32; 3]> {
        let (width, _) = self.size();
        let mut points = Buffer::stale(self.depth_m.len(), [f32::NAN; 3]);
        let columns: Vec<f64> = (0..width).map(|u| self.camera.ray(u as f64, 0.0)[0]).collect();
        points.par_chunks_mut(width).zip(self.depth_m.as_slice().par_chunks(width)).enumerate().for_each(
            |(v, (points, depths))| {
                let y = self.camera.ray(0.0, v as f64)[1];
                vectorized(
                    #[inline(always)]
                    || {
                        for ((point, x), &z_m) in points.iter_mut().zip(&columns).zip(depths) {
                            let z = f64::from(z_m);
                            *point = [(x * z) as f32, (y * z) as f32, z_m];
                        }
                    },
                );
            },
        );
        self.depth_m.with_data(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::new(1.0, 1.0, 0.0, 0.0).unwrap()
    }

    #[test]
    fn every_kind_of_missing_depth_becomes_nan() {
        let depth = Raster::from_vec(6, 1, vec![1.0, 0.0, -1.0, f32::INFINITY, f32::NAN, 3e38]).unwrap();
        let frame = Frame::new(depth, None, camera()).unwrap();
        assert_eq!((0..6).filter(|&i| frame.is_valid(i)).collect::<Vec<_>>(), [0]);
        assert_eq!(frame.measured_px(), 1);
        assert!(frame.points_m()[1][0].is_nan());
    }

    #[test]
    fn points_are_the_depths_projected_back() {
        let camera = Camera::new(525.0, 520.0, 15.5, 7.25).unwrap();
        let depth = (0..37 * 19).map(|k| if k % 5 == 0 { f32::NAN } else { 0.4 + 0.01 * k as f32 });
        let depth = Raster::from_vec(37, 19, depth.collect()).unwrap();
        let points = Frame::new(depth.clone(), None, camera).unwrap().points_m();
        for i in 0..depth.len() {
            let expected = camera.back_project(i % 37, i / 37, depth[i]);
            assert_eq!(points[i].map(f32::to_bits), expected.map(f32::to_bits), "pixel {i}");
        }
    }

    #[test]
    fn a_frame_without_depth_or_with_other_colour_is_refused() {
        let nan = Raster::filled(2, 2, f32::NAN).unwrap();
        assert!(matches!(Frame::new(nan, None, camera()), Err(Error::NoValidDepth { .. })));
        let depth = Raster::filled(2, 2, 1.0).unwrap();
        let color = Raster::filled(2, 3, [0; 3]).unwrap();
        assert!(matches!(Frame::new(depth.clone(), Some(color), camera()), Err(Error::SizeMismatch { .. })));
        let frame = Frame::new(depth.clone(), None, camera()).unwrap();
        for up in [[0.0; 3], [f32::NAN, 1.0, 0.0]] {
            assert!(matches!(frame.clone().with_up(up), Err(Error::BadUp { .. })), "{up:?}");
        }
        let up = frame.with_up([0.0, -9.81, 0.0]).unwrap();
        assert_eq!(up.with_depth_m(depth.map(|z| 2.0 * z)).unwrap().up(), Some([0.0, -1.0, 0.0]));
        let unchecked = Camera { fx_px: 0.0, ..camera() };
        assert!(matches!(Frame::new(depth, None, unchecked), Err(Error::BadCamera { .. })));
    }
}
