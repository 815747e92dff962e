//! The table of a scene: where it is, how it measures, and what it looks like with nothing on it.

use glam::{DVec2, DVec3};
use objecthood::Raster;
use objecthood::surface::disparity::DisparitySpace;
use objecthood::surface::model::{Basis, Model};
use objecthood::surface::moments::Moments;
use objecthood_scene::random::Rng;

use super::canvas::Canvas;
use super::morphology::Mask;
use super::polygon::Polygon;
use crate::dataset::Scene;

/// So near to an object (px) pixels of the table are not its own: mixed depth, and colour registered askew.
const FRINGE_PX: usize = 5;
/// Fewer pixels (px) make no table.
const MIN_SIZE_PX: usize = 1000;
/// How many displacements are tried to find table for every hole, and how much farther each may reach (px).
const STAMPS: usize = 64;
const STAMP_GROWTH_PX: usize = 8;

/// The frame of a level ground: x to the camera's right, y away from it, z up, from the point below the camera (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground {
    axes: [DVec3; 3],
    foot: DVec3,
}

impl Ground {
    fn new(up: DVec3, height_m: f64) -> Self {
        let right = DVec3::X.reject_from_normalized(up).normalize_or(up.any_orthonormal_vector());
        Self { axes: [right, up.cross(right), up], foot: -up * height_m }
    }

    /// From the camera's frame to the ground's.
    pub(super) fn ground_point(&self, point: DVec3) -> DVec3 {
        DVec3::from(self.axes.map(|axis| axis.dot(point - self.foot)))
    }

    /// From the ground's frame to the camera's.
    pub(super) fn camera_point(self, point: DVec3) -> DVec3 {
        let [right, away, up] = self.axes;
        self.foot + right * point.x + away * point.y + up * point.z
    }
}

/// A table on which objects can be put.
pub(super) struct Table {
    pub(super) ground: Ground,
    /// Where it is (m).
    pub(super) outline: Polygon,
    /// Its disparity (quanta): a plane for who measures in space, and with the bend that the sensor's distortion gives it.
    plane: Model,
    bent: Model,
    /// The pixels that show it.
    is_bare: Mask,
}

impl Table {
    /// The table of a scene, with the background of its truth as the table; `None` where that is no surface.
    pub(super) fn of(scene: &Scene, disparity: &Raster<f32>, space: &DisparitySpace) -> Option<Self> {
        let truth = &scene.truth;
        let width = disparity.width();
        let objects = (0..disparity.len()).map(|i| truth.object_at(i).is_some()).collect();
        let fringed = Mask { width, pixels: objects }.dilated(FRINGE_PX);
        let is_bare = |i: usize| {
            truth.label_at(i).is_some()
                && truth.label_at(i) == truth.roles().background
                && !fringed.pixels[i]
                && disparity[i] > 0.0
        };
        let is_bare = Mask { width, pixels: (0..disparity.len()).map(is_bare).collect() };
        let pixels: Vec<u32> =
            (0..disparity.len()).filter(|&i| is_bare.pixels[i]).map(|i| i as u32).collect();
        if pixels.len() < MIN_SIZE_PX {
            return None;
        }
        let moments = Moments::of(&pixels, disparity);
        let [plane, bent] = [Basis::Plane, Basis::Quadratic].map(|basis| moments.fit(basis).model);
        let at = moments.center;
        let up = space.normal(at, plane.value(at), plane.slope(at));
        let ground = Ground::new(up.into(), space.distance_m(at, plane.value(at), plane.slope(at)));
        let seen =
            pixels.iter().filter_map(|&i| on_ground(position(i as usize, width), &plane, &ground, space));
        let outline = Polygon::hull(seen.collect())?;
        Some(Self { ground, outline, plane, bent, is_bare })
    }

    /// The scene without its objects: where they and their shadows were, the table goes on.
    ///
    /// Every hole is filled with what the table shows some way off: its colour, and how its disparity departs from the
    /// bent surface. All holes that find table at one displacement are filled by it, so that noise and texture keep
    /// their grain. What finds none stays without depth.
    pub(super) fn cleared(
        &self,
        scene: &Scene,
        disparity: &Raster<f32>,
        space: &DisparitySpace,
        rng: &mut Rng,
    ) -> Canvas {
        let (width, height) = disparity.size();
        let mut canvas = Canvas::new(&scene.frame);
        let on_table = |i: usize| {
            on_ground(position(i, width), &self.plane, &self.ground, space)
                .is_some_and(|point| self.outline.holds(point))
        };
        let mut holes = Vec::new();
        for i in 0..disparity.len() {
            if self.is_bare.pixels[i] {
                canvas.show_table(i, i, space.depth_m(f64::from(disparity[i])));
            } else if on_table(i) {
                holes.push(i);
            }
        }
        for k in 1..=STAMPS {
            let reach = (k * STAMP_GROWTH_PX) as f64;
            let [du, dv] = [0; 2].map(|_: usize| rng.range(-reach..reach).round() as isize);
            holes.retain(|&i| {
                let (u, v) = ((i % width).wrapping_add_signed(du), (i / width).wrapping_add_signed(dv));
                let is_table = u < width && v < height && self.is_bare.pixels[v * width + u];
                if is_table {
                    let from = v * width + u;
                    let departure = f64::from(disparity[from]) - self.bent.value(position(from, width));
                    canvas.show_table(
                        i,
                        from,
                        space.depth_m(self.bent.value(position(i, width)) + departure),
                    );
                }
                !is_table
            });
        }
        canvas
    }
}

/// Where the ray of a pixel meets the plane, on the ground (m); `None` beyond the horizon.
fn on_ground(at: [f64; 2], plane: &Model, ground: &Ground, space: &DisparitySpace) -> Option<DVec2> {
    let disparity = plane.value(at);
    (disparity > 0.0).then(|| ground.ground_point(space.point_m(at, disparity).into()).truncate())
}

/// Column and row of a pixel.
pub(super) fn position(i: usize, width: usize) -> [f64; 2] {
    [(i % width) as f64, (i / width) as f64]
}
