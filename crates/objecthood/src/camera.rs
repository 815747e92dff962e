//! The pinhole camera.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Intrinsics of a pinhole camera without distortion, in pixels.
///
/// Camera frame: x right, y down, z forward along the optical axis, in metres (REP 103, optical frame).
/// A point (x, y, z) is seen at u = fx·x/z + cx, v = fy·y/z + cy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Focal length along the columns (px).
    pub fx_px: f64,
    /// Focal length along the rows (px).
    pub fy_px: f64,
    /// Column of the principal point (px).
    pub cx_px: f64,
    /// Row of the principal point (px).
    pub cy_px: f64,
}

impl Camera {
    /// A camera with these intrinsics.
    ///
    /// # Errors
    /// As [`Camera::check`].
    pub fn new(fx_px: f64, fy_px: f64, cx_px: f64, cy_px: f64) -> Result<Self> {
        Self { fx_px, fy_px, cx_px, cy_px }.check()
    }

    /// The camera itself, if its intrinsics are valid.
    ///
    /// # Errors
    /// [`Error::BadCamera`] when a focal length is not between 1e-3 and 1e7 px or the principal point lies farther
    /// than 1e7 px from the origin: beyond these limits, points might not be finite.
    pub fn check(self) -> Result<Self> {
        let focal = [self.fx_px, self.fy_px].iter().all(|f| (1e-3..=1e7).contains(f));
        let principal = [self.cx_px, self.cy_px].iter().all(|c| (-1e7..=1e7).contains(c));
        if focal && principal {
            Ok(self)
        } else {
            Err(Error::BadCamera { camera: [self.fx_px, self.fy_px, self.cx_px, self.cy_px] })
        }
    }

    /// The ray through pixel (u, v), scaled so that its z is 1.
    #[inline]
    pub fn ray(&self, u: f64, v: f64) -> [f64; 3] {
        [(u - self.cx_px) / self.fx_px, (v - self.cy_px) / self.fy_px, 1.0]
    }

    /// The point (m) seen at pixel (u, v) at depth `z_m`.
    #[inline]
    pub fn back_project(&self, u: usize, v: usize, z_m: f32) -> [f32; 3] {
        let [x, y, _] = self.ray(u as f64, v as f64);
        let z = f64::from(z_m);
        [(x * z) as f32, (y * z) as f32, z_m]
    }

    /// The image position (u, v) of point `p` (m), in px. Not finite for a point in the plane z = 0 of the camera.
    #[inline]
    pub fn project(&self, p: [f32; 3]) -> (f64, f64) {
        let p = Vec3::from(p).as_dvec3();
        (self.fx_px * p.x / p.z + self.cx_px, self.fy_px * p.y / p.z + self.cy_px)
    }

    /// The row-major index of the pixel that shows a point (m) in an image of this size; `None` outside the image or behind the camera.
    pub(crate) fn pixel_at(&self, point: DVec3, (width, height): (usize, usize)) -> Option<usize> {
        let (u, v) = self.project(point.as_vec3().to_array());
        let is_inside = (0.0..width as f64 - 0.5).contains(&u) && (0.0..height as f64 - 0.5).contains(&v);
        (point.z > 0.0 && is_inside).then(|| nearest(v) * width + nearest(u))
    }
}

/// The whole number nearest to one from 0 to 2^32, as `round` has it, which without vector units is a call.
#[inline]
fn nearest(x: f64) -> usize {
    let below = x as u32;
    below as usize + usize::from(x - f64::from(below) >= 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn projection_undoes_back_projection() {
        let camera = Camera::new(525.0, 520.0, 319.5, 239.5).unwrap();
        for (u, v, z) in [(0, 0, 0.5), (639, 479, 2.0), (320, 100, 1.0)] {
            let (pu, pv) = camera.project(camera.back_project(u, v, z));
            assert!((pu - u as f64).abs() < 1e-4 && (pv - v as f64).abs() < 1e-4, "{pu} {pv}");
        }
    }

    #[test]
    fn the_nearest_whole_number_is_that_of_round() {
        for x in (0..4000).map(|k| 0.25 * f64::from(k)) {
            for x in [x.next_down().max(0.0), x, x.next_up()] {
                assert_eq!(nearest(x), x.round() as usize, "{x:e}");
            }
        }
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Camera::new(0.0, 1.0, 0.0, 0.0).is_err());
        assert!(Camera::new(1.0, f64::NAN, 0.0, 0.0).is_err());
        assert!(Camera::new(1.0, -1.0, 0.0, 0.0).is_err());
        assert!(Camera::new(1e-300, 1.0, 0.0, 0.0).is_err());
        assert!(Camera::new(1.0, 1.0, 1e300, 0.0).is_err());
    }
}
