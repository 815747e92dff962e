//! Regions against gravity: how high they stand, where they are in the plan view, how they are tilted.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use crate::discovery::up::Up;
use crate::oversegment::structure::UPWARD;
use crate::planes::StructurePlane;
use crate::quantile::element_at;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::simd::{extend_where, vectorized};
use crate::support::cell::{CELL_M, Cell, Cells};
use crate::support::piece::{Extent, PIECE_PX, Piece};
use crate::support::plan::{DIRECTIONS, FORESHORTENED, Plan};
use crate::surface::disparity::DisparitySpace;

/// Heights that differ by less (m) are the same: what rises less above its surroundings is not told from them either
/// (`height.min_top_m`). Beyond 1.9 m the sensor resolves less: there it is [`LEVEL_QUANTA`].
const LEVEL_M: f64 = 0.01;
/// A foot, at the 2nd percentile of heights, sinks by so many quanta: two standard deviations of a depth of half a quantum.
const LEVEL_QUANTA: f64 = 1.0;
/// In so many directions one looks for what is around a place.
pub(crate) const SECTORS: usize = 12;
/// The foot of a region is this share of its heights from below: single noisy pixels lie low anywhere.
const FOOT_SHARE: f64 = 0.02;
/// Its top is this share from below.
const TOP_SHARE: f64 = 0.98;
/// A face whose normal has more than this along up (25 degrees from level) is a top, not a side.
const TOP_FACE: f64 = 0.9;
/// Sides of a flat thing are tilted alike up to this (sine; 9 degrees, the noise of normals of small faces).
const ALIKE: f64 = 0.15;
/// What is tilted by less (sine; 8 degrees) stands upright.
const LEAST_TILT: f64 = 0.14;
/// This share of what is tilted in something that leans is tilted alike: a board is, a ball or a rounded edge is not.
const LEAST_ALIKE: f64 = 0.6;
/// And it is this share of all that is seen of it.
const LEAST_TILTED: f64 = 0.2;
/// Up its slope it is so long (m) ...
const LEAST_SLOPE_M: f64 = 0.07;
/// ... and so large (m²): boards are, cables, handles and slivers of a bowl's wall are not.
const LEAST_FACE_M2: f64 = 0.004;

/// A region as something that stands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Body {
    /// Its first pixel; tells regions apart whatever their numbers are.
    pub(crate) first: usize,
    /// Pixels with depth.
    pub(crate) size_px: usize,
    /// Mean height (m).
    pub(crate) mean_m: f64,
    /// Of a thing, the height of its lowest visible part (m).
    pub(crate) foot_m: f64,
    /// Of a thing, the height of its highest part (m).
    pub(crate) top_m: f64,
    /// Of a thing, heights that differ by less (m) are the same at its depth.
    pub(crate) level_m: f64,
    /// Of a thing, its mean normal, the shorter the more it bends; zero without any.
    pub(crate) normal: DVec3,
    /// Mean place (m).
    pub(crate) middle_m: DVec2,
    /// How far it reaches in the plan view in each of the directions of its outline (m).
    reach_m: [f64; DIRECTIONS],
    /// Of a thing, how high it is cell by cell.
    cells: Cells,
    /// Of a thing, the pixels of what is level with its lowest visible part.
    pub(crate) foot: Vec<u32>,
    /// Which way its sides lean, if they are one flat face that is tilted.
    pub(crate) tilt: Option<Tilt>,
}

/// Something flat that is not upright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt {
    /// Unit vector in the plan view from its foot to its top.
    pub(crate) toward: DVec2,
    /// Share of its sides that are tilted alike.
    pub(crate) alike: f64,
}

/// The regions of a scene against gravity.
pub(crate) struct Bodies<'a> {
    pub(crate) plan: Plan,
    /// One a region.
    pub(crate) all: Vec<Body>,
    /// The first regions are these; the others stand about.
    pub(crate) planes: &'a [StructurePlane],
}

impl<'a> Bodies<'a> {
    /// Pixels without depth do not count. O(pixels + pixels of things · log of them); parallel over
    /// regions.
    pub(crate) fn new(
        regions: &Segments,
        points_m: &Raster<[f32; 3]>,
        normals: &Raster<[f32; 3]>,
        planes: &'a [StructurePlane],
        up: &Up,
        space: &DisparitySpace,
    ) -> Self {
        let plan = Plan::new(up);
        let pixels = (points_m, normals);
        let body = |region, runs: &[_]| Body::of(runs, region >= planes.len(), pixels, &plan, space);
        let all = regions.runs_of_each().map(body);
        Self { plan, all, planes }
    }

    /// The regions that are no planes and have points.
    pub(crate) fn things(&self) -> impl Iterator<Item = usize> + '_ {
        (self.planes.len()..self.all.len()).filter(|&region| self.all[region].size_px > 0)
    }

    /// Whether something can stand on a plane.
    pub(crate) fn faces_up(&self, plane: &StructurePlane) -> bool {
        self.plan.upward(plane.normal) > UPWARD
    }

    /// Whether a region ends upwards near a place, below a height (m), and is something to stand on there.
    pub(crate) fn ends_at(&self, region: usize, place_m: DVec2, below_m: f64) -> bool {
        match self.planes.get(region) {
            Some(plane) => self.faces_up(plane),
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

    /// How high a thing is seen at a place and about 1 cm around it (m).
    pub(crate) fn top_near_m(&self, region: usize, place_m: DVec2) -> Option<f64> {
        self.all[region].cells.top_near_m(place_m)
    }

    /// How long a region is in the plan view (m), along the longest of [`DIRECTIONS`].
    pub(crate) fn length_m(&self, region: usize) -> f64 {
        let reach_m = &self.all[region].reach_m;
        let lengths_m = (0..DIRECTIONS).map(|k| reach_m[k] + reach_m[(k + DIRECTIONS / 2) % DIRECTIONS]);
        lengths_m.fold(0.0, f64::max)
    }

    /// How far the outlines of two regions overlap in the plan view (m): the least way along any of [`DIRECTIONS`] that
    /// takes them apart.
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

    /// Around a place, in how many of [`SECTORS`] directions a region is seen above a height.
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
    /// Of the pixels in these runs along rows.
    fn of(
        runs: &[Range<usize>],
        is_thing: bool,
        pixels: Pixels<'_>,
        plan: &Plan,
        space: &DisparitySpace,
    ) -> Self {
        let (points_m, normals) = pixels;
        let most = if is_thing { runs.iter().map(ExactSizeIterator::len).sum() } else { 0 };
        let (mut extent, mut look, mut piece) = (Extent::new(), Look::of_at_most(most), Piece::new());
        let mut survey = |piece: &mut Piece| {
            piece.survey(plan, &mut extent);
            if is_thing {
                look.add(piece, normals.as_slice(), plan);
            }
        };
        for run in runs {
            piece.take(run.clone(), points_m.as_slice(), &mut survey);
        }
        survey(&mut piece);
        let Some(first) = extent.first else { return Self::default() };
        let mut body = Self {
            first: first as usize,
            size_px: extent.size_px,
            mean_m: extent.mean_m(),
            level_m: space.step_m(LEVEL_QUANTA, extent.depth_m()).max(LEVEL_M),
            middle_m: extent.middle_m(),
            reach_m: extent.reach_m,
            ..Self::default()
        };
        body.take(look, pixels, plan, space);
        body
    }

    /// What follows from all that is seen of it.
    fn take(&mut self, look: Look, pixels: Pixels<'_>, plan: &Plan, space: &DisparitySpace) {
        let mut heights_m = look.heights_m.clone();
        self.foot_m = element_at(&mut heights_m, FOOT_SHARE);
        self.top_m = element_at(&mut heights_m, TOP_SHARE);
        let is_foot = |&(_, height_m): &(&u32, &f64)| *height_m < self.foot_m + self.level_m;
        self.foot = look.pixels.iter().zip(&look.heights_m).filter(is_foot).map(|(&i, _)| i).collect();
        self.normal = look.normal / f64::from(look.normals.max(1));
        self.cells = Cells::new(look.heights_m, &look.runs);
        self.tilt = Tilt::of(&look.tilted, self.size_px, pixels, plan, space);
    }
}

/// Points and normals of the image.
type Pixels<'a> = (&'a Raster<[f32; 3]>, &'a Raster<[f32; 3]>);

/// What is seen of a thing.
#[derive(Default)]
struct Look {
    /// Every pixel, in scan order.
    pixels: Vec<u32>,
    /// Its height (m).
    heights_m: Vec<f64>,
    /// Neighbouring points in one cell of the plan view, and where they begin among the heights.
    runs: Vec<(Cell, u32)>,
    normal: DVec3,
    normals: u32,
    tilted: Vec<Side>,
}

/// A pixel of a face that is tilted, and no top.
#[derive(Clone, Copy, Default)]
struct Side {
    pixel: u32,
    /// What of its normal is upwards.
    upward: f64,
    height_m: f64,
}

impl Look {
    /// Of so many pixels, for which there is room.
    fn of_at_most(count: usize) -> Self {
        Self { pixels: Vec::with_capacity(count), heights_m: Vec::with_capacity(count), ..Self::default() }
    }

    fn add(&mut self, piece: &Piece, normals: &[[f32; 3]], plan: &Plan) {
        let (pixels, heights_m) = (piece.pixels(), piece.heights_m());
        let cells = piece.cells();
        let mut is_start = [false; PIECE_PX];
        is_start[0] = self.runs.last().is_none_or(|run| run.0 != cells[0]);
        (1..PIECE_PX).for_each(|k| is_start[k] = cells[k] != cells[k - 1]);
        let starts = cells.into_iter().zip(self.heights_m.len() as u32..);
        extend_where::<PIECE_PX, _>(&mut self.runs, starts.zip(is_start).take(pixels.len()));
        self.pixels.extend(pixels);
        self.heights_m.extend(heights_m);

        let mut own = [[0.0; 3]; PIECE_PX];
        own.iter_mut().zip(pixels).for_each(|(own, &pixel)| *own = normals[pixel as usize]);
        let (mut upward, mut is_side) = ([0.0; PIECE_PX], [false; PIECE_PX]);
        self.normals += vectorized(
            #[inline(always)]
            || {
                let mut count = 0;
                for k in 0..PIECE_PX {
                    upward[k] = plan.upward(own[k]);
                    is_side[k] = (upward[k] < TOP_FACE) & (upward[k].abs() > LEAST_TILT);
                    let [x, y, z] = own[k];
                    count += u32::from((x != 0.0) | (y != 0.0) | (z != 0.0));
                }
                count
            },
        );
        // Of no normal nothing is added.
        self.normal = own[..pixels.len()].iter().fold(self.normal, |sum, &n| sum + Vec3::from(n).as_dvec3());
        let sides = pixels.iter().zip(heights_m).zip(upward).zip(is_side);
        let sides =
            sides.map(|(((&pixel, &height_m), upward), is_side)| (Side { pixel, upward, height_m }, is_side));
        extend_where::<PIECE_PX, _>(&mut self.tilted, sides);
    }
}

impl Tilt {
    /// Of the tilted faces of something of `size_px` pixels.
    fn of(
        tilted: &[Side],
        size_px: usize,
        (points_m, normals): Pixels<'_>,
        plan: &Plan,
        space: &DisparitySpace,
    ) -> Option<Self> {
        let mut upward: Vec<f64> = tilted.iter().map(|side| side.upward).collect();
        let middle = element_at(&mut upward, 0.5);
        let alike: Vec<_> = tilted.iter().filter(|side| (side.upward - middle).abs() <= ALIKE).collect();
        let share = alike.len() as f64 / upward.len().max(1) as f64;
        if share < LEAST_ALIKE || (alike.len() as f64) < LEAST_TILTED * size_px as f64 {
            return None;
        }
        let at = |raster: &Raster<[f32; 3]>, side: &Side| raster[side.pixel as usize];
        let outward: DVec2 = alike.iter().map(|side| plan.place_m(at(normals, side))).sum();
        // What shows its upper side leans away from where that faces.
        let toward = (-middle.signum() * outward).try_normalize()?;
        let mut heights_m: Vec<f64> = alike.iter().map(|side| side.height_m).collect();
        let rise_m = element_at(&mut heights_m, TOP_SHARE) - element_at(&mut heights_m, FOOT_SHARE);
        let is_long = rise_m >= LEAST_SLOPE_M * (1.0 - middle * middle).max(0.0).sqrt();
        let area_m2 = |side: &&Side| area_m2(at(points_m, side), at(normals, side), space);
        let is_large = || alike.iter().map(area_m2).sum::<f64>() >= LEAST_FACE_M2;
        (is_long && is_large()).then_some(Self { toward, alike: share })
    }
}

/// Area of the face that a pixel shows (m^2).
fn area_m2(point_m: [f32; 3], normal: [f32; 3], space: &DisparitySpace) -> f64 {
    let camera = space.camera();
    let [point, normal] = [point_m, normal].map(|v| Vec3::from(v).as_dvec3());
    // Along the face one sees next to nothing, and normals err.
    let slant = (normal.dot(point) / point.length()).abs().max(FORESHORTENED);
    point.z * point.z * point.z / (camera.fx_px * camera.fy_px * point.length() * slant)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::discovery::up::UpSource;
    use crate::support::cell::CELL_SHARE;

    proptest! {
        /// Of every region: what its pixels reach, one by one.
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
            // Some have none.
            let normals = pixels.map(|&(_, vector, _)| if vector[0] < 0.5 { vector } else { [0.0; 3] });
            let bodies = Bodies::new(&regions, &points, &normals, &[], &up, &crate::testing::kinect());
            let plan = Plan::new(&up);
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
                    (upward < 0.9 && upward.abs() > 0.14).then_some(Side { pixel: i as u32, upward, height_m })
                };
                let sides: Vec<Side> = own().filter_map(side).collect();
                let tilt = Tilt::of(&sides, own().count(), (&points, &normals), &plan, &crate::testing::kinect());
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
