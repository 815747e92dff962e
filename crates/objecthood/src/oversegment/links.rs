//! Which neighbouring pixels lie on one surface (docs/CONTEXT.md 1.2).

use std::ops::Range;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;

/// The links between measured pixels outside the structure: which 4-neighbours lie on one surface.
#[derive(Debug)]
pub struct Links {
    /// For each pixel the bits `RIGHT`, `LEFT`, `DOWN`, `UP` and `FREE`.
    pub(super) sides: Raster<u8>,
}

/// Bit: the pixel is linked to its right neighbour.
pub(super) const RIGHT: u8 = 1;
/// Bit: the pixel is linked to its left neighbour.
const LEFT: u8 = 2 * RIGHT;
/// Bit: the pixel is linked to the neighbour below.
pub(super) const DOWN: u8 = 4;
/// Bit: the pixel is linked to the neighbour above.
const UP: u8 = 2 * DOWN;
/// Bit: the pixel is free, that is measured and no structure.
pub(super) const FREE: u8 = 16;

/// A link allows for this share of the disparity by which sideways noise moves a pixel on the slope.
const NOISE_SHARE: f32 = 0.5;
/// Pixels of a row that are skipped together when none of them is free.
pub(super) const STRETCH: usize = 64;

impl Links {
    /// Links two 4-neighbours when the difference of their disparities agrees with the slope of one of them, within
    /// `link_jump_quanta` plus the effect of sideways noise. `slope`: change of disparity along u and v (quanta/px). `structure`:
    /// -1 = none. O(pixels); parallel over rows, but for the links upwards, which are one pass over the bytes.
    pub fn new(
        disparity: &Raster<f32>,
        slope: &Raster<[f32; 2]>,
        structure: &Raster<i32>,
        space: &DisparitySpace,
        params: &params::Watershed,
    ) -> Self {
        let rule = LinkRule {
            disparity,
            slope,
            structure,
            jump_quanta: space.noise().step_scale() as f32 * params.link_jump_quanta,
            lateral_noise_px: space.lateral_noise_px() as f32,
        };
        let mut sides = Buffer::stale(disparity.len(), 0);
        sides.par_chunks_mut(disparity.width()).enumerate().for_each(|(v, sides)| {
            vectorized(
                #[inline(always)]
                || {
                    for (k, sides) in sides.chunks_mut(STRETCH).enumerate() {
                        rule.link_stretch(v, k * STRETCH, sides);
                    }
                    link_back(sides);
                },
            );
        });
        link_up(&mut sides, disparity.width());
        Self { sides: disparity.with_data(sides) }
    }

    /// The linked neighbours of pixel `i`: right, left, below, above.
    #[inline]
    pub(super) fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> {
        let (sides, width) = (self.sides[i], self.sides.width());
        let to = [(RIGHT, 1), (LEFT, 1_usize.wrapping_neg()), (DOWN, width), (UP, width.wrapping_neg())];
        to.into_iter().filter(move |(side, _)| sides & side != 0).map(move |(_, step)| i.wrapping_add(step))
    }
}

/// Links pixels of a row to those on their left that are linked to them.
#[inline(always)]
fn link_back(sides: &mut [u8]) {
    for left in (1..sides.len()).step_by(STRETCH) {
        // Copied, so that the loop can be vectorised.
        let end = sides.len().min(left + STRETCH);
        let mut before = [0; STRETCH];
        before[..end - left].copy_from_slice(&sides[left - 1..end - 1]);
        sides[left..end].iter_mut().zip(before).for_each(|(sides, before)| *sides |= 2 * (before & RIGHT));
    }
}

/// Links pixels to those above that are linked to them.
fn link_up(sides: &mut [u8], width: usize) {
    vectorized(
        #[inline(always)]
        || {
            for v in 1..sides.len() / width {
                let (above, below) = sides.split_at_mut(v * width);
                let above = &above[(v - 1) * width..];
                below.iter_mut().zip(above).for_each(|(sides, above)| *sides |= 2 * (above & DOWN));
            }
        },
    );
}

/// The inputs of the decision about links.
struct LinkRule<'a> {
    disparity: &'a Raster<f32>,
    slope: &'a Raster<[f32; 2]>,
    structure: &'a Raster<i32>,
    jump_quanta: f32,
    lateral_noise_px: f32,
}

/// Some pixels of one row.
#[derive(Clone, Copy)]
struct Pixels<'a> {
    disparity: &'a [f32],
    slope: &'a [[f32; 2]],
    structure: &'a [i32],
}

impl<'a> LinkRule<'a> {
    /// Writes the `sides` of pixels of row `v` from column `left` on, without those to the left and above.
    #[inline(always)]
    fn link_stretch(&self, v: usize, left: usize, sides: &mut [u8]) {
        let (width, height) = self.disparity.size();
        let right = left + sides.len();
        let own = self.pixels(v, left..right);
        own.mark_free(sides);
        if sides.iter().fold(0, |any, sides| any | sides) == 0 {
            return;
        }
        // The right neighbour lies in the image before column `outer`.
        let outer = right.min(width - 1);
        let to_right = [self.pixels(v, left..outer), self.pixels(v, left + 1..outer + 1)];
        self.link(to_right, 0, RIGHT, &mut sides[..outer - left]);
        if v + 1 < height {
            self.link([own, self.pixels(v + 1, left..right)], 1, DOWN, sides);
        }
    }

    #[inline(always)]
    fn pixels(&self, v: usize, columns: Range<usize>) -> Pixels<'a> {
        let first = v * self.disparity.width();
        let part = first + columns.start..first + columns.end;
        Pixels {
            disparity: &self.disparity.as_slice()[part.clone()],
            slope: &self.slope.as_slice()[part.clone()],
            structure: &self.structure.as_slice()[part],
        }
    }

    /// Marks with `side` the pixels that are linked to the next one along the axis (0: to the right, 1: downwards).
    #[inline(always)]
    fn link(&self, [own, next]: [Pixels<'_>; 2], axis: usize, side: u8, sides: &mut [u8]) {
        let own = own.disparity.iter().zip(own.slope).zip(own.structure);
        let next = next.disparity.iter().zip(next.slope).zip(next.structure);
        for (sides, (((d_i, slope_i), structure_i), ((d_j, slope_j), structure_j))) in
            sides.iter_mut().zip(own.zip(next))
        {
            let (rise, rise_i, rise_j) = (d_j - d_i, slope_i[axis], slope_j[axis]);
            // NaN when one of the disparities is missing; then the comparison fails.
            let misfit = (rise - rise_i).abs().min((rise - rise_j).abs());
            let limit =
                self.jump_quanta + NOISE_SHARE * self.lateral_noise_px * rise_i.abs().min(rise_j.abs());
            *sides |= side * u8::from((misfit < limit) & (structure_i & structure_j < 0));
        }
    }
}

impl Pixels<'_> {
    /// Marks the free pixels and clears all other marks.
    #[inline(always)]
    fn mark_free(&self, sides: &mut [u8]) {
        for ((sides, d), structure) in sides.iter_mut().zip(self.disparity).zip(self.structure) {
            *sides = FREE * u8::from(!d.is_nan() & (*structure < 0));
        }
    }
}
