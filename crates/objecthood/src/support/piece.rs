//! Points of a region against gravity, many at once.

use std::ops::Range;

use glam::{DVec2, Vec3};

use crate::simd::vectorized;
use crate::support::cell::Cell;
use crate::support::plan::{DIRECTIONS, Plan};

/// So many pixels are looked at together.
pub(crate) const PIECE_PX: usize = 64;
/// So many are added up side by side.
const LANES: usize = 8;

/// Pixels of a region, those that follow each other in scan order, and what they are against gravity. They lie close together in
/// the plan view.
pub(crate) struct Piece {
    count: usize,
    pixels: [u32; PIECE_PX],
    points_m: [[f32; 3]; PIECE_PX],
    heights_m: [f64; PIECE_PX],
    /// Along either axis of the plan view.
    places_m: [[f64; PIECE_PX]; 2],
}

/// Sums over the points of a region, and how far it reaches.
pub(crate) struct Extent {
    /// Its first pixel.
    pub(crate) first: Option<u32>,
    pub(crate) size_px: usize,
    height_m: [f64; LANES],
    depth_m: [f64; LANES],
    place_m: [[f64; LANES]; 2],
    /// In the plan view, in each of the [`DIRECTIONS`] (m).
    pub(crate) reach_m: [f64; DIRECTIONS],
}

impl Extent {
    pub(crate) fn new() -> Self {
        let none = [0.0; LANES];
        let reach_m = [f64::NEG_INFINITY; DIRECTIONS];
        Self { first: None, size_px: 0, height_m: none, depth_m: none, place_m: [none; 2], reach_m }
    }

    fn mean(&self, sums: &[f64; LANES]) -> f64 {
        sums.iter().sum::<f64>() / self.size_px.max(1) as f64
    }

    /// Mean height (m).
    pub(crate) fn mean_m(&self) -> f64 {
        self.mean(&self.height_m)
    }

    /// Mean depth (m).
    pub(crate) fn depth_m(&self) -> f64 {
        self.mean(&self.depth_m)
    }

    /// Mean place (m).
    pub(crate) fn middle_m(&self) -> DVec2 {
        let [x, y] = &self.place_m;
        DVec2::new(self.mean(x), self.mean(y))
    }
}

impl Piece {
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            pixels: [0; PIECE_PX],
            points_m: [[0.0; 3]; PIECE_PX],
            heights_m: [0.0; PIECE_PX],
            places_m: [[0.0; PIECE_PX]; 2],
        }
    }

    /// Takes these pixels; whenever it is full it is looked at and emptied.
    pub(crate) fn take(
        &mut self,
        mut pixels: Range<usize>,
        points_m: &[[f32; 3]],
        mut look: impl FnMut(&mut Self),
    ) {
        while !pixels.is_empty() {
            let (first, taken) = (pixels.start, pixels.len().min(PIECE_PX - self.count));
            pixels.start += taken;
            let own = self.count..self.count + taken;
            self.points_m[own.clone()].copy_from_slice(&points_m[first..][..taken]);
            self.pixels[own].iter_mut().zip(first as u32..).for_each(|(own, i)| *own = i);
            self.count += taken;
            if self.count == PIECE_PX {
                look(self);
                self.count = 0;
            }
        }
    }

    /// Leaves out what is not measured.
    fn keep_measured(&mut self) {
        let taken = std::mem::take(&mut self.count);
        for k in 0..taken {
            if !self.points_m[k][2].is_nan() {
                (self.pixels[self.count], self.points_m[self.count]) = (self.pixels[k], self.points_m[k]);
                self.count += 1;
            }
        }
    }

    pub(crate) fn pixels(&self) -> &[u32] {
        &self.pixels[..self.count]
    }

    /// As far as it is [surveyed](Self::survey).
    pub(crate) fn heights_m(&self) -> &[f64] {
        &self.heights_m[..self.count]
    }

    /// The cells of its pixels, as far as it is [surveyed](Self::survey); behind them some that mean nothing.
    pub(crate) fn cells(&self) -> [Cell; PIECE_PX] {
        let [x_m, y_m] = &self.places_m;
        let mut cells = [Cell::default(); PIECE_PX];
        vectorized(
            #[inline(always)]
            || (0..PIECE_PX).for_each(|k| cells[k] = Cell::at(DVec2::new(x_m[k], y_m[k]))),
        );
        cells
    }

    /// Finds out where its points are, without those that are not measured, and adds them to what is known of the region.
    pub(crate) fn survey(&mut self, plan: &Plan, extent: &mut Extent) {
        let points_m = &self.points_m[..self.count];
        let is_whole = vectorized(
            #[inline(always)]
            || points_m.iter().fold(true, |all, point_m| all & !point_m[2].is_nan()),
        );
        if !is_whole {
            self.keep_measured();
        }
        let Some(&first) = self.pixels().first() else { return };
        extent.first.get_or_insert(first);
        extent.size_px += self.count;
        // Free places repeat the first point, so that they widen nothing.
        let first_m = self.points_m[0];
        self.points_m[self.count..].fill(first_m);
        vectorized(
            #[inline(always)]
            || {
                let Self { count, points_m, heights_m, places_m: [x_m, y_m], .. } = self;
                let mut depths_m = [0.0; PIECE_PX];
                for k in 0..PIECE_PX {
                    let point = Vec3::from(points_m[k]).as_dvec3();
                    heights_m[k] = plan.up.dot(point);
                    x_m[k] = plan.across[0].dot(point);
                    y_m[k] = plan.across[1].dot(point);
                    depths_m[k] = point.z;
                }
                add(&mut extent.height_m, &heights_m[..*count]);
                add(&mut extent.depth_m, &depths_m[..*count]);
                add(&mut extent.place_m[0], &x_m[..*count]);
                add(&mut extent.place_m[1], &y_m[..*count]);
                push_out(&mut extent.reach_m, [x_m, y_m], &plan.directions);
            },
        );
    }
}

/// Adds values to sums that are kept side by side.
#[inline(always)]
fn add(sums: &mut [f64; LANES], values: &[f64]) {
    let (blocks, rest) = values.as_chunks::<LANES>();
    for block in blocks {
        (0..LANES).for_each(|k| sums[k] += block[k]);
    }
    sums.iter_mut().zip(rest).for_each(|(sum, value)| *sum += value);
}

/// Pushes an outline out to where some places reach. Most pieces lie inside, and the box around them tells: rounding keeps the
/// order of products and sums, so nothing of a piece reaches farther than the box.
#[inline(always)]
fn push_out(
    reach_m: &mut [f64; DIRECTIONS],
    [x_m, y_m]: [&[f64; PIECE_PX]; 2],
    directions: &[DVec2; DIRECTIONS],
) {
    let ((left, right), (low, high)) = (limits(x_m), limits(y_m));
    let mut is_beyond = [false; DIRECTIONS];
    for k in 0..DIRECTIONS {
        let DVec2 { x, y } = directions[k];
        let reached_m = larger(left * x, right * x) + larger(low * y, high * y);
        is_beyond[k] = reached_m > reach_m[k];
    }
    for k in (0..DIRECTIONS).filter(|&k| is_beyond[k]) {
        let DVec2 { x, y } = directions[k];
        let mut along_m = [0.0; PIECE_PX];
        (0..PIECE_PX).for_each(|p| along_m[p] = x_m[p] * x + y_m[p] * y);
        reach_m[k] = larger(limits(&along_m).1, reach_m[k]);
    }
}

/// The least and the greatest of some values.
#[inline(always)]
fn limits(values: &[f64; PIECE_PX]) -> (f64, f64) {
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for block in values.as_chunks::<LANES>().0 {
        for k in 0..LANES {
            low[k] = smaller(block[k], low[k]);
            high[k] = larger(block[k], high[k]);
        }
    }
    // By halves, so that no comparison waits for all before it.
    const { assert!(LANES == 8, "as many halves as follow") }
    for half in [4, 2, 1] {
        for k in 0..half {
            low[k] = smaller(low[k + half], low[k]);
            high[k] = larger(high[k + half], high[k]);
        }
    }
    (low[0], high[0])
}

/// One instruction, where `min` minds what is no number.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// As [`smaller`].
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
