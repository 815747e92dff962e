//! Regions against gravity: how high they stand, where they are in the plan view, how they are tilted.

use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

use crate::objectness::gravity::{StructurePlane, Up};
use crate::oversegment::structure::{UPWARD, element_at, tangents};
use crate::raster::Raster;
use crate::regions::Segments;
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
/// Side of a cell of the plan view (m): half the distance of contact, so that what is in contact is in neighbouring cells.
const CELL_M: f64 = 0.01;
/// The height of a cell is this share of its heights from below.
const CELL_SHARE: f64 = 0.8;
/// The outline of a region in the plan view is known in so many directions.
const DIRECTIONS: usize = 16;
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
/// So many pixels side by side are asked together whether they widen the outline of their region.
const PIECE_PX: usize = 32;
/// Where the way along gravity is shorter than this in the image (sine; 6 degrees) its direction means nothing.
const FORESHORTENED: f64 = 0.1;

/// Takes points to heights and to the plan view, which is what is seen from straight above.
pub(crate) struct Plan {
    up: DVec3,
    across: [DVec3; 2],
    /// In which the outline of a region is known.
    directions: [DVec2; DIRECTIONS],
}

impl Plan {
    pub(crate) fn new(up: &Up) -> Self {
        let up = Vec3::from(up.direction).as_dvec3();
        let directions = std::array::from_fn(|k| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / DIRECTIONS as f64);
            DVec2::new(cos, sin)
        });
        Self { up, across: tangents(up), directions }
    }

    /// Height along up, relative to the camera (m).
    pub(crate) fn height_m(&self, point_m: [f32; 3]) -> f64 {
        self.up.dot(Vec3::from(point_m).as_dvec3())
    }

    /// How much of a normal is upwards.
    pub(crate) fn upward(&self, normal: [f32; 3]) -> f64 {
        self.height_m(normal)
    }

    /// Place in the plan view (m).
    pub(crate) fn place_m(&self, point_m: [f32; 3]) -> DVec2 {
        let point = Vec3::from(point_m).as_dvec3();
        DVec2::new(self.across[0].dot(point), self.across[1].dot(point))
    }

    /// The step to one of the eight neighbouring pixels that leads most nearly along gravity at a point, for square
    /// pixels; `None` where one looks along gravity (within about 6 degrees).
    pub(crate) fn step_down(&self, point_m: [f32; 3]) -> Option<[i64; 2]> {
        let [x, y, z] = point_m.map(f64::from);
        let down = DVec2::new(-self.up.x + x / z * self.up.z, -self.up.y + y / z * self.up.z);
        let down = (down.length() > FORESHORTENED).then(|| down.normalize())?;
        // sin 22.5 degrees: nearer to an axis than to a diagonal.
        Some(down.to_array().map(|along| if along.abs() > 0.38 { along.signum() as i64 } else { 0 }))
    }
}

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
    /// How far it reaches in the plan view in each of [`DIRECTIONS`] (m).
    reach_m: [f64; DIRECTIONS],
    /// Of a thing, how high it is cell by cell (m), in the order of cells.
    cells: Vec<(Cell, f64)>,
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

    /// Whether a region ends upwards near a point, and is something to stand on there. Heights are the same up to `level_m`.
    pub(crate) fn ends_at(&self, region: usize, point_m: [f32; 3], level_m: f64) -> bool {
        match self.planes.get(region) {
            Some(plane) => self.faces_up(plane),
            None => {
                let top_m = self.top_near_m(region, self.plan.place_m(point_m));
                top_m.is_none_or(|top_m| top_m <= self.plan.height_m(point_m) + level_m)
            }
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
        let [x, y] = Cell::at(place_m).place();
        let cells = &self.all[region].cells;
        let column = |x: i32| {
            let first = cells.partition_point(|of_cell| of_cell.0 < Cell::new(x, y.saturating_sub(1)));
            cells[first..].iter().take_while(move |of_cell| of_cell.0 <= Cell::new(x, y.saturating_add(1)))
        };
        let around = [x.saturating_sub(1), x, x.saturating_add(1)].into_iter().flat_map(column);
        around.map(|of_cell| of_cell.1).reduce(f64::max)
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
        let (mut body, mut look, mut piece) = (Self::default(), Look::default(), Piece::new());
        for run in runs {
            for start in run.clone().step_by(PIECE_PX) {
                piece.fill(start..run.end.min(start + PIECE_PX), points_m, plan);
                body.add(&piece, &plan.directions);
                if is_thing {
                    look.add(&piece, points_m, normals, plan);
                }
            }
        }
        let count = body.size_px.max(1) as f64;
        body.mean_m /= count;
        body.middle_m /= count;
        body.take(look, pixels, plan, space);
        body
    }

    fn add(&mut self, piece: &Piece, directions: &[DVec2; DIRECTIONS]) {
        let Some(&first) = piece.pixels().first() else { return };
        if self.size_px == 0 {
            self.first = first as usize;
            self.reach_m = [f64::NEG_INFINITY; DIRECTIONS];
        }
        self.size_px += piece.count;
        self.mean_m = piece.heights_m().iter().fold(self.mean_m, |sum, height_m| sum + height_m);
        self.middle_m = piece.places_m().iter().fold(self.middle_m, |sum, place_m| sum + place_m);
        piece.push_out(&mut self.reach_m, directions);
    }

    /// What follows from all that is seen of it.
    fn take(&mut self, mut look: Look, pixels: Pixels<'_>, plan: &Plan, space: &DisparitySpace) {
        self.cells = look.cells();
        self.foot_m = element_at(&mut look.heights_m, FOOT_SHARE);
        self.top_m = element_at(&mut look.heights_m, TOP_SHARE);
        let depth_m = look.depth_m / self.size_px.max(1) as f64;
        self.level_m = space.step_m(LEVEL_QUANTA, depth_m).max(LEVEL_M);
        self.normal = look.normal / look.normals.max(1) as f64;
        self.tilt = Tilt::of(&look.tilted, self.size_px, pixels, plan, space);
    }
}

/// Some pixels of a region side by side, which lie close together in the plan view.
struct Piece {
    count: usize,
    pixels: [u32; PIECE_PX],
    heights_m: [f64; PIECE_PX],
    places_m: [DVec2; PIECE_PX],
}

impl Piece {
    fn new() -> Self {
        let (pixels, heights_m, places_m) = ([0; PIECE_PX], [0.0; PIECE_PX], [DVec2::ZERO; PIECE_PX]);
        Self { count: 0, pixels, heights_m, places_m }
    }

    /// Those that are measured among these pixels.
    fn fill(&mut self, pixels: Range<usize>, points_m: &Raster<[f32; 3]>, plan: &Plan) {
        self.count = 0;
        for (i, &point_m) in pixels.clone().zip(&points_m.as_slice()[pixels]) {
            if !point_m[2].is_nan() {
                let k = self.count;
                self.pixels[k] = i as u32;
                self.heights_m[k] = plan.height_m(point_m);
                self.places_m[k] = plan.place_m(point_m);
                self.count += 1;
            }
        }
    }

    fn pixels(&self) -> &[u32] {
        &self.pixels[..self.count]
    }

    fn heights_m(&self) -> &[f64] {
        &self.heights_m[..self.count]
    }

    fn places_m(&self) -> &[DVec2] {
        &self.places_m[..self.count]
    }

    /// Pushes the outline of its region out to where it reaches. Most pieces lie inside, and the box around them tells: rounding
    /// keeps the order of products and sums, so nothing of a piece reaches farther than the box.
    fn push_out(&self, reach_m: &mut [f64; DIRECTIONS], directions: &[DVec2; DIRECTIONS]) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &DVec2 { x, y } in self.places_m() {
            // One instruction each, where `min` minds what is no number.
            low.x = if x < low.x { x } else { low.x };
            low.y = if y < low.y { y } else { low.y };
            high.x = if x > high.x { x } else { high.x };
            high.y = if y > high.y { y } else { high.y };
        }
        for (reach_m, way) in reach_m.iter_mut().zip(directions) {
            let [x, y] = [[low.x * way.x, high.x * way.x], [low.y * way.y, high.y * way.y]];
            if x[0].max(x[1]) + y[0].max(y[1]) > *reach_m {
                let reached_m = self.places_m().iter().map(|place_m| place_m.dot(*way));
                *reach_m = reached_m.fold(*reach_m, f64::max);
            }
        }
    }
}

/// Points and normals of the image.
type Pixels<'a> = (&'a Raster<[f32; 3]>, &'a Raster<[f32; 3]>);

/// What is seen of a thing.
#[derive(Clone, Default)]
struct Look {
    /// Of every point (m).
    heights_m: Vec<f64>,
    /// Neighbouring points in one cell of the plan view, and where they begin among the heights.
    runs: Vec<(Cell, u32)>,
    depth_m: f64,
    normal: DVec3,
    normals: usize,
    tilted: Vec<Side>,
}

/// A pixel of a face that is tilted, and no top.
#[derive(Clone, Copy)]
struct Side {
    pixel: u32,
    /// What of its normal is upwards.
    upward: f64,
    height_m: f64,
}

impl Look {
    fn add(&mut self, piece: &Piece, points_m: &Raster<[f32; 3]>, normals: &Raster<[f32; 3]>, plan: &Plan) {
        for (k, &place_m) in piece.places_m().iter().enumerate() {
            let cell = Cell::at(place_m);
            if self.runs.last().is_none_or(|run| run.0 != cell) {
                self.runs.push((cell, (self.heights_m.len() + k) as u32));
            }
        }
        self.heights_m.extend(piece.heights_m());
        for (&pixel, &height_m) in piece.pixels().iter().zip(piece.heights_m()) {
            let normal = normals[pixel as usize];
            self.depth_m += f64::from(points_m[pixel as usize][2]);
            if normal == [0.0; 3] {
                continue;
            }
            self.normal += Vec3::from(normal).as_dvec3();
            self.normals += 1;
            let upward = plan.upward(normal);
            if upward < TOP_FACE && upward.abs() > LEAST_TILT {
                self.tilted.push(Side { pixel, upward, height_m });
            }
        }
    }

    /// The height of every cell (m). O(points + runs · log of them).
    fn cells(&self) -> Vec<(Cell, f64)> {
        let ends = self.runs[1.min(self.runs.len())..].iter().map(|run| run.1);
        let ends = ends.chain([self.heights_m.len() as u32]);
        let mut runs: Vec<(Cell, Range<u32>)> =
            self.runs.iter().zip(ends).map(|(&(cell, start), end)| (cell, start..end)).collect();
        runs.sort_unstable_by_key(|run| run.0);
        let mut heights_m = Vec::new();
        let height = |runs: &[(Cell, Range<u32>)]| {
            heights_m.clear();
            for (_, run) in runs {
                heights_m.extend(&self.heights_m[run.start as usize..run.end as usize]);
            }
            (runs[0].0, element_at(&mut heights_m, CELL_SHARE))
        };
        runs.chunk_by(|a, b| a.0 == b.0).map(height).collect()
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

/// A cell of the plan view. In one number, so that many are sorted fast: by column, then by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Cell(u64);

impl Cell {
    #[inline]
    fn at(place_m: DVec2) -> Self {
        let place = place_m / CELL_M;
        Self::new(floor(place.x), floor(place.y))
    }

    #[inline]
    fn new(x: i32, y: i32) -> Self {
        let ascending = |x: i32| u64::from(x.wrapping_sub(i32::MIN) as u32);
        Self(ascending(x) << 32 | ascending(y))
    }

    fn place(self) -> [i32; 2] {
        [self.0 >> 32, self.0].map(|x| (x as u32 as i32).wrapping_add(i32::MIN))
    }
}

/// The integer below, saturating: a conversion and a comparison, which a library's `floor` on the oldest x86-64 is not.
#[inline]
fn floor(x: f64) -> i32 {
    let toward_zero = x as i32;
    toward_zero.saturating_sub(i32::from(f64::from(toward_zero) > x))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::objectness::gravity::UpSource;

    #[test]
    fn integers_below_are_those_of_the_library() {
        let edges =
            [0.0, -0.0, 0.5, -0.5, 2.0, -2.0, 1e300, -1e300, 2_147_483_647.5, -2_147_483_648.5, f64::NAN];
        for x in edges.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY]) {
            assert_eq!(floor(x), x.floor() as i32, "{x}");
        }
    }

    proptest! {
        #[test]
        fn cells_are_in_the_order_of_columns_then_rows(
            [a, b] in prop::array::uniform2(prop::array::uniform2(prop_oneof![
                Just(i32::MIN), Just(i32::MAX), -3_i32..3, any::<i32>()
            ])),
        ) {
            let [cell_a, cell_b] = [a, b].map(|[x, y]| Cell::new(x, y));
            prop_assert_eq!((cell_a.place(), cell_a.cmp(&cell_b)), (a, a.cmp(&b)));
        }

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
            let normals = points.map(|_| [0.0, 0.0, -1.0]);
            let bodies = Bodies::new(&regions, &points, &normals, &[], &up, &crate::testing::kinect());
            let plan = Plan::new(&up);
            for (region, body) in bodies.all.iter().enumerate() {
                let own = || regions.members().filter(|&(i, r)| r == region && !points[i][2].is_nan()).map(|(i, _)| i);
                prop_assert_eq!((body.size_px, body.first), (own().count(), own().next().unwrap_or(0)));
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
                    body.cells.iter().map(|(cell, height_m)| (cell.place(), *height_m)).collect::<Vec<_>>(),
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
