//! A list of points on the pixel grid, and the way back from pixels to points.

use objecthood::{Frame, Raster};

use super::{GridCamera, is_valid, nearest};
use crate::capture::{Capture, Pose};
use crate::cloud::PointCloud;
use crate::error::{Error, Result};

/// A point belongs to the surface that its pixel shows when their depths differ by no more than this (disparity steps of a
/// Kinect): noise, of which three steps are rarely exceeded.
const SAME_SURFACE_QUANTA: f64 = 3.0;
/// Disparity step of a Kinect (1/m).
const KINECT_QUANTUM_PER_M: f64 = 0.00285;
/// And by this many widths of the pixel besides: what a surface that is seen at 60 degrees recedes within it.
const SAME_SURFACE_PIXELS: f64 = 1.75;
/// Marks a point that no pixel shows.
const UNSEEN: u32 = u32::MAX;

/// What became of each point of an unorganized cloud.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PointList {
    /// The points as the file has them (m), in its order and its frame.
    pub points_m: Vec<[f32; 3]>,
    /// Where the file says that the sensor was, if not in the origin.
    pub viewpoint: Option<Pose>,
    /// Whether the camera was chosen to fit the points, because none was given.
    pub is_virtual: bool,
    /// Where the camera is in the frame of the file.
    pub camera_pose: Pose,
    /// Points that a pixel shows, themselves or as part of the same surface.
    pub seen: usize,
    /// Index of the pixel that shows a point, or [`UNSEEN`].
    pixels: Vec<u32>,
}

impl PointList {
    /// The label of every point, in the order of the file: that of the pixel that shows it. A point that is missing,
    /// outside the image or hidden behind another surface has label 0. `labels` has the size of the frame.
    pub fn labels(&self, labels: &Raster<u16>) -> Vec<u16> {
        let label = |&pixel: &u32| labels.as_slice().get(pixel as usize).copied().unwrap_or(0);
        self.pixels.iter().map(label).collect()
    }
}

/// Which of several points in a pixel gives its depth.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Shown {
    /// The last of the list: the file is an image, and says which points are to be seen.
    Last,
    /// Of the nearest surface the one nearest to the middle of the pixel.
    Nearest,
}

/// Puts a list of points on the grid of a camera at `pose`. Its size has been checked. O(points + pixels).
pub(super) fn place(cloud: PointCloud, grid: &GridCamera, pose: Pose, shown: Shown) -> Result<Capture> {
    let (width, height) = grid.image_size()?;
    let sights = Sights { points_m: &cloud.points_m, grid, size: (width, height), pose };
    let front = match shown {
        Shown::Last => sights.last(),
        Shown::Nearest => sights.nearest(),
    };
    if front.iter().all(|&point| point == UNSEEN) {
        let points = sights.valid();
        if points > 0 {
            return Err(Error::NothingInView { points, size: (width, height) });
        }
    }
    let of = |pixel: &u32| (*pixel != UNSEEN).then_some(*pixel as usize);
    let depth_m: Vec<f32> = front
        .iter()
        .map(|k| of(k).map_or(f32::NAN, |k| sights.point(k).map_or(f32::NAN, |p| p[2])))
        .collect();
    let pixels = sights.shown_by(&depth_m);
    let color = cloud.color.as_ref().map(|color| front.iter().map(|k| of(k).map_or([0; 3], |k| color[k])));
    let truth = cloud.label.as_ref().map(|label| front.iter().map(|k| of(k).map_or(0, |k| label[k])));
    let color = color.map(|color| Raster::from_vec(width, height, color.collect())).transpose()?;
    let truth = truth.map(|truth| Raster::from_vec(width, height, truth.collect())).transpose()?;
    let frame = Frame::new(Raster::from_vec(width, height, depth_m)?, color, grid.camera)?;

    let list = PointList {
        seen: pixels.iter().filter(|&&pixel| pixel != UNSEEN).count(),
        points_m: cloud.points_m,
        viewpoint: cloud.viewpoint,
        is_virtual: shown == Shown::Nearest,
        camera_pose: pose,
        pixels,
    };
    Ok(Capture { truth, list: Some(list), ..Capture::new(frame) })
}

/// Points as a camera sees them.
struct Sights<'a> {
    points_m: &'a [[f32; 3]],
    grid: &'a GridCamera,
    size: (usize, usize),
    pose: Pose,
}

impl Sights<'_> {
    /// A point in the frame of the camera, if it lies in front of it.
    fn point(&self, k: usize) -> Option<[f32; 3]> {
        Some(self.pose.to_camera(self.points_m[k])).filter(|&point| is_valid(point))
    }

    /// Points in front of the camera.
    fn valid(&self) -> usize {
        (0..self.points_m.len()).filter(|&k| self.point(k).is_some()).count()
    }

    /// The points in the image: index, pixel, depth (m), and the square of the distance from the middle of the pixel (px²).
    fn in_view(&self) -> impl Iterator<Item = (usize, usize, f32, f64)> {
        let (width, height) = self.size;
        (0..self.points_m.len()).filter_map(move |k| {
            let point = self.point(k)?;
            let (u, v) = self.grid.camera.project(point);
            let (column, row) = (nearest(u, width)?, nearest(v, height)?);
            let off = (u - column as f64).powi(2) + (v - row as f64).powi(2);
            Some((k, row * width + column, point[2], off))
        })
    }

    /// For every pixel the last point in it.
    fn last(&self) -> Vec<u32> {
        let mut front = vec![UNSEEN; self.size.0 * self.size.1];
        self.in_view().for_each(|(k, pixel, ..)| front[pixel] = k as u32);
        front
    }

    /// For every pixel the point of the nearest surface that is nearest to its middle.
    fn nearest(&self) -> Vec<u32> {
        let pixels = self.size.0 * self.size.1;
        let mut nearest_m = vec![f32::INFINITY; pixels];
        for (_, pixel, z, _) in self.in_view() {
            nearest_m[pixel] = nearest_m[pixel].min(z);
        }
        let mut front = vec![UNSEEN; pixels];
        let mut least_off = vec![f32::INFINITY; pixels];
        for (k, pixel, z, off) in self.in_view() {
            let off = off as f32;
            if off < least_off[pixel] && self.is_same_surface(z, nearest_m[pixel]) {
                (front[pixel], least_off[pixel]) = (k as u32, off);
            }
        }
        front
    }

    /// For every point the pixel that shows it.
    fn shown_by(&self, depth_m: &[f32]) -> Vec<u32> {
        let mut pixels = vec![UNSEEN; self.points_m.len()];
        for (k, pixel, z, _) in self.in_view() {
            if self.is_same_surface(z, depth_m[pixel]) {
                pixels[k] = pixel as u32;
            }
        }
        pixels
    }

    fn is_same_surface(&self, a_m: f32, b_m: f32) -> bool {
        let z = f64::from(a_m.min(b_m));
        let noise_m = SAME_SURFACE_QUANTA * KINECT_QUANTUM_PER_M * z * z;
        let slant_m = SAME_SURFACE_PIXELS * z / self.grid.camera.fx_px;
        f64::from((a_m - b_m).abs()) <= noise_m + slant_m
    }
}
