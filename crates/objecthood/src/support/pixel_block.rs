//! Blocks of pixels of one region. Heights and places in the plan view are computed for a whole block at once.

use std::ops::Range;

use glam::{DVec2, Vec3};

use crate::simd::vectorized;
use crate::support::cell::Cell;
use crate::support::plan::{DIRECTIONS, Plan};

/// Pixels of a block.
pub(crate) const BLOCK_PX: usize = 64;
/// Partial sums kept side by side.
const LANES: usize = 8;

/// Successive pixels of a region, in scan order, with their heights and their places in the plan view, which lie close together.
pub(crate) struct PixelBlock {
    count: usize,
    pixels: [u32; BLOCK_PX],
    points_m: [[f32; 3]; BLOCK_PX],
    heights_m: [f64; BLOCK_PX],
    /// Along either axis of the plan view (m).
    places_m: [[f64; BLOCK_PX]; 2],
}

/// The number of points of a region, their means, and the outline of the region.
pub(crate) struct RegionExtent {
    /// Its first pixel.
    pub(crate) first: Option<u32>,
    pub(crate) size_px: usize,
    /// Sums (m).
    height_m: [f64; LANES],
    depth_m: [f64; LANES],
    place_m: [[f64; LANES]; 2],
    /// Its outline in the plan view: the farthest reach in each of the [`DIRECTIONS`] (m).
    pub(crate) reach_m: [f64; DIRECTIONS],
}

impl RegionExtent {
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

impl PixelBlock {
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            pixels: [0; BLOCK_PX],
            points_m: [[0.0; 3]; BLOCK_PX],
            heights_m: [0.0; BLOCK_PX],
            places_m: [[0.0; BLOCK_PX]; 2],
        }
    }

    /// Adds these pixels. Whenever the block is full, it is passed to `look` and emptied.
    pub(crate) fn take(
        &mut self,
        mut pixels: Range<usize>,
        points_m: &[[f32; 3]],
        mut look: impl FnMut(&mut Self),
    ) {
        while !pixels.is_empty() {
            let (first, taken) = (pixels.start, pixels.len().min(BLOCK_PX - self.count));
            pixels.start += taken;
            let own = self.count..self.count + taken;
            self.points_m[own.clone()].copy_from_slice(&points_m[first..][..taken]);
            self.pixels[own].iter_mut().zip(first as u32..).for_each(|(own, i)| *own = i);
            self.count += taken;
            if self.count == BLOCK_PX {
                look(self);
                self.count = 0;
            }
        }
    }

    /// Drops pixels without depth.
    fn keep_measured(&mut self) {
        let taken = std::mem::take(&mut self.count);
        for k in 0..taken {
            if !self.points_m[k][2].is_nan() {
                (self.pixels[self.count], self.points_m[self.count]) = (self.pixels[k], self.points_m[k]);
                self.count += 1;
            }
        }
    }

    /// Its pixels.
    pub(crate) fn pixels(&self) -> &[u32] {
        &self.pixels[..self.count]
    }

    /// Their heights (m), once they are [surveyed](Self::survey).
    pub(crate) fn heights_m(&self) -> &[f64] {
        &self.heights_m[..self.count]
    }

    /// Their cells of the plan view, once they are [surveyed](Self::survey). Entries beyond the last pixel have no meaning.
    pub(crate) fn cells(&self) -> [Cell; BLOCK_PX] {
        let [x_m, y_m] = &self.places_m;
        let mut cells = [Cell::default(); BLOCK_PX];
        vectorized(
            #[inline(always)]
            || (0..BLOCK_PX).for_each(|k| cells[k] = Cell::at(DVec2::new(x_m[k], y_m[k]))),
        );
        cells
    }

    /// Computes heights and places of its points, drops those without depth, and adds the rest to the extent of the region.
    pub(crate) fn survey(&mut self, plan: &Plan, extent: &mut RegionExtent) {
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
        // Unused places repeat the first point, so they do not widen the outline.
        let first_m = self.points_m[0];
        self.points_m[self.count..].fill(first_m);
        vectorized(
            #[inline(always)]
            || {
                let Self { count, points_m, heights_m, places_m: [x_m, y_m], .. } = self;
                let mut depths_m = [0.0; BLOCK_PX];
                for k in 0..BLOCK_PX {
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

/// Widens an outline to contain some places. Most blocks, and the boxes around them, lie inside the outline already; a box is quicker
/// to test. Rounding keeps the order of products and sums, so no point of a block reaches farther than its box.
#[inline(always)]
fn push_out(
    reach_m: &mut [f64; DIRECTIONS],
    [x_m, y_m]: [&[f64; BLOCK_PX]; 2],
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
        let mut along_m = [0.0; BLOCK_PX];
        (0..BLOCK_PX).for_each(|p| along_m[p] = x_m[p] * x + y_m[p] * y);
        reach_m[k] = larger(limits(&along_m).1, reach_m[k]);
    }
}

/// The least and the greatest of some values.
#[inline(always)]
fn limits(values: &[f64; BLOCK_PX]) -> (f64, f64) {
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for block in values.as_chunks::<LANES>().0 {
        for k in 0..LANES {
            low[k] = smaller(block[k], low[k]);
            high[k] = larger(block[k], high[k]);
        }
    }
    // The halves are compared with each other again and again, so that no comparison waits for all others.
    const { assert!(LANES == 8, "the loop below halves eight lanes") }
    for half in [4, 2, 1] {
        for k in 0..half {
            low[k] = smaller(low[k + half], low[k]);
            high[k] = larger(high[k + half], high[k]);
        }
    }
    (low[0], high[0])
}

/// The smaller of two numbers in one instruction; `f64::min` also handles NaN.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers, as [`smaller`].
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
