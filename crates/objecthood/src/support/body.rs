//! Bodies: regions described against gravity, by their heights, their place in the plan view and their tilt.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use crate::planes::StructurePlane;
use crate::quantile::element_at;
use crate::raster::Raster;
use crate::simd::{extend_where, vectorized};
use crate::support::cell::{CELL_M, Cell, Cells};
use crate::support::pixel_block::{BLOCK_PX, PixelBlock, RegionExtent};
use crate::support::plan::{DIRECTIONS, FORESHORTENED, Plan};
use crate::support::scene::SupportScene;
use crate::surface::disparity::DisparitySpace;

/// Heights that differ by less than this (m) count as equal: 1 cm, as in the default of `height.min_top_m`. Beyond 1.9 m the sensor
/// does not resolve this, and the limit is [`LEVEL_QUANTA`].
const LEVEL_M: f64 = 0.01;
/// Heights within this many quanta count as equal: a foot, the 2nd percentile of heights, lies two standard deviations of depth too
/// low, each half a quantum.
const LEVEL_QUANTA: f64 = 1.0;
/// A plane can carry things when its normal has a larger component along up.
const UPWARD: f64 = 0.3;
/// A pixel of structure that is farther above or below its plane (m) is none of it: floors are bent and bumpy, but no more than that.
const STRAY_M: f64 = 0.1;
/// Number of directions into which the surroundings of a place are divided.
pub(crate) const SECTORS: usize = 12;
/// The foot of a thing is this quantile of its heights: single noisy pixels lie low anywhere.
const FOOT_SHARE: f64 = 0.02;
/// The top of a thing is this quantile of its heights.
const TOP_SHARE: f64 = 0.98;
/// A face whose normal has a larger component along up (within 25 degrees of level) is a top and no side.
const TOP_FACE: f64 = 0.9;
/// Sides are tilted alike when the sines of their tilts differ by at most this: 9 degrees, the noise of normals of small faces.
const ALIKE: f64 = 0.15;
/// A side whose normal has a smaller component along up (within 8 degrees of upright) does not lean.
const LEAST_TILT: f64 = 0.14;
/// Least share of a leaning thing's tilted pixels that are tilted alike: a board has it, a ball or a rounded edge has not.
const LEAST_ALIKE: f64 = 0.6;
/// Least share of all pixels of a leaning thing that are tilted alike.
const LEAST_TILTED: f64 = 0.2;
/// Least length (m) of a leaning face up its slope: handles and cables are shorter.
const LEAST_SLOPE_M: f64 = 0.07;
/// Least area (m²) of a leaning face: slivers of a bowl's wall are smaller.
const LEAST_FACE_M2: f64 = 0.004;

/// A region described against gravity. Foot, top, normal, cells and tilt are measured for things only, not for structure.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    /// Its first pixel. It breaks ties, because region numbers may differ between label maps.
    pub(crate) first: usize,
    /// Pixels with depth.
    pub(crate) size_px: usize,
    /// Mean height (m).
    pub(crate) mean_m: f64,
    /// Height of its lowest visible part (m).
    pub(crate) foot_m: f64,
    /// Height of its highest part (m).
    pub(crate) top_m: f64,
    /// Heights that differ by less than this (m) count as equal at its depth.
    pub(crate) level_m: f64,
    /// Mean of its unit normals: the more the region bends, the shorter it is. Zero without normals.
    pub(crate) normal: DVec3,
    /// Mean place (m).
    pub(crate) middle_m: DVec2,
    /// Its outline in the plan view: the farthest reach in each of the [`DIRECTIONS`] (m).
    reach_m: [f64; DIRECTIONS],
    /// Its heights, cell by cell.
    cells: Cells,
    /// The pixels that are level with its lowest visible part.
    pub(crate) foot: Vec<u32>,
    /// The tilt of its sides, if they are one flat and tilted face.
    pub(crate) tilt: Option<Tilt>,
}

/// The tilt of a flat thing that leans.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    /// Unit vector in the plan view from its foot to its top.
    pub(crate) toward: DVec2,
    /// Share of its tilted pixels that are tilted alike.
    pub(crate) alike: f64,
}

/// The bodies of a scene.
pub(crate) struct Bodies<'a> {
    pub(crate) plan: Plan,
    /// One for each region.
    pub(crate) all: Vec<Body>,
    /// The planes of the structure, which are the first regions; the other regions are things.
    pub(crate) planes: &'a [StructurePlane],
}

impl<'a> Bodies<'a> {
    /// Measures the bodies of a scene. Pixels without depth do not count. O(pixels + n log n) for n pixels of things; parallel over
    /// regions.
    pub(crate) fn new(scene: &SupportScene<'a>) -> Self {
        let plan = Plan::new(scene.up);
        let view = View { points_m: scene.points_m, normals: scene.normals, plan: &plan, space: scene.space };
        let body = |region, runs: &[_]| Body::of(runs, region >= scene.planes.len(), view);
        let all = scene.regions.runs_of_each().map(body);
        Self { plan, all, planes: scene.planes }
    }

    /// The things: regions outside the structure that have points.
    pub(crate) fn things(&self) -> impl Iterator<Item = usize> + '_ {
        (self.planes.len()..self.all.len()).filter(|&region| self.all[region].size_px > 0)
    }

    /// Whether a plane faces up, so that something can stand on it.
    pub(crate) fn faces_up(&self, plane: &StructurePlane) -> bool {
        self.plan.upward(plane.normal) > UPWARD
    }

    /// Whether something can stand on a region near a place: the region ends upwards there, at or below a height (m). A plane does if it lies
    /// about there: at the edge of a thing, pixels of the floor have the depth of the thing.
    pub(crate) fn ends_at(&self, region: usize, place_m: DVec2, below_m: f64) -> bool {
        match self.planes.get(region) {
            Some(plane) => {
                self.faces_up(plane) && (below_m - self.height_of_m(plane, place_m)).abs() <= STRAY_M
            }
            None => self.top_near_m(region, place_m).is_none_or(|top_m| top_m <= below_m),
        }
    }

    /// Whether the outline of a region holds a place in the plan view.
    pub(crate) fn holds(&self, region: usize, place_m: DVec2) -> bool {
        let reach_m = self.all[region].reach_m.iter();
        self.plan
            .directions
            .iter()
            .zip(reach_m)
            .all(|(direction, reach_m)| place_m.dot(*direction) <= *reach_m)
    }

    /// Height of a thing (m) at a place and about 1 cm around it; `None` where no part of it is seen.
    pub(crate) fn top_near_m(&self, region: usize, place_m: DVec2) -> Option<f64> {
        self.all[region].cells.top_near_m(place_m)
    }

    /// Greatest length of a region in the plan view (m).
    pub(crate) fn length_m(&self, region: usize) -> f64 {
        let reach_m = &self.all[region].reach_m;
        let lengths_m = (0..DIRECTIONS).map(|k| reach_m[k] + reach_m[(k + DIRECTIONS / 2) % DIRECTIONS]);
        lengths_m.fold(0.0, f64::max)
    }

    /// Overlap of the outlines of two regions in the plan view (m): the shortest shift along any of the [`DIRECTIONS`] that separates
    /// them.
    pub(crate) fn overlap_m(&self, a: usize, b: usize) -> f64 {
        let [a, b] = [a, b].map(|region| &self.all[region].reach_m);
        let apart = (0..DIRECTIONS).map(|k| a[k] + b[(k + DIRECTIONS / 2) % DIRECTIONS]);
        apart.fold(f64::INFINITY, f64::min)
    }

    /// Height of a plane at a place (m).
    pub(crate) fn height_of_m(&self, plane: &StructurePlane, place_m: DVec2) -> f64 {
        let [x, y] = self.plan.across.map(|axis| axis.as_vec3());
        let at_zero = x * place_m.x as f32 + y * place_m.y as f32;
        let distance_m = Vec3::from(plane.normal).dot(at_zero) + plane.offset_m;
        -f64::from(distance_m) / self.plan.upward(plane.normal)
    }

    /// The number of [`SECTORS`] around a place in which a region is seen above a height (m).
    pub(crate) fn sectors_above(&self, region: usize, place_m: DVec2, height_m: f64) -> usize {
        let mut seen = [false; SECTORS];
        for (cell, _) in self.all[region].cells.iter().filter(|of_cell| of_cell.1 > height_m) {
            let [x, y] = cell.place();
            let way = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * CELL_M - place_m;
            let turn = libm::atan2(way.y, way.x) / std::f64::consts::TAU + 0.5;
            seen[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
        }
        seen.into_iter().filter(|&seen| seen).count()
    }
}

impl Body {
    /// The body of the pixels in these runs along rows.
    fn of(runs: &[Range<usize>], is_thing: bool, view: View<'_>) -> Self {
        let most = if is_thing { runs.iter().map(ExactSizeIterator::len).sum() } else { 0 };
        let mut extent = RegionExtent::new();
        let mut details = Details::with_room(most);
        let mut survey = |block: &mut PixelBlock| {
            block.survey(view.plan, &mut extent);
            if is_thing {
                details.add(block, view.normals.as_slice(), view.plan);
            }
        };
        let mut block = PixelBlock::new();
        for run in runs {
            block.take(run.clone(), view.points_m.as_slice(), &mut survey);
        }
        survey(&mut block);
        let Some(first) = extent.first else { return Self::default() };
        let mut body = Self {
            first: first as usize,
            size_px: extent.size_px,
            mean_m: extent.mean_m(),
            level_m: view.space.step_m(LEVEL_QUANTA, extent.depth_m()).max(LEVEL_M),
            middle_m: extent.middle_m(),
            reach_m: extent.reach_m,
            ..Self::default()
        };
        body.add_details(details, view);
        body
    }

    /// Adds the measurements that need the single pixels of a thing.
    fn add_details(&mut self, details: Details, view: View<'_>) {
        let mut heights_m = details.heights_m.clone();
        self.foot_m = element_at(&mut heights_m, FOOT_SHARE);
        self.top_m = element_at(&mut heights_m, TOP_SHARE);
        let is_foot = |&(_, height_m): &(&u32, &f64)| *height_m < self.foot_m + self.level_m;
        self.foot = details.pixels.iter().zip(&details.heights_m).filter(is_foot).map(|(&i, _)| i).collect();
        self.normal = details.normal / f64::from(details.normals.max(1));
        self.cells = Cells::new(details.heights_m, &details.runs);
        self.tilt = Tilt::of(&details.tilted, self.size_px, view);
    }
}

/// The inputs from which bodies are computed.
#[derive(Clone, Copy)]
struct View<'a> {
    points_m: &'a Raster<[f32; 3]>,
    normals: &'a Raster<[f32; 3]>,
    plan: &'a Plan,
    space: &'a DisparitySpace,
}

/// The single pixels of a thing.
#[derive(Default)]
struct Details {
    /// Every pixel, in scan order.
    pixels: Vec<u32>,
    /// Its height (m).
    heights_m: Vec<f64>,
    /// Runs of successive points in one cell of the plan view: the cell, and the first point.
    runs: Vec<(Cell, u32)>,
    /// Sum of the normals, and their number.
    normal: DVec3,
    normals: u32,
    tilted: Vec<TiltedPixel>,
}

/// A pixel of a tilted side.
#[derive(Clone, Copy, Default)]
struct TiltedPixel {
    pixel: u32,
    /// The component of its normal along up.
    upward: f64,
    height_m: f64,
}

impl Details {
    /// Nothing yet, with room for `count` pixels.
    fn with_room(count: usize) -> Self {
        Self { pixels: Vec::with_capacity(count), heights_m: Vec::with_capacity(count), ..Self::default() }
    }

    /// Adds a surveyed block.
    fn add(&mut self, block: &PixelBlock, normals: &[[f32; 3]], plan: &Plan) {
        let (pixels, heights_m) = (block.pixels(), block.heights_m());
        let cells = block.cells();
        let mut is_start = [false; BLOCK_PX];
        is_start[0] = self.runs.last().is_none_or(|run| run.0 != cells[0]);
        (1..BLOCK_PX).for_each(|k| is_start[k] = cells[k] != cells[k - 1]);
        let starts = cells.into_iter().zip(self.heights_m.len() as u32..);
        extend_where::<BLOCK_PX, _>(&mut self.runs, starts.zip(is_start).take(pixels.len()));
        self.pixels.extend(pixels);
        self.heights_m.extend(heights_m);

        let mut own = [[0.0; 3]; BLOCK_PX];
        own.iter_mut().zip(pixels).for_each(|(own, &pixel)| *own = normals[pixel as usize]);
        let (mut upward, mut is_side) = ([0.0; BLOCK_PX], [false; BLOCK_PX]);
        self.normals += vectorized(
            #[inline(always)]
            || {
                let mut count = 0;
                for k in 0..BLOCK_PX {
                    upward[k] = plan.upward(own[k]);
                    is_side[k] = (upward[k] < TOP_FACE) & (upward[k].abs() > LEAST_TILT);
                    let [x, y, z] = own[k];
                    count += u32::from((x != 0.0) | (y != 0.0) | (z != 0.0));
                }
                count
            },
        );
        // A missing normal is zero and adds nothing.
        self.normal = own[..pixels.len()].iter().fold(self.normal, |sum, &n| sum + Vec3::from(n).as_dvec3());
        let sides = pixels.iter().zip(heights_m).zip(upward).zip(is_side);
        let sides = sides.map(|(((&pixel, &height_m), upward), is_side)| {
            (TiltedPixel { pixel, upward, height_m }, is_side)
        });
        extend_where::<BLOCK_PX, _>(&mut self.tilted, sides);
    }
}

impl Tilt {
    /// The tilt of a thing of `size_px` pixels, if enough of its tilted pixels are tilted alike and their face is long and large enough.
    fn of(tilted: &[TiltedPixel], size_px: usize, view: View<'_>) -> Option<Self> {
        let mut upward: Vec<f64> = tilted.iter().map(|side| side.upward).collect();
        let middle = element_at(&mut upward, 0.5);
        let alike: Vec<_> = tilted.iter().filter(|side| (side.upward - middle).abs() <= ALIKE).collect();
        let share = alike.len() as f64 / upward.len().max(1) as f64;
        if share < LEAST_ALIKE || (alike.len() as f64) < LEAST_TILTED * size_px as f64 {
            return None;
        }
        let at = |raster: &Raster<[f32; 3]>, side: &TiltedPixel| raster[side.pixel as usize];
        let outward: DVec2 = alike.iter().map(|side| view.plan.place_m(at(view.normals, side))).sum();
        // A side that faces up leans away from its own direction.
        let toward = (-middle.signum() * outward).try_normalize()?;
        let mut heights_m: Vec<f64> = alike.iter().map(|side| side.height_m).collect();
        let rise_m = element_at(&mut heights_m, TOP_SHARE) - element_at(&mut heights_m, FOOT_SHARE);
        let is_long = rise_m >= LEAST_SLOPE_M * (1.0 - middle * middle).max(0.0).sqrt();
        let area_m2 =
            |side: &&TiltedPixel| area_m2(at(view.points_m, side), at(view.normals, side), view.space);
        let is_large = || alike.iter().map(area_m2).sum::<f64>() >= LEAST_FACE_M2;
        (is_long && is_large()).then_some(Self { toward, alike: share })
    }
}

/// Area of the surface seen by a pixel (m²).
fn area_m2(point_m: [f32; 3], normal: [f32; 3], space: &DisparitySpace) -> f64 {
    let camera = space.camera();
    let [point, normal] = [point_m, normal].map(|v| Vec3::from(v).as_dvec3());
    // Limited, because the area of a face seen edge-on would be unbounded and normals have errors.
    let slant = (normal.dot(point) / point.length()).abs().max(FORESHORTENED);
    point.z * point.z * point.z / (camera.fx_px * camera.fy_px * point.length() * slant)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::discovery::up::{Up, UpSource};
    use crate::regions::Segments;
    use crate::support::cell::CELL_SHARE;

    proptest! {
        /// The outline of every region, pixel by pixel.
        #[test]
        fn outlines_are_as_far_out_as_any_pixel(
            pixels in (1_usize..80, 1_usize..6).prop_flat_map(|size| crate::testing::raster(
                size, (0_i32..2, prop::array::uniform3(-1.0_f32..1.0), prop::bool::weighted(0.9)),
            )),
            direction in prop::array::uniform3(-1.0_f32..1.0),
        ) {
            let up = Vec3::from(direction).try_normalize().unwrap_or(Vec3::NEG_Y).to_array();
            let up = Up { direction: up, source: UpSource::Camera };
            let points = pixels.map(|&(_, point, is_measured)| if is_measured { point } else { [f32::NAN; 3] });
            let regions = Segments::from_numbered(pixels.map(|pixel| pixel.0), 2);
            // Some regions have no pixels.
            let normals = pixels.map(|&(_, vector, _)| if vector[0] < 0.5 { vector } else { [0.0; 3] });
            let space = &crate::testing::kinect();
            let (points_m, normals) = (&points, &normals);
            let bodies =
                Bodies::new(&SupportScene { regions: &regions, points_m, normals, planes: &[], up: &up, space });
            let plan = Plan::new(&up);
            let view = View { points_m, normals, plan: &plan, space };
            for (region, body) in bodies.all.iter().enumerate() {
                let own = || regions.members().filter(|&(i, r)| r == region && !points[i][2].is_nan()).map(|(i, _)| i);
                prop_assert_eq!((body.size_px, body.first), (own().count(), own().next().unwrap_or(0)));
                let mean = |value: &dyn Fn(usize) -> f64| own().map(value).sum::<f64>() / own().count().max(1) as f64;
                prop_assert!((body.mean_m - mean(&|i| plan.height_m(points[i]))).abs() < 1e-9);
                prop_assert!((body.middle_m.x - mean(&|i| plan.place_m(points[i]).x)).abs() < 1e-9);
                prop_assert!((body.middle_m.y - mean(&|i| plan.place_m(points[i]).y)).abs() < 1e-9);
                let known = || own().filter(|&i| normals[i] != [0.0; 3]);
                let normal = known().map(|i| Vec3::from(normals[i]).as_dvec3()).sum::<DVec3>();
                prop_assert_eq!(body.normal, normal / known().count().max(1) as f64);
                let side = |i: usize| {
                    let (upward, height_m) = (plan.upward(normals[i]), plan.height_m(points[i]));
                    (upward < 0.9 && upward.abs() > 0.14).then_some(TiltedPixel { pixel: i as u32, upward, height_m })
                };
                let sides: Vec<TiltedPixel> = own().filter_map(side).collect();
                let tilt = Tilt::of(&sides, own().count(), view);
                let told = |tilt: Option<Tilt>| tilt.map(|tilt| (tilt.toward, tilt.alike));
                prop_assert_eq!(told(body.tilt), told(tilt));
                let is_foot = |&i: &usize| plan.height_m(points[i]) < body.foot_m + body.level_m;
                let foot: Vec<u32> = own().filter(is_foot).map(|i| i as u32).collect();
                prop_assert_eq!(&body.foot, &foot);
                let mut cells: std::collections::BTreeMap<[i32; 2], Vec<f64>> = Default::default();
                for i in own() {
                    let place = plan.place_m(points[i]) / CELL_M;
                    let cell = [place.x.floor() as i32, place.y.floor() as i32];
                    cells.entry(cell).or_default().push(plan.height_m(points[i]));
                }
                let cells = cells.into_iter().map(|(cell, mut heights_m)| {
                    heights_m.sort_by(f64::total_cmp);
                    (cell, heights_m[(CELL_SHARE * heights_m.len() as f64) as usize])
                });
                prop_assert_eq!(
                    body.cells.iter().map(|(cell, height_m)| (cell.place(), height_m)).collect::<Vec<_>>(),
                    cells.collect::<Vec<_>>()
                );
                for (reach_m, way) in body.reach_m.iter().zip(plan.directions) {
                    let expected = own().map(|i| plan.place_m(points[i]).dot(way)).reduce(f64::max);
                    prop_assert_eq!(*reach_m, expected.unwrap_or(0.0));
                }
            }
        }
    }
}
