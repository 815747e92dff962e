//! Structure planes: large surfaces that carry or enclose the objects (METHOD 3.3).
//!
//! They are taken out first: they are support and background, they say what "up" and "height" are, and every later
//! stage is cheaper without them.

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::camera::Camera;
use crate::objectness::gravity::{PointSums, StructurePlane};
use crate::params;
use crate::random::Lcg;
use crate::raster::{Raster, marked};
use crate::regions::{Segments, runs};
use crate::simd::vectorized;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::moments::{Basis, Model, Moments};
use crate::surface::plane_fit::PlaneFits;
use crate::surface::window_choice::Orientation;
use crate::workspace::Workspace;

/// A large surface: almost a plane.
#[derive(Clone, Debug)]
pub struct StructureSurface {
    /// Its disparity; quadratic, because the sensor's own distortion bends a table by more than its noise.
    pub model: Model,
    /// Unit normal of the plane it started from, towards the camera.
    pub normal: DVec3,
    /// Distance of the camera from that plane (m).
    pub offset_m: f64,
}

/// The structure of a scene.
#[derive(Clone, Debug)]
pub struct Structure {
    /// The surfaces, in the order in which they were found.
    pub surfaces: Vec<StructureSurface>,
    /// The surface of every pixel; -1 = none.
    pub labels: Raster<i32>,
    /// The surface on which objects stand: the first that faces up as the camera is held, else the first of all.
    pub support: Option<usize>,
}

/// Every so many columns and rows one pixel is looked at (px at a focal length of 525 px).
const GRID_PX: usize = 6;
/// So many surfaces are looked for: a room has a table, a floor, walls, shelves.
const ROUNDS: usize = 8;
/// With fewer pixels left on the grid nothing is looked for.
const LEAST_POOL: usize = 150;
/// Planes tried in a round.
const TRIALS: usize = 300;
/// Twice the area of the triangle of a trial (px^2 at 525 px) is at least this.
const LEAST_TRIANGLE_PX: usize = 400;
/// A trial counts the pixels nearer than this (quanta).
const TRIAL_QUANTA: f64 = 2.0;
/// The best trial has at least so many.
const LEAST_VOTES: usize = 100;
/// Fitted again to pixels nearer than this to the plane, then to the surface (quanta).
const REFIT_QUANTA: [f64; 3] = [3.5, 3.0, 3.0];
/// To at least so many.
const LEAST_REFIT: usize = 50;
/// Nearer than this pixels are taken out with the surface (quanta).
const INLIER_QUANTA: f64 = 3.0;
/// Samples hang together when they are at most so many places of the grid apart.
const PIECE_GAP: usize = 2;
/// A surface this large ...
const LARGE_M2: f64 = 0.18;
/// ... and this long is structure;
const LONG_M: f64 = 0.5;
/// and the first one already if it holds this share of the pixels ...
const DOMINANT_SHARE: f64 = 0.2;
/// ... and has this area.
const DOMINANT_M2: f64 = 0.03;
/// A pixel seen more glancingly than this cosine counts as if it were seen so.
const LEAST_COSINE: f64 = 0.15;
/// A surface whose normal has more than this upwards is one to stand on.
pub(crate) const UPWARD: f64 = 0.3;
/// Pixels of a row of which is asked first whether any lies near a surface.
const STRETCH: usize = 64;
/// What lies in front of a surface that is behind the horizon stands as high as this (m).
const BEYOND_M: f64 = 10.0;

/// A pixel of the grid.
struct Sample {
    at: [f64; 2],
    disparity: f64,
    point_m: DVec3,
    tilt: Tilt,
}

/// How a surface is turned at a pixel.
struct Tilt {
    /// Unit normal, towards the camera; zero where it is not known.
    normal: DVec3,
    /// Change of disparity along u and v (quanta/px).
    slope: [f64; 2],
}

impl Tilt {
    fn at(i: usize, orientation: &Orientation) -> Self {
        let normal = Vec3::from(orientation.normal[i]).as_dvec3();
        Self { normal, slope: orientation.slope[i].map(f64::from) }
    }
}

/// What passes for the same tilt.
///
/// The normal tells sides of low objects from the table they stand on. Where depth is coarse noise turns it at will, and a
/// wall 2 m away came to pieces; but not the slope of the disparity, whose noise is the same at any distance.
struct Alike {
    least_cosine: f64,
    /// The square of the slope between them is below this.
    slope_squared: f64,
}

impl Alike {
    fn are(&self, a: &Tilt, b: &Tilt) -> bool {
        a.normal.dot(b.normal) > self.least_cosine || squared_between(a.slope, b.slope) < self.slope_squared
    }
}

/// Squared length of the difference of two slopes.
#[inline(always)]
fn squared_between(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|k| a[k] - b[k]);
    x * x + y * y
}

/// The least number whose root is not below `length`, so that squares can be compared where lengths are meant.
fn least_square(length: f64) -> f64 {
    let mut square = length * length;
    while square.next_down().sqrt() >= length {
        square = square.next_down();
    }
    while square.sqrt() < length {
        square = square.next_up();
    }
    square
}

/// Finds the structure of a scene.
///
/// RANSAC (Fischler and Bolles 1981) with fixed random numbers over a grid of pixels; the best plane is refitted as a
/// quadratic and kept when it is large. `camera_up`: the camera's own up, see [`camera_up`](crate::objectness::gravity::camera_up). O(rounds · trials · pixels / 36).
#[expect(clippy::too_many_arguments, reason = "what was seen, how it was seen, and where to write")]
pub fn structure(
    disparity: &Raster<f32>,
    fits: &PlaneFits,
    orientation: &Orientation,
    points_m: &Raster<[f32; 3]>,
    space: &DisparitySpace,
    camera_up: [f32; 3],
    params: &params::Structure,
    workspace: &mut Workspace,
) -> Structure {
    let (width, height) = disparity.size();
    let grid = space.length_px(GRID_PX);
    let center = [(width / 2) as f64, (height / 2) as f64];
    let alike = Alike {
        least_cosine: cosine(params.angle_deg),
        slope_squared: least_square(space.slope_per_px(params.slope_quanta_per_px)),
    };
    let rows = (grid / 3..height).step_by(grid);
    let on_grid = rows.flat_map(|v| (grid / 3..width).step_by(grid).map(move |u| v * width + u));
    let mut pool: Vec<Sample> = on_grid
        .filter(|&i| fits.at(i).is_some())
        .map(|i| Sample {
            at: position(i, width),
            disparity: f64::from(disparity[i]),
            point_m: Vec3::from(points_m[i]).as_dvec3(),
            tilt: Tilt::at(i, orientation),
        })
        .collect();
    let everything = pool.len();

    let mut random = Lcg::new(12345);
    let mut surfaces = Vec::new();
    for _ in 0..ROUNDS {
        if pool.len() <= LEAST_POOL {
            break;
        }
        let Some(plane) = best_plane(&pool, &mut random, space) else { break };
        let normal = space.normal([0.0; 2], plane[2], [plane[0], plane[1]]);
        let Some(model) = refit(&pool, plane, normal, center, &alike) else { continue };
        let is_inlier = |s: &Sample| (s.disparity - model.value(s.at)).abs() < INLIER_QUANTA;
        let (inliers, rest): (Vec<_>, Vec<_>) = pool.into_iter().partition(is_inlier);
        pool = rest;
        let extent = Extent::of(&largest_piece(&inliers, grid), normal, grid, space);
        let is_large = extent.area_m2 > LARGE_M2 && extent.longest_m > LONG_M;
        let dominates = surfaces.is_empty()
            && inliers.len() as f64 > DOMINANT_SHARE * everything as f64
            && extent.area_m2 > DOMINANT_M2;
        if is_large || dominates {
            let offset_m = space.distance_m([0.0; 2], plane[2], [plane[0], plane[1]]);
            surfaces.push(StructureSurface { model, normal, offset_m });
        }
    }

    let camera_up = Vec3::from(camera_up).as_dvec3();
    let support = surfaces
        .iter()
        .position(|s| s.normal.dot(camera_up) > UPWARD)
        .or((!surfaces.is_empty()).then_some(0));
    let labels = labelled(&surfaces, disparity, orientation, &alike, params.tolerance_quanta, workspace);
    Structure { surfaces, labels, support }
}

/// Of every pixel the first surface that lies within `tolerance_quanta` of it and is turned as it is, or that has no normal to
/// compare; -1 = none. O(pixels · surfaces); parallel over rows.
fn labelled(
    surfaces: &[StructureSurface],
    disparity: &Raster<f32>,
    orientation: &Orientation,
    alike: &Alike,
    tolerance_quanta: f64,
    workspace: &mut Workspace,
) -> Raster<i32> {
    let width = disparity.width();
    let mut labels = workspace.filled(disparity.len(), Segments::NONE);
    let label_row = |unsure: &mut Vec<i32>, (v, labels): (usize, &mut [i32])| {
        let row = v * width..(v + 1) * width;
        let (disparity, slopes) =
            (&disparity.as_slice()[row.clone()], &orientation.slope.as_slice()[row.clone()]);
        for (s, surface) in surfaces.iter().enumerate() {
            vectorized(
                #[inline(always)]
                || {
                    let stretches = labels.chunks_mut(STRETCH).zip(unsure.chunks_mut(STRETCH));
                    let seen = disparity.chunks(STRETCH).zip(slopes.chunks(STRETCH));
                    for (left, ((labels, unsure), (disparity, slopes))) in
                        (0..).step_by(STRETCH).zip(stretches.zip(seen))
                    {
                        surface.mark_near(labels, disparity, [left, v], tolerance_quanta, unsure);
                        if unsure.iter().fold(0, |any, near| any | near) != 0 {
                            surface.claim(s, labels, slopes, [left, v], alike.slope_squared, unsure);
                        }
                    }
                },
            );
            for u in marked(unsure) {
                let tilt = Tilt::at(row.start + u, orientation);
                let slope = surface.model.slope([u as f64, v as f64]);
                let own = Tilt { normal: surface.normal, slope };
                if tilt.normal == DVec3::ZERO || alike.are(&own, &tilt) {
                    labels[u] = s as i32;
                }
            }
        }
    };
    labels.par_chunks_mut(width).enumerate().for_each_init(|| vec![0; width], label_row);
    disparity.with_data(labels)
}

impl Structure {
    /// The label map of the surfaces alone.
    pub(crate) fn segments(&self) -> Segments {
        Segments::from_numbered(self.labels.clone(), self.surfaces.len())
    }

    /// The surfaces as planes, each fitted to its own pixels. How much is theirs is known in the end:
    /// [`counted`](crate::objectness::outcome::Outcome::counted). O(pixels).
    pub(crate) fn planes(&self, depth_m: &Raster<f32>, camera: &Camera) -> Vec<StructurePlane> {
        let width = depth_m.width();
        let rays: Vec<f64> = (0..width).map(|u| camera.ray(u as f64, 0.0)[0]).collect();
        let mut own = vec![LaneSums::default(); self.surfaces.len()];
        for (run, surface) in runs(&self.labels, 0..depth_m.height()) {
            let (u, v) = (run.start % width, run.start / width);
            let ray_y = camera.ray(0.0, v as f64)[1];
            let rays = &rays[u..u + run.len()];
            vectorized(
                #[inline(always)]
                || own[surface].add(rays, ray_y, &depth_m.as_slice()[run]),
            );
        }
        let own = own.iter().map(LaneSums::total);
        let plane = |(surface, own): (&StructureSurface, PointSums)| {
            let (normal, offset_m) = (surface.normal.as_vec3().to_array(), surface.offset_m as f32);
            own.fitted_plane().unwrap_or(StructurePlane { normal, offset_m, inlier_share: 0.0 })
        };
        self.surfaces.iter().zip(own).map(plane).collect()
    }

    /// One label map of both: first the surfaces, then the segments, which lie where no surface is.
    pub(crate) fn with(&self, segments: &Segments) -> Segments {
        let surfaces = self.surfaces.len();
        let both = self.labels.as_slice().iter().zip(segments.labels().as_slice());
        let label = |(&surface, &segment): (&i32, &i32)| match (surface, segment) {
            (0.., _) => surface,
            (_, 0..) => surfaces as i32 + segment,
            _ => Segments::NONE,
        };
        let labels = self.labels.with_data(both.map(label).collect());
        Segments::from_numbered(labels, surfaces + segments.count())
    }
}

impl StructureSurface {
    /// Marks the pixels, of which the first is at (u, v), that are of no surface yet and lie near this one.
    #[inline(always)]
    fn mark_near(
        &self,
        labels: &[i32],
        disparity: &[f32],
        [u, v]: [usize; 2],
        quanta: f64,
        near: &mut [i32],
    ) {
        for (k, ((near, label), d)) in near.iter_mut().zip(labels).zip(disparity).enumerate() {
            let misfit = f64::from(*d) - self.model.value([(u + k) as f64, v as f64]);
            *near = i32::from((misfit.abs() < quanta) & (*label < 0));
        }
    }

    /// Labels those of the marked pixels whose slope is that of this surface, but for so much, and takes their mark.
    #[inline(always)]
    fn claim(
        &self,
        label: usize,
        labels: &mut [i32],
        slopes: &[[f32; 2]],
        [u, v]: [usize; 2],
        slope_squared: f64,
        near: &mut [i32],
    ) {
        for (k, ((near, own), slope)) in near.iter_mut().zip(labels).zip(slopes).enumerate() {
            let steepness = self.model.slope([(u + k) as f64, v as f64]);
            let is_alike = squared_between(steepness, slope.map(f64::from)) < slope_squared;
            *own = if (*near != 0) & is_alike { label as i32 } else { *own };
            *near &= i32::from(!is_alike);
        }
    }

    /// Height (m) above the surface of what is seen at a pixel with this disparity (quanta), along its normal.
    pub fn height_m(&self, at: [f64; 2], disparity: f64, space: &DisparitySpace) -> f64 {
        let below = self.model.value(at);
        if below < 1.0 {
            return BEYOND_M;
        }
        let ray = DVec3::from(space.camera().ray(at[0], at[1]));
        (space.depth_m(below) - space.depth_m(disparity)) * self.normal.dot(ray).abs()
    }
}

/// Points that are added side by side.
const LANES: usize = 8;

/// Sums over points, each of which adds to one of the lanes.
#[derive(Clone, Default)]
struct LaneSums {
    /// 1, x, y, z, xx, yy, zz, xy, yz, zx.
    sums: [[f64; LANES]; 10],
}

impl LaneSums {
    /// Adds points of one row: those at depths `z_m` along rays with these x, and this y, at a depth of 1.
    #[inline(always)]
    fn add(&mut self, rays_x: &[f64], ray_y: f64, z_m: &[f32]) {
        let mut sums = self.sums;
        let (rays, depths) = (rays_x.chunks_exact(LANES), z_m.chunks_exact(LANES));
        // A depth of 0 adds nothing.
        let (mut last_rays, mut last_depths, mut last_counts) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (lane, (ray, z)) in rays.remainder().iter().zip(depths.remainder()).enumerate() {
            (last_rays[lane], last_depths[lane], last_counts[lane]) = (*ray, *z, 1.0);
        }
        let mut add = |rays: &[f64; LANES], depths: &[f32; LANES], counts: &[f64; LANES]| {
            for lane in 0..LANES {
                let z = f64::from(depths[lane]);
                // Rounded as points are.
                let [x, y] = [rays[lane] * z, ray_y * z].map(|x| f64::from(x as f32));
                let terms = [counts[lane], x, y, z, x * x, y * y, z * z, x * y, y * z, z * x];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    sum[lane] += term;
                }
            }
        };
        for (rays, depths) in rays.zip(depths) {
            if let (Ok(rays), Ok(depths)) = (rays.try_into(), depths.try_into()) {
                add(rays, depths, &[1.0; LANES]);
            }
        }
        add(&last_rays, &last_depths, &last_counts);
        self.sums = sums;
    }

    fn total(&self) -> PointSums {
        let [n, x, y, z, xx, yy, zz, xy, yz, zx] = self.sums.map(|lanes| lanes.iter().sum());
        PointSums::new(n, DVec3::new(x, y, z), DVec3::new(xx, yy, zz), DVec3::new(xy, yz, zx))
    }
}

/// The plane a u + b v + c through three samples that passes near most of them; `None` when it is near to few.
///
/// All planes are drawn first, and voted for in parallel: the first one with the most votes wins, whichever is counted first.
fn best_plane(pool: &[Sample], random: &mut Lcg, space: &DisparitySpace) -> Option<[f64; 3]> {
    let least_triangle = space.area_px(LEAST_TRIANGLE_PX) as f64;
    let mut trial = |_| {
        let [p, q, r] = std::array::from_fn(|_| &pool[random.below(pool.len())]);
        let ([x1, y1], [x2, y2]) = ([0, 1].map(|k| q.at[k] - p.at[k]), [0, 1].map(|k| r.at[k] - p.at[k]));
        let triangle = x1 * y2 - x2 * y1;
        if triangle.abs() < least_triangle {
            return None;
        }
        let (d1, d2) = (q.disparity - p.disparity, r.disparity - p.disparity);
        let a = (d1 * y2 - d2 * y1) / triangle;
        let b = (x1 * d2 - x2 * d1) / triangle;
        let c = p.disparity - a * p.at[0] - b * p.at[1];
        Some([a, b, c])
    };
    let planes: Vec<[f64; 3]> = (0..TRIALS).filter_map(&mut trial).collect();
    let voters: Vec<Voters> = pool.chunks(VOTERS).map(Voters::of).collect();
    let most = AtomicUsize::new(LEAST_VOTES);
    let count = |&plane: &[f64; 3]| {
        let votes = votes(&voters, pool.len(), plane, most.load(Relaxed))?;
        most.fetch_max(votes, Relaxed);
        Some((votes, plane))
    };
    let counted: Vec<Option<(usize, [f64; 3])>> = planes.par_iter().map(count).collect();
    let first_best = |best: (usize, _), next: (usize, _)| if next.0 > best.0 { next } else { best };
    counted.into_iter().flatten().reduce(first_best).map(|(_, plane)| plane)
}

/// How many samples lie near a plane, if they are at least so many; given up when they cannot be any more.
fn votes(voters: &[Voters], mut left: usize, plane: [f64; 3], least: usize) -> Option<usize> {
    let mut votes = 0;
    for voters in voters {
        if votes + left < least {
            return None;
        }
        votes += vectorized(
            #[inline(always)]
            || voters.near(plane),
        );
        left = left.saturating_sub(VOTERS);
    }
    (votes >= least).then_some(votes)
}

/// Samples that are counted together.
const VOTERS: usize = 256;

/// Column, row and disparity of samples, each in a list of its own; those that are missing vote for nothing.
struct Voters {
    u: [f64; VOTERS],
    v: [f64; VOTERS],
    disparity: [f64; VOTERS],
}

impl Voters {
    fn of(pool: &[Sample]) -> Self {
        let mut voters = Self { u: [0.0; VOTERS], v: [0.0; VOTERS], disparity: [f64::NAN; VOTERS] };
        for (k, sample) in pool.iter().enumerate() {
            ([voters.u[k], voters.v[k]], voters.disparity[k]) = (sample.at, sample.disparity);
        }
        voters
    }

    /// How many lie near a plane.
    #[inline(always)]
    fn near(&self, [a, b, c]: [f64; 3]) -> usize {
        let Self { u, v, disparity } = self;
        (0..VOTERS)
            .map(|k| u64::from((disparity[k] - (a * u[k] + b * v[k] + c)).abs() < TRIAL_QUANTA))
            .sum::<u64>() as usize
    }
}

/// The quadratic through the samples near the plane that face the same way; `None` when they are few.
fn refit(
    pool: &[Sample],
    [a, b, c]: [f64; 3],
    normal: DVec3,
    center: [f64; 2],
    alike: &Alike,
) -> Option<Model> {
    let plane = Tilt { normal, slope: [a, b] };
    let mut surface: Option<Model> = None;
    for tolerance in REFIT_QUANTA {
        let value = |at: [f64; 2]| surface.map_or(a * at[0] + b * at[1] + c, |model| model.value(at));
        let mut moments = Moments::about(center);
        for s in pool {
            if (s.disparity - value(s.at)).abs() < tolerance && alike.are(&plane, &s.tilt) {
                moments.add(s.at, s.disparity);
            }
        }
        if moments.count() < LEAST_REFIT as f64 {
            break;
        }
        surface = Some(moments.fit(Basis::Quadratic).model);
    }
    surface
}

/// The samples of the largest connected piece: tops of boxes that happen to be as high as a shelf are no surface.
fn largest_piece(inliers: &[Sample], grid: usize) -> Vec<&Sample> {
    let cell = |s: &Sample| s.at.map(|x| (x / grid as f64) as usize);
    let [columns, rows] = [0, 1].map(|k| inliers.iter().map(|s| cell(s)[k] + 1).max().unwrap_or(0));
    let mut open: Vec<Option<&Sample>> = vec![None; columns * rows];
    for sample in inliers {
        let [u, v] = cell(sample);
        open[u * rows + v] = Some(sample);
    }
    let mut largest = Vec::new();
    for first in 0..open.len() {
        let Some(sample) = open[first].take() else { continue };
        let mut piece = vec![sample];
        let mut around = vec![[first / rows, first % rows]];
        while let Some([u, v]) = around.pop() {
            for u in u.saturating_sub(PIECE_GAP)..columns.min(u + PIECE_GAP + 1) {
                for v in v.saturating_sub(PIECE_GAP)..rows.min(v + PIECE_GAP + 1) {
                    if let Some(sample) = open[u * rows + v].take() {
                        piece.push(sample);
                        around.push([u, v]);
                    }
                }
            }
        }
        if piece.len() > largest.len() {
            largest = piece;
        }
    }
    largest
}

/// How large a surface is.
struct Extent {
    area_m2: f64,
    longest_m: f64,
}

impl Extent {
    fn of(inliers: &[&Sample], normal: DVec3, grid: usize, space: &DisparitySpace) -> Self {
        let camera = space.camera();
        let area_m2 = inliers.iter().map(|s| {
            let p = s.point_m;
            let cosine = (-normal.dot(p) / p.length()).max(LEAST_COSINE);
            (grid * grid) as f64 * p.z * p.z / (camera.fx_px * camera.fy_px) / cosine
        });
        let width_m = |axis: DVec3| {
            let mut along: Vec<f64> = inliers.iter().map(|s| s.point_m.dot(axis)).collect();
            element_at(&mut along, 0.95) - element_at(&mut along, 0.05)
        };
        let [t1, t2] = tangents(normal);
        Self { area_m2: area_m2.sum(), longest_m: width_m(t1).max(width_m(t2)) }
    }
}

/// Two unit vectors along a plane, at right angles.
pub(crate) fn tangents(normal: DVec3) -> [DVec3; 2] {
    let along = DVec3::new(normal.y, -normal.x, 0.0).try_normalize().unwrap_or(DVec3::X);
    [along, normal.cross(along)]
}

/// The element that this share of the values lie below; reorders them. 0 of no values. O(n).
pub(crate) fn element_at(values: &mut [f64], share: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let place = ((share * values.len() as f64) as usize).min(last);
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Cosine of an angle in degrees, the same on every platform.
fn cosine(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::frame::Frame;
    use crate::surface::plane_fit::plane_fits;
    use crate::surface::window_choice::orientation;
    use crate::testing::{raster, space};

    const SIZE: (usize, usize) = (320, 240);

    /// A camera at half the resolution of a Kinect.
    fn half() -> DisparitySpace {
        space([262.5, 262.5], [159.5, 119.5])
    }

    /// The structure of what is seen at these depths (m), in whole quanta as a Kinect sees it.
    fn seen(depth_m: impl Fn(usize) -> f64) -> Structure {
        seen_with(&params::Structure::default(), depth_m)
    }

    fn seen_with(params: &params::Structure, depth_m: impl Fn(usize) -> f64) -> Structure {
        let space = half();
        let quantised = |i: usize| {
            let depth = Raster::filled(1, 1, depth_m(i) as f32).unwrap();
            space.depth_m(f64::from(space.disparity(&depth)[0]).round()) as f32
        };
        let depth = Raster::from_vec(SIZE.0, SIZE.1, (0..SIZE.0 * SIZE.1).map(quantised).collect()).unwrap();
        let frame = Frame::new(depth.clone(), None, space.camera());
        let points = frame.map_or_else(|_| depth.map(|_| [f32::NAN; 3]), |frame| frame.points_m());
        let workspace = &mut Workspace::default();
        let disparity = space.disparity(&depth);
        let fits = plane_fits(&disparity, 2, workspace);
        let orientation = orientation(&disparity, &fits, &space, &params::LocalFit::default(), workspace);
        structure(&disparity, &fits, &orientation, &points, &space, [0.0, -1.0, 0.0], params, workspace)
    }

    proptest! {
        #[test]
        fn each_pixel_is_of_the_first_surface_it_lies_on(
            pixels in (1_usize..40, 1_usize..4).prop_flat_map(|size| raster(size, (
                // Near the surfaces below, and none.
                prop_oneof![9 => 97.0_f32..106.0, 1 => Just(f32::NAN)],
                prop::array::uniform2(-0.4_f32..0.4),
                // Turned like them or not, and none.
                prop::sample::select(vec![[0.0, 0.0, -1.0], [0.0, -0.6, -0.8], [1.0, 0.0, 0.0], [0.0; 3]]),
            ))),
            slope_squared in 0.0_f64..0.2,
        ) {
            let disparity = pixels.map(|p| p.0);
            let orientation = Orientation { slope: pixels.map(|p| p.1), normal: pixels.map(|p| p.2) };
            let surface = |middle: f64, normal: [f64; 3]| {
                let mut moments = Moments::about([0.0; 2]);
                for at in [[0.0, 0.0], [40.0, 0.0], [0.0, 4.0]] {
                    moments.add(at, middle + 0.1 * at[0] - 0.05 * at[1]);
                }
                let model = moments.fit(Basis::Plane).model;
                StructureSurface { model, normal: normal.into(), offset_m: 1.0 }
            };
            let surfaces = [surface(100.0, [0.0, 0.0, -1.0]), surface(103.0, [0.0, -0.6, -0.8])];
            let alike = Alike { least_cosine: 0.9, slope_squared };
            let labels = labelled(&surfaces, &disparity, &orientation, &alike, 2.0, &mut Workspace::default());
            let width = disparity.width();
            for i in 0..disparity.len() {
                let at = position(i, width);
                let tilt = Tilt::at(i, &orientation);
                let lies_on = |s: &StructureSurface| {
                    let own = Tilt { normal: s.normal, slope: s.model.slope(at) };
                    (f64::from(disparity[i]) - s.model.value(at)).abs() < 2.0
                        && (tilt.normal == DVec3::ZERO || alike.are(&own, &tilt))
                };
                let expected = surfaces.iter().position(lies_on).map_or(-1, |s| s as i32);
                prop_assert_eq!(labels[i], expected);
            }
        }
    }

    /// The depth of the plane normal · X = -offset along the ray of a pixel.
    fn plane(i: usize, normal: DVec3, offset_m: f64) -> f64 {
        let [u, v] = position(i, SIZE.0);
        -offset_m / normal.dot(DVec3::from(half().camera().ray(u, v)))
    }

    /// A table 0.6 m below a camera that looks down by 37 degrees, and a wall behind it.
    fn table_normal() -> DVec3 {
        DVec3::new(0.0, -0.8, -0.6)
    }

    const WALL: DVec3 = DVec3::new(0.0, 0.6, -0.8);

    fn table_and_wall(i: usize) -> f64 {
        let positive = |z: f64| if z > 0.0 { z } else { f64::INFINITY };
        positive(plane(i, table_normal(), 0.6)).min(positive(plane(i, WALL, 1.0)))
    }

    #[test]
    fn votes_are_given_up_only_below_the_least() {
        let sample = |k: usize| Sample {
            at: position(k, 40),
            disparity: 300.0 + (k % 7) as f64,
            point_m: DVec3::ZERO,
            tilt: Tilt { normal: DVec3::ZERO, slope: [0.0; 2] },
        };
        let pool: Vec<Sample> = (0..3 * VOTERS + 17).map(sample).collect();
        let voters: Vec<Voters> = pool.chunks(VOTERS).map(Voters::of).collect();
        for plane in [[0.0, 0.0, 303.0], [0.1, -0.05, 300.0], [0.0, 0.0, 500.0]] {
            let near = |s: &&Sample| {
                let [u, v] = s.at;
                (s.disparity - (plane[0] * u + plane[1] * v + plane[2])).abs() < TRIAL_QUANTA
            };
            let all = pool.iter().filter(near).count();
            assert_eq!(votes(&voters, pool.len(), plane, all), Some(all), "as many as the best so far");
            assert_eq!(votes(&voters, pool.len(), plane, 0), Some(all));
            assert_eq!(votes(&voters, pool.len(), plane, all + 1), None);
        }
    }

    #[test]
    fn a_table_and_a_wall_are_found() {
        let found = seen(table_and_wall);
        let [first, second] = &found.surfaces[..] else { panic!("two surfaces: {:?}", found.surfaces) };
        let is_table = |s: &StructureSurface| s.normal.dot(table_normal()) > 0.9;
        let (table, wall) = if is_table(first) { (first, second) } else { (second, first) };
        assert!(table.normal.dot(table_normal()) > 0.999 && (table.offset_m - 0.6).abs() < 0.01, "{table:?}");
        assert!(wall.normal.dot(WALL) > 0.999 && (wall.offset_m - 1.0).abs() < 0.02, "{wall:?}");
        assert_eq!(found.support, Some(usize::from(!is_table(first))), "the table faces up");
        let labelled = found.labels.as_slice().iter().filter(|&&label| label >= 0).count();
        assert!(labelled as f64 > 0.97 * found.labels.len() as f64, "{labelled}");
        let top = found.labels[SIZE.0 / 2];
        assert!(std::ptr::eq(&found.surfaces[top as usize], wall), "the wall is above the table");
    }

    /// A wall 3 m away, of which noise as wide as a window makes waves of 12 mm, came to pieces.
    #[test]
    fn a_far_wall_is_one_surface() {
        let quantum_per_m = params::Sensor::default().disparity_quantum_per_m;
        let waves = |i: usize| {
            let [u, v] = position(i, SIZE.0);
            1.0 / (1.0 / 3.0 + 0.5 * quantum_per_m * (libm::sin(0.9 * u) + libm::cos(0.8 * v)))
        };
        let share_on_it = |params| {
            let found = seen_with(&params, waves);
            let on_it = found.labels.as_slice().iter().filter(|&&label| label == 0).count();
            on_it as f64 / found.labels.len() as f64
        };
        let by_normals_alone = params::Structure { slope_quanta_per_px: 0.0, ..Default::default() };
        let (with_slopes, without) =
            (share_on_it(params::Structure::default()), share_on_it(by_normals_alone));
        assert!(with_slopes > 0.95 && without < 0.8, "{with_slopes} {without}");
    }

    /// Tops of boxes as high as a shelf passed for one large plane, and were lost.
    #[test]
    fn what_does_not_hang_together_is_no_surface() {
        let [floor_m, tops_m] = [2.0, 1.7];
        let columns =
            |i: usize, least: usize| (i % SIZE.0 % 80) >= least && (60..180).contains(&(i / SIZE.0));
        let level = |least: usize| move |i: usize| if columns(i, least) { tops_m } else { floor_m };
        let apart = seen(level(50));
        let touching = seen(level(0));
        let on_top = |found: &Structure| found.labels.as_slice().iter().filter(|&&label| label == 1).count();
        assert_eq!(apart.surfaces.len(), 1, "four tops of 0.19 m by 0.78 m: {:?}", apart.surfaces);
        assert_eq!((touching.surfaces.len(), on_top(&touching) > 30_000), (2, true), "one shelf");
    }

    #[test]
    fn heights_are_above_the_surface_it_is_supported_by() {
        let found = seen(|i| plane(i, table_normal(), 0.6));
        let (space, table) = (half(), &found.surfaces[found.support.unwrap()]);
        for i in [20_000, 40_000, 60_000] {
            for height_m in [0.0, 0.02, 0.1] {
                let z = plane(i, table_normal(), 0.6 - height_m);
                let d = 1.0 / (z * params::Sensor::default().disparity_quantum_per_m);
                let got = table.height_m(position(i, SIZE.0), d, &space);
                assert!((got - height_m).abs() < 0.003, "{got} {height_m}");
            }
        }
        let horizon = [160.0, -1e4];
        assert_eq!(table.height_m(horizon, 300.0, &space), BEYOND_M);
    }

    #[test]
    fn nothing_is_found_in_nothing_and_in_noise() {
        let nothing = seen(|_| f64::NAN);
        assert!(nothing.surfaces.is_empty() && nothing.support.is_none());
        assert!(nothing.labels.as_slice().iter().all(|&label| label == -1));
        let mut random = Lcg::new(5);
        let noise: Vec<f64> = (0..SIZE.0 * SIZE.1).map(|_| 0.5 + random.below(1000) as f64 / 500.0).collect();
        let found = seen(|i| noise[i]);
        assert!(found.surfaces.is_empty(), "{:?}", found.surfaces);
        // A plate of 10 cm is no structure of anything larger.
        let plate = |i: usize| (i % SIZE.0).abs_diff(160) < 15 && (i / SIZE.0).abs_diff(120) < 15;
        assert!(seen(|i| if plate(i) { 1.0 } else { noise[i] }).surfaces.is_empty());
    }

    #[test]
    fn a_pixel_without_a_normal_may_lie_on_a_surface() {
        // Alone in a hole of 9 x 9 pixels, which no window spans.
        let far = |i: usize| (i % SIZE.0).abs_diff(100).max((i / SIZE.0).abs_diff(100));
        let found = seen(|i| if (1..5).contains(&far(i)) { f64::NAN } else { plane(i, table_normal(), 0.6) });
        assert_eq!([100, 101].map(|u| found.labels[100 * SIZE.0 + u]), [0, -1]);
    }

    #[test]
    fn a_small_plane_is_structure_when_it_holds_most_of_what_is_seen() {
        let plate = |half_px: usize| {
            move |i: usize| {
                let is_plate = (i % SIZE.0).abs_diff(160) < half_px && (i / SIZE.0).abs_diff(120) < half_px;
                if is_plate { 1.0 } else { f64::NAN }
            }
        };
        // At 1 m 60 pixels are 23 cm: 0.052 m^2; 40 pixels 15 cm: 0.023 m^2.
        assert_eq!(seen(plate(30)).surfaces.len(), 1);
        assert_eq!(seen(plate(20)).surfaces.len(), 0);
    }

    #[test]
    fn the_structure_is_the_same_on_any_number_of_threads() {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| seen(table_and_wall));
            (found.labels.clone(), format!("{:?} {:?}", found.surfaces, found.support))
        };
        assert!([2, 8].into_iter().all(|threads| on(threads) == on(1)));
    }

    proptest! {
        #[test]
        fn an_element_is_that_of_the_sorted_values(
            mut values in prop::collection::vec(-5.0_f64..5.0, 0..30),
            share in 0.0_f64..=1.0,
        ) {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let place = (share * sorted.len() as f64).floor() as usize;
            let expected = sorted.get(place).or(sorted.last()).copied().unwrap_or(0.0);
            prop_assert_eq!(element_at(&mut values, share), expected);
        }

        #[test]
        fn squares_below_the_least_are_those_of_shorter_lengths(length in 0.0_f64..3.0, steps in -4_i64..5) {
            let near = f64::from_bits(((length * length).to_bits() as i64).saturating_add(steps).max(0) as u64);
            prop_assert_eq!(near < least_square(length), near.sqrt() < length);
        }

        #[test]
        fn lanes_add_what_points_do(depths_m in prop::collection::vec(0.3_f32..4.0, 0..40), v in 0_usize..480) {
            let camera = half().camera();
            let rays: Vec<f64> = (0..depths_m.len()).map(|u| camera.ray(u as f64, 0.0)[0]).collect();
            let (mut lanes, mut expected) = (LaneSums::default(), [0.0; 10]);
            lanes.add(&rays, camera.ray(0.0, v as f64)[1], &depths_m);
            for (u, &z_m) in depths_m.iter().enumerate() {
                let [x, y, z] = camera.back_project(u, v, z_m).map(f64::from);
                let terms = [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x];
                expected.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
            for (got, expected) in lanes.sums.iter().zip(expected) {
                prop_assert!((got.iter().sum::<f64>() - expected).abs() < 1e-9, "{:?} {}", got, expected);
            }
        }

        #[test]
        fn tangents_lie_in_the_plane(normal in prop::array::uniform3(-1.0_f64..1.0)) {
            for normal in [DVec3::from(normal).normalize_or(DVec3::Z), DVec3::Z, DVec3::NEG_Y] {
                let [s, t] = tangents(normal);
                let dots = [s.dot(t), s.dot(normal), t.dot(normal), s.length() - 1.0, t.length() - 1.0];
                prop_assert!(dots.iter().all(|dot| dot.abs() < 1e-9), "{normal}: {s} {t}");
            }
        }
    }
}
