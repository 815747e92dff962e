//! A frame as the tracker sees it.

use glam::{DVec3, Vec3};
use objecthood::discovery::StructurePlane;
use objecthood::{Camera, Discovery, Frame};

use crate::field::Field;

/// Normals are computed from differences over this many pixels to each side.
const NORMAL_REACH_PX: usize = 4;
/// Neighbours whose depth differs by more than this share belong to another surface.
const SAME_SURFACE: f32 = 0.02;

/// Inverse depth and grey value of every pixel.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) size: (usize, usize),
    pub(crate) camera: Camera,
    /// 1/m; 0 where there is no depth.
    pub(crate) inverse: Vec<f32>,
    /// 0 to 255; empty without colour.
    pub(crate) grey: Vec<u8>,
    /// sRGB; empty without colour.
    pub(crate) color: Vec<[u8; 3]>,
    /// The part of the image in which depth is measured.
    pub(crate) field: Field,
    /// How much noisier than a Kinect the sensor is; at least 1.
    pub(crate) noise: f32,
    /// The plane of structure at every pixel, counted from 1, 0 = none, and the unit normals of the planes. Both are
    /// empty if they are not known.
    pub(crate) structure: Vec<u16>,
    pub(crate) planes: Vec<Option<DVec3>>,
}

/// The pixel in a column and row, if it is in the image, then those to its right and below it. Pixels that
/// move apart leave gaps, which these four close.
pub(crate) fn block((u, v): (usize, usize), (width, height): (usize, usize)) -> impl Iterator<Item = usize> {
    let at = [(u, v), (u + 1, v), (u, v + 1), (u + 1, v + 1)].into_iter();
    at.filter(move |&(u, v)| u < width && v < height).map(move |(u, v)| v * width + u)
}

impl View {
    /// Whether a pixel lies on the border of the region that the sensor measures.
    pub(crate) fn is_border(&self, pixel: usize) -> bool {
        self.field.is_border(pixel % self.size.0, pixel / self.size.0, 0)
    }

    /// O(n).
    pub(crate) fn of(frame: &Frame, noise: f32) -> Self {
        let inverse: Vec<f32> =
            frame.depth_m().as_slice().iter().map(|&z| if z > 0.0 { 1.0 / z } else { 0.0 }).collect();
        let color: Vec<[u8; 3]> = frame.color().map_or_else(Vec::new, |color| color.as_slice().to_vec());
        let grey = color
            .iter()
            .map(|&[r, g, b]| ((77 * u32::from(r) + 150 * u32::from(g) + 29 * u32::from(b)) >> 8) as u8)
            .collect();
        let field = Field::of(frame);
        let (size, camera) = (frame.size(), frame.camera());
        Self { size, camera, inverse, grey, color, field, noise, structure: Vec::new(), planes: Vec::new() }
    }

    /// With the planes of structure that were found in the frame; without, if their image has another size. O(n).
    pub(crate) fn with_planes(mut self, found: &Discovery) -> Self {
        if found.structure.size() == self.size {
            self.structure = found.structure.as_slice().to_vec();
            let normal = |plane: &StructurePlane| Vec3::from(plane.normal).as_dvec3().try_normalize();
            self.planes = found.structure_planes.iter().map(normal).collect();
        }
        self
    }

    /// The point (m) of a pixel with depth.
    pub(crate) fn point(&self, pixel: usize) -> Option<DVec3> {
        self.point_at(pixel, self.inverse[pixel])
    }

    /// The point (m) that a pixel shows at an inverse depth (1/m, 0 = unknown).
    pub(crate) fn point_at(&self, pixel: usize, inverse: f32) -> Option<DVec3> {
        (inverse > 0.0).then(|| {
            let (u, v) = ((pixel % self.size.0) as f64, (pixel / self.size.0) as f64);
            DVec3::from(self.camera.ray(u, v)) / f64::from(inverse)
        })
    }

    /// Column and row at which a point (m) is seen; `None` behind the camera and outside the image.
    pub(crate) fn project(&self, p: DVec3) -> Option<(f64, f64)> {
        if p.z <= 0.05 {
            return None;
        }
        let u = self.camera.fx_px * p.x / p.z + self.camera.cx_px;
        let v = self.camera.fy_px * p.y / p.z + self.camera.cy_px;
        let (width, height) = self.size;
        let is_inside = u >= 0.0 && v >= 0.0 && u <= (width - 1) as f64 && v <= (height - 1) as f64;
        is_inside.then_some((u, v))
    }

    /// The pixel at which a point (m) is seen.
    pub(crate) fn pixel_of(&self, p: DVec3) -> Option<usize> {
        self.project(p).map(|(u, v)| (v + 0.5) as usize * self.size.0 + (u + 0.5) as usize)
    }

    /// Whether a pixel lies on a plane of structure.
    pub(crate) fn is_structure(&self, pixel: usize) -> bool {
        self.structure.get(pixel).is_some_and(|&plane| plane > 0)
    }

    /// The unit normal of the surface at a pixel: that of its plane of structure. Elsewhere it is taken from
    /// inverse depth, which is linear on planes. There it has the noise of a few pixels: with it, a table would
    /// seem to tell how the camera moves along it.
    pub(crate) fn normal(&self, pixel: usize) -> Option<DVec3> {
        let plane = self.structure.get(pixel).and_then(|&plane| usize::from(plane).checked_sub(1));
        if let Some(normal) = plane.and_then(|plane| self.planes.get(plane).copied().flatten()) {
            return Some(normal);
        }
        let (width, height) = self.size;
        let (u, v) = (pixel % width, pixel / width);
        let here = self.inverse[pixel];
        let slope = |before: Option<usize>, after: Option<usize>| -> Option<f64> {
            let known = |at: Option<usize>| {
                let value = self.inverse[at?];
                (value > 0.0 && (value - here).abs() < SAME_SURFACE * here).then_some(f64::from(value))
            };
            let reach = NORMAL_REACH_PX as f64;
            match (known(before), known(after)) {
                (Some(a), Some(b)) => Some((b - a) / (2.0 * reach)),
                (Some(a), None) => Some((f64::from(here) - a) / reach),
                (None, Some(b)) => Some((b - f64::from(here)) / reach),
                (None, None) => None,
            }
        };
        let reach = NORMAL_REACH_PX;
        let along = slope((u >= reach).then(|| pixel - reach), (u + reach < width).then(|| pixel + reach))?;
        let down = slope(
            (v >= reach).then(|| pixel - reach * width),
            (v + reach < height).then(|| pixel + reach * width),
        )?;
        let Camera { fx_px, fy_px, cx_px, cy_px } = self.camera;
        let at_center = f64::from(here) - along * (u as f64 - cx_px) - down * (v as f64 - cy_px);
        DVec3::new(along * fx_px, down * fy_px, at_center).try_normalize().map(|n| -n)
    }

    /// How much grey values change at a pixel (levels per pixel, squared), over this many pixels to each side: over
    /// two neighbours alone, it is noise. `None` without colour, and where depth jumps or is not measured so far
    /// around: what is seen at the edge of a thing changes with the view.
    pub(crate) fn change_within_surface(&self, u: usize, v: usize, reach: usize) -> Option<f64> {
        let (width, height) = self.size;
        if self.grey.is_empty() || u < reach || v < reach || u + reach >= width || v + reach >= height {
            return None;
        }
        let pixel = v * width + u;
        let here = self.inverse[pixel];
        let beside = [pixel - reach, pixel + reach, pixel - reach * width, pixel + reach * width];
        let is_same = |&at: &usize| (self.inverse[at] - here).abs() < SAME_SURFACE * here;
        let [left, right, above, below] = beside.map(|at| f64::from(self.grey[at]));
        let square = ((right - left).powi(2) + (below - above).powi(2)) / (2.0 * reach as f64).powi(2);
        (here > 0.0 && beside.iter().all(is_same)).then_some(square)
    }

    /// The grey value between pixels, and its change a column and a row.
    pub(crate) fn grey_at(&self, u: f64, v: f64) -> Option<(f64, f64, f64)> {
        let (width, height) = self.size;
        let (u0, v0) = (u as usize, v as usize);
        if self.grey.is_empty() || u0 < 1 || v0 < 1 || u0 + 2 >= width || v0 + 2 >= height {
            return None;
        }
        let at = |u: usize, v: usize| f64::from(self.grey[v * width + u]);
        let (a, b) = (u - u0 as f64, v - v0 as f64);
        let blend = |f: &dyn Fn(usize, usize) -> f64| {
            (1.0 - b) * ((1.0 - a) * f(u0, v0) + a * f(u0 + 1, v0))
                + b * ((1.0 - a) * f(u0, v0 + 1) + a * f(u0 + 1, v0 + 1))
        };
        let along = |u: usize, v: usize| 0.5 * (at(u + 1, v) - at(u - 1, v));
        let down = |u: usize, v: usize| 0.5 * (at(u, v + 1) - at(u, v - 1));
        Some((blend(&at), blend(&along), blend(&down)))
    }

    /// Converts an area: the pixels that correspond to `px` pixels of an image of VGA size.
    pub(crate) fn px(&self, px_at_vga: f64) -> usize {
        ((px_at_vga * (self.size.0 * self.size.1) as f64 / (640.0 * 480.0)) as usize).max(1)
    }

    /// Converts a length: the pixels that correspond to `px` pixels of an image of VGA size (px).
    pub(crate) fn length_px(&self, px_at_vga: f64) -> usize {
        ((px_at_vga * self.size.0 as f64 / 640.0 + 0.5) as usize).max(1)
    }

    /// Standard deviation of depth at a distance (m).
    pub(crate) fn sigma_m(&self, z_m: f64) -> f64 {
        /// Of a Kinect: 1.2 mm at 1 m, growing with the square (K. Khoshelham, S. O. Elberink, Sensors 12, 2012).
        const KINECT_M: f64 = 0.0012;
        KINECT_M * z_m * z_m * f64::from(self.noise)
    }
}

#[cfg(test)]
mod tests {
    use objecthood::Raster;

    use super::*;

    #[test]
    fn planes_give_normals_where_they_are_known_and_sound() {
        let plane = |normal| StructurePlane { normal, offset_m: 1.0, inlier_share: 1.0 };
        let normal = |size: (usize, usize), of_plane: [f32; 3]| {
            let depth_m = Raster::filled(20, 20, 1.0).unwrap();
            let frame = Frame::new(depth_m, None, Camera::new(20.0, 20.0, 9.5, 9.5).unwrap()).unwrap();
            let mut found = Discovery::new(Vec::new(), Raster::filled(20, 20, 0).unwrap());
            found.structure = Raster::filled(size.0, size.1, 1).unwrap();
            found.structure_planes = vec![plane(of_plane)];
            View::of(&frame, 1.0).with_planes(&found).normal(10 * 20 + 10).unwrap()
        };
        let tilted = DVec3::new(0.6, 0.0, -0.8);
        assert!((normal((20, 20), [1.2, 0.0, -1.6]) - tilted).length() < 1e-6);
        assert!((normal((20, 20), [f32::NAN; 3]) - DVec3::NEG_Z).length() < 1e-6, "it is no direction");
        assert!((normal((10, 20), [0.6, 0.0, -0.8]) - DVec3::NEG_Z).length() < 1e-6, "of another size");
    }
}
