//! Disparity space: the sensor's noise is constant in it, and planes are affine (docs/CONTEXT.md 0.2).
//!
//! The disparity of a pixel is its inverse depth d = 1/(z Q), counted in *quanta* Q of the sensor. One tolerance in quanta holds
//! at any depth, and a plane in space is exactly d = value + slope · (u, v).

use glam::DVec3;
use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::camera::Camera;
use crate::noise::Noise;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;

/// Range of depths (m) that count as measured in `context`.
const RANGE_M: std::ops::Range<f32> = 0.1..20.0;

/// The focal length (px) at which parameters in pixels hold; at others they scale with it.
const REFERENCE_FOCAL_PX: f64 = 525.0;

/// The camera and the sensor's noise. Converts between depth and disparity, and disparities to points and planes in space.
#[derive(Clone, Copy, Debug)]
pub struct DisparitySpace {
    camera: Camera,
    quantum_per_m: f64,
    lateral_noise_px: f64,
    scale: f64,
    noise: Noise,
}

impl DisparitySpace {
    /// The space of a camera and a sensor with a Kinect's noise.
    pub fn new(camera: Camera, sensor: &params::Sensor) -> Self {
        let scale = (camera.fx_px * camera.fy_px).sqrt() / REFERENCE_FOCAL_PX;
        Self {
            camera,
            quantum_per_m: sensor.disparity_quantum_per_m,
            lateral_noise_px: sensor.lateral_noise_px * scale,
            scale,
            noise: Noise::KINECT,
        }
    }

    /// The same space with another noise of the sensor.
    pub fn with_noise(self, noise: Noise) -> Self {
        Self { noise, ..self }
    }

    /// The noise of the sensor; a Kinect's unless it was estimated.
    #[inline]
    pub fn noise(&self) -> &Noise {
        &self.noise
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// The disparity of every pixel (quanta); `NaN` without depth, or with one outside 0.1 to 20 m.
    pub fn disparity(&self, depth_m: &Raster<f32>) -> Raster<f32> {
        let disparity = |z: f32| {
            let is_measured = (z > RANGE_M.start) & (z < RANGE_M.end);
            let disparity = (1.0 / (f64::from(z) * self.quantum_per_m)) as f32;
            if is_measured { disparity } else { f32::NAN }
        };
        let mut disparities = Buffer::stale(depth_m.len(), f32::NAN);
        let bands = disparities.par_chunks_mut(BAND_PX).zip(depth_m.as_slice().par_chunks(BAND_PX));
        bands.for_each(|(disparities, depths_m)| {
            vectorized(
                #[inline(always)]
                || disparities.iter_mut().zip(depths_m).for_each(|(d, z_m)| *d = disparity(*z_m)),
            );
        });
        depth_m.with_data(disparities)
    }

    /// Depth (m) of a disparity (quanta).
    #[inline]
    pub fn depth_m(&self, disparity: f64) -> f64 {
        1.0 / (disparity * self.quantum_per_m)
    }

    /// The point (m) at pixel (u, v) with this disparity (quanta).
    #[inline]
    pub fn point_m(&self, [u, v]: [f64; 2], disparity: f64) -> [f64; 3] {
        self.camera.ray(u, v).map(|part| part * self.depth_m(disparity))
    }

    /// Unit normal, towards the camera, of the plane with this value (quanta) and slope (quanta/px) at pixel (u, v).
    #[inline]
    pub fn normal(&self, at: [f64; 2], value: f64, slope: [f64; 2]) -> [f64; 3] {
        (-self.across(at, value, slope).normalize()).to_array()
    }

    /// Distance (m) of the camera from the plane with this value (quanta) and slope (quanta/px) at pixel (u, v).
    pub fn distance_m(&self, at: [f64; 2], value: f64, slope: [f64; 2]) -> f64 {
        1.0 / (self.quantum_per_m * self.across(at, value, slope).length())
    }

    /// The vector g with g · X = 1/Q for every point X of the plane with this value and slope at pixel (u, v).
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

    /// The noise of a surface with this slope (quanta/px), relative to a surface seen face-on. Noise also moves points sideways; on a
    /// slope this looks like noise of disparity.
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

    /// A length in pixels of this image, in pixels at a focal length of 525 px.
    #[inline]
    pub fn length_at_525_px(&self, length_px: f64) -> f64 {
        length_px / self.scale
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

/// Pixels that one thread converts at a time.
const BAND_PX: usize = 1 << 14;

/// Column and row of the pixel with row-major index `i`.
#[inline]
pub(crate) fn position(i: usize, width: usize) -> [f64; 2] {
    // An image has at most 2^28 pixels, and 32 bits are divided and converted in fewer steps than 64.
    let (i, width) = (i as u32, width as u32);
    [i % width, i / width].map(f64::from)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{kinect, space};

    #[test]
    fn disparity_is_the_inverse_of_depth_within_range() {
        let kinect = kinect();
        let depths_m: Vec<f32> = (0..40_000).map(|k| 0.001 * k as f32).collect();
        let depth = Raster::from_vec(200, 200, depths_m).unwrap();
        let disparity = kinect.disparity(&depth);
        for (&z_m, &d) in depth.as_slice().iter().zip(disparity.as_slice()) {
            let expected = if RANGE_M.start < z_m && z_m < RANGE_M.end {
                (1.0 / (f64::from(z_m) * kinect.quantum_per_m)) as f32
            } else {
                f32::NAN
            };
            assert_eq!(d.to_bits(), expected.to_bits(), "{z_m} m");
        }
    }

    proptest! {
        #[test]
        fn what_is_affine_in_disparity_is_a_plane_in_space(
            focal_px in prop::array::uniform2(200.0..1200.0),
            center_px in prop::array::uniform2(100.0..500.0),
            at in prop::array::uniform2(0.0..640.0),
            slope in prop::array::uniform2(-0.5..0.5),
            pixels in prop::collection::vec(prop::array::uniform2(0.0..640.0), 20),
        ) {
            let space = space(focal_px, center_px);
            // At least 60 quanta everywhere in the image: in front of the camera.
            let value = 700.0;
            let normal = DVec3::from(space.normal(at, value, slope));
            let distance_m = space.distance_m(at, value, slope);
            prop_assert!((normal.length() - 1.0).abs() < 1e-12);
            for pixel in pixels {
                let d = value + slope[0] * (pixel[0] - at[0]) + slope[1] * (pixel[1] - at[1]);
                let point = DVec3::from(space.point_m(pixel, d));
                prop_assert!((normal.dot(point) + distance_m).abs() < 1e-9, "{point} {normal} {distance_m}");
                prop_assert!(normal.dot(point) < 0.0, "the normal points to the camera");
                let (u, v) = space.camera().project(point.as_vec3().to_array());
                prop_assert!((u - pixel[0]).abs() < 1e-3 && (v - pixel[1]).abs() < 1e-3);
            }
        }

        #[test]
        fn a_plane_in_space_is_affine_in_disparity(
            focal_px in prop::array::uniform2(200.0..1200.0),
            [nx, ny] in prop::array::uniform2(-0.4..0.4),
            distance_m in 0.5_f64..3.0,
        ) {
            let space = space(focal_px, [4.5, 3.5]);
            let normal = DVec3::new(nx, ny, -1.0).normalize();
            let seen = |i: usize| {
                let [u, v] = position(i, 10);
                (-distance_m / normal.dot(DVec3::from(space.camera().ray(u, v)))) as f32
            };
            let depth_m = Raster::from_vec(10, 8, (0..80).map(seen).collect()).unwrap();
            let d = space.disparity(&depth_m).map(|&d| f64::from(d));
            let slope = [(d[9] - d[0]) / 9.0, (d[70] - d[0]) / 7.0];
            for i in 0..80 {
                let [u, v] = position(i, 10);
                prop_assert!((d[i] - (d[0] + slope[0] * u + slope[1] * v)).abs() < 1e-3);
                prop_assert!((space.depth_m(d[i]) - f64::from(depth_m[i])).abs() < 1e-6);
            }
            prop_assert!(DVec3::from(space.normal([0.0; 2], d[0], slope)).dot(normal) > 0.9999);
            prop_assert!((space.distance_m([0.0; 2], d[0], slope) / distance_m - 1.0).abs() < 1e-2);
        }
    }

    #[test]
    fn depth_beyond_the_range_is_missing() {
        let depth = vec![f32::NAN, 1e-3, 0.1, 0.11, 1.0, 19.9, 20.0, 1e13, f32::INFINITY, -1.0];
        let disparity = kinect().disparity(&Raster::from_vec(10, 1, depth).unwrap());
        let measured: Vec<usize> = (0..10).filter(|&i| !disparity[i].is_nan()).collect();
        assert_eq!(measured, [3, 4, 5]);
        assert!((disparity[4] - 1.0 / 0.00285).abs() < 1e-3);
    }

    #[test]
    fn one_quantum_is_three_millimetres_at_a_metre() {
        let space = kinect();
        assert!((space.step_m(1.0, 1.0) - 0.00285).abs() < 1e-12);
        let (d, z_m) = (175.0, space.depth_m(175.0));
        let exact = space.depth_m(d - 0.5) - space.depth_m(d + 0.5);
        assert!((space.step_m(1.0, z_m) / exact - 1.0).abs() < 1e-4);
    }

    #[test]
    fn pixels_scale_with_the_focal_length() {
        let [half, same, double] = [262.5, 525.0, 1050.0].map(|f| space([f, f], [0.0; 2]));
        assert_eq!([half, same, double].map(|space| space.length_px(7)), [4, 7, 14]);
        assert_eq!([half, same, double].map(|space| space.area_px(100)), [25, 100, 400]);
        assert_eq!((half.length_px(1), half.length_px(0), half.area_px(0)), (1, 1, 0));
        // At twice the focal length a surface has half the slope, and the same noise.
        let noise = [(half, 1.5), (same, 0.75), (double, 0.375)].map(|(space, g)| space.slope_noise(g));
        assert!(noise.iter().all(|noise| (noise - (1.0_f64 + 0.36).sqrt()).abs() < 1e-12), "{noise:?}");
        // With two focal lengths, their geometric mean counts.
        let oblong = space([1050.0, 262.5], [0.0; 2]);
        assert_eq!((oblong.length_px(7), oblong.area_px(100), oblong.lateral_noise_px()), (7, 100, 0.8));
    }
}
