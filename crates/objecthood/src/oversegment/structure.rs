//! Structure planes: large surfaces that carry or enclose the objects (docs/CONTEXT.md 1.1).
//!
//! They are taken out first: they are support and background, they say what "up" and "height" are, and every later
//! stage is cheaper without them.

mod extent;
mod labels;
mod planes;
mod tilt;
mod trials;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use self::extent::Extent;
use self::labels::labelled;
use self::planes::fit_planes;
use self::tilt::{Alike, Tilt, least_square};
use self::trials::best_plane;
use crate::params;
use crate::planes::StructurePlane;
use crate::random::Lcg;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::moments::{Basis, Model, Moments};
use crate::surface::plane_fit::PlaneFits;
use crate::surface::surfaces::Surfaces;
use crate::surface::window_choice::Orientation;

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
    /// Every surface as a plane, fitted to its own pixels.
    pub planes: Vec<StructurePlane>,
}

/// Every so many columns and rows one pixel is looked at (px at a focal length of 525 px).
const GRID_PX: usize = 6;
/// So many surfaces are looked for: a room has a table, a floor, walls, shelves.
const ROUNDS: usize = 8;
/// With fewer pixels left on the grid nothing is looked for.
const LEAST_POOL: usize = 150;
/// Fitted again to pixels nearer than this to the plane, then to the surface (quanta).
const REFIT_QUANTA: [f64; 3] = [3.5, 3.0, 3.0];
/// To at least so many.
const LEAST_REFIT: usize = 50;
/// Nearer than this pixels are taken out with the surface (quanta).
const INLIER_QUANTA: f64 = 3.0;
/// A surface this large ...
const LARGE_M2: f64 = 0.18;
/// ... and this long is structure;
const LONG_M: f64 = 0.5;
/// and the first one already if it holds this share of the pixels ...
const DOMINANT_SHARE: f64 = 0.2;
/// ... and has this area.
const DOMINANT_M2: f64 = 0.03;
/// A surface whose normal has more than this upwards is one to stand on.
pub(crate) const UPWARD: f64 = 0.3;
/// What lies in front of a surface that is behind the horizon stands as high as this (m).
const BEYOND_M: f64 = 10.0;

/// A pixel of the grid.
struct Sample {
    pixel: usize,
    at: [f64; 2],
    disparity: f64,
}

/// What may be structure, and the samples near it.
struct Candidate {
    surface: StructureSurface,
    inliers: Vec<Sample>,
}

/// What is looked at.
struct Seen<'a> {
    disparity: &'a Raster<f32>,
    orientation: &'a Orientation,
    depth_m: &'a Raster<f32>,
    space: &'a DisparitySpace,
    /// Columns and rows from one sample to the next.
    grid: usize,
    alike: Alike,
}

/// Finds the structure of a scene.
///
/// RANSAC (Fischler and Bolles 1981) with fixed random numbers over a grid of pixels; the best plane is refitted as a
/// quadratic and kept when it is large. `camera_up`: the camera's own up, see [`camera_up`](crate::support::gravity::camera_up). O(rounds · trials · pixels / 36).
pub fn find_structure(
    depth_m: &Raster<f32>,
    found: &Surfaces,
    camera_up: [f32; 3],
    params: &params::Structure,
) -> Structure {
    let Surfaces { space, disparity, fits, orientation, .. } = found;
    let alike = Alike {
        least_cosine: cosine(params.angle_deg),
        slope_squared: least_square(space.slope_per_px(params.slope_quanta_per_px)),
    };
    let seen = Seen { disparity, orientation, depth_m, space, grid: space.length_px(GRID_PX), alike };
    let pool = seen.samples(fits);
    let everything = pool.len();
    let candidates = seen.candidates(pool);
    let extents: Vec<Extent> = candidates.par_iter().map(|candidate| Extent::of(candidate, &seen)).collect();
    let mut surfaces = Vec::new();
    for (Candidate { surface, inliers }, extent) in candidates.into_iter().zip(extents) {
        let is_large = extent.area_m2 > LARGE_M2 && extent.longest_m > LONG_M;
        let dominates = surfaces.is_empty()
            && inliers.len() as f64 > DOMINANT_SHARE * everything as f64
            && extent.area_m2 > DOMINANT_M2;
        if is_large || dominates {
            surfaces.push(surface);
        }
    }
    let camera_up = Vec3::from(camera_up).as_dvec3();
    let support = surfaces
        .iter()
        .position(|s| s.normal.dot(camera_up) > UPWARD)
        .or((!surfaces.is_empty()).then_some(0));
    let labels = labelled(&surfaces, disparity, orientation, &seen.alike, params.tolerance_quanta);
    let planes = fit_planes(&surfaces, &labels, depth_m, &space.camera());
    Structure { surfaces, labels, support, planes }
}

impl Structure {
    /// The label map of the surfaces alone.
    pub(crate) fn segments(&self) -> Segments {
        Segments::from_numbered(self.labels.clone(), self.surfaces.len())
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

impl Seen<'_> {
    /// The pixels of the grid through whose surroundings there is a plane.
    fn samples(&self, fits: &PlaneFits) -> Vec<Sample> {
        let (width, height) = self.disparity.size();
        let rows = (self.grid / 3..height).step_by(self.grid);
        let pixels = rows.flat_map(|v| (self.grid / 3..width).step_by(self.grid).map(move |u| v * width + u));
        let sample = |pixel: usize| Sample {
            pixel,
            at: position(pixel, width),
            disparity: f64::from(self.disparity[pixel]),
        };
        pixels.filter(|&pixel| fits.at(pixel).is_some()).map(sample).collect()
    }

    /// The surfaces near most samples, each with those that are near no surface before it.
    fn candidates(&self, mut pool: Vec<Sample>) -> Vec<Candidate> {
        let mut random = Lcg::new(12345);
        let mut candidates = Vec::new();
        for _ in 0..ROUNDS {
            if pool.len() <= LEAST_POOL {
                break;
            }
            let Some([a, b, c]) = best_plane(&pool, &mut random, self.space) else { break };
            let normal = self.space.normal([0.0; 2], c, [a, b]);
            let Some(model) = self.refit(&pool, [a, b, c], normal) else { continue };
            let offset_m = self.space.distance_m([0.0; 2], c, [a, b]);
            let is_inlier = |s: &mut Sample| (s.disparity - model.value(s.at)).abs() < INLIER_QUANTA;
            let inliers = pool.extract_if(.., is_inlier).collect();
            candidates.push(Candidate { surface: StructureSurface { model, normal, offset_m }, inliers });
        }
        candidates
    }

    /// The quadratic through the samples near the plane that face the same way; `None` when they are few.
    fn refit(&self, pool: &[Sample], [a, b, c]: [f64; 3], normal: DVec3) -> Option<Model> {
        let (width, height) = self.disparity.size();
        let center = [(width / 2) as f64, (height / 2) as f64];
        let plane = Tilt { normal, slope: [a, b] };
        let mut surface: Option<Model> = None;
        for tolerance in REFIT_QUANTA {
            let value = |at: [f64; 2]| surface.map_or(a * at[0] + b * at[1] + c, |model| model.value(at));
            let mut moments = Moments::about(center);
            for s in pool {
                if (s.disparity - value(s.at)).abs() < tolerance
                    && self.alike.are(&plane, &Tilt::at(s.pixel, self.orientation))
                {
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
}

/// Cosine of an angle in degrees, the same on every platform.
fn cosine(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::plane_fit::plane_fits;
    use crate::surface::window_choice::orientation;
    use crate::testing::space;

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
        let disparity = space.disparity(&depth);
        let fits = plane_fits(&disparity, 2);
        let orientation = orientation(&disparity, &fits, &space, &params::LocalFit::default());
        let surfaces = Surfaces { space, disparity, fits, orientation };
        find_structure(&depth, &surfaces, [0.0, -1.0, 0.0], params)
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
}
