//! The connected parts of the two sides of a split of colours.

use std::ops::Range;

use crate::raster::{PixelBox, Raster};
use crate::regions::{connect, runs};

/// A pixel takes the side of most pixels of the facet that are at most so many columns and rows away (px). Two or
/// three cells of colour each way, at any focal length.
const SMOOTH_PX: usize = 2;
/// Small parts go to the other side this many times: they may surround each other.
const ROUNDS: usize = 4;

/// More connected areas than this, with the small ones, are texture: beside things there are few specks.
const MOST_AREAS: usize = 16;

/// The side of each pixel of a facet, within its bounds.
pub(super) struct Sides {
    /// 0 below, 1 above; -1 outside of the facet.
    sides: Raster<i32>,
    bounds: PixelBox,
    /// Columns of the image.
    width: usize,
}

/// A connected part of one side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) is_above: bool,
    /// In scan order.
    pub(super) pixels: Vec<u32>,
}

impl Sides {
    /// The sides of the pixels of these runs of an image of this width, by column and row. There is at least one run.
    pub(super) fn of(runs: &[Range<usize>], width: usize, is_above: impl Fn(usize, usize) -> bool) -> Self {
        // A run lies in one row.
        let ends = runs.iter().flat_map(|run| [run.start, run.end - 1]);
        let bounds = PixelBox::around(ends, width);
        let mut sides = vec![-1; bounds.width * bounds.height];
        for run in runs {
            let (first, v) = (run.start % width, run.start / width);
            let row = &mut sides[(v - bounds.v) * bounds.width + first - bounds.u..][..run.len()];
            row.iter_mut().enumerate().for_each(|(k, side)| *side = i32::from(is_above(first + k, v)));
        }
        Self { sides: Raster::of_buffer(bounds.width, bounds.height, sides.into()), bounds, width }
    }

    /// Each pixel on the side of most pixels around it, so that noise and thin print make no parts. O(bounds).
    pub(super) fn smoothed(self) -> Self {
        // Pixels are counted in the low bits of a sum, those above in the high bits.
        let counted = self.sides.map(|&side| if side < 0 { 0 } else { 1 + (side << 16) });
        let (width, height) = counted.size();
        let mut across = vec![0; width * height];
        for (sums, row) in across.chunks_mut(width).zip(counted.as_slice().chunks(width)) {
            add(sums, row);
            for k in 1..=SMOOTH_PX.min(width) {
                add(sums, &row[k..]);
                add(&mut sums[k..], row);
            }
        }
        let mut sides = self.sides;
        let mut sums = vec![0; width];
        for (v, row) in sides.as_mut_slice().chunks_mut(width).enumerate() {
            sums.fill(0);
            let around = v.saturating_sub(SMOOTH_PX)..(v + SMOOTH_PX + 1).min(height);
            across[around.start * width..around.end * width]
                .chunks(width)
                .for_each(|other| add(&mut sums, other));
            for (side, sum) in row.iter_mut().zip(&sums) {
                let (above, below) = (sum >> 16, (sum & 0xffff) - (sum >> 16));
                let keeps = *side < 0 || above == below;
                *side = if keeps { *side } else { i32::from(above > below) };
            }
        }
        Self { sides, ..self }
    }

    /// The parts, in the order of their first pixels. Parts of fewer than `least_px` pixels belong to the other side; `None` if small ones
    /// remain, or of a texture. O(bounds + runs log runs).
    pub(super) fn into_parts(mut self, least_px: usize) -> Option<Vec<Part>> {
        let (width, height) = self.sides.size();
        for _ in 0..=ROUNDS {
            let all: Vec<(Range<usize>, usize)> = runs(&self.sides, 0..height).collect();
            let (part_of, count) = connect(&all, width);
            if count > MOST_AREAS {
                return None;
            }
            let mut sizes_px = vec![0; count];
            for ((run, _), part) in all.iter().zip(&part_of) {
                sizes_px[*part as usize] += run.len();
            }
            let is_small = |part: u32| sizes_px[part as usize] < least_px;
            if !part_of.iter().copied().any(is_small) {
                return Some(self.gather(all.into_iter().zip(part_of), count));
            }
            let small = all.into_iter().zip(part_of).filter(|(_, part)| is_small(*part));
            for ((run, side), _) in small {
                self.sides.as_mut_slice()[run].fill(1 - side as i32);
            }
        }
        None
    }

    fn gather(&self, runs: impl Iterator<Item = ((Range<usize>, usize), u32)>, count: usize) -> Vec<Part> {
        let mut parts = vec![Part { is_above: false, pixels: Vec::new() }; count];
        for ((run, side), part) in runs {
            let (row, column) = (run.start / self.bounds.width, run.start % self.bounds.width);
            let first = ((row + self.bounds.v) * self.width + column + self.bounds.u) as u32;
            let part = &mut parts[part as usize];
            part.is_above = side == 1;
            part.pixels.extend(first..first + run.len() as u32);
        }
        parts
    }
}

/// Adds values to sums, as many as both have.
fn add(sums: &mut [i32], values: &[i32]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

    use proptest::prelude::*;

    use super::*;
    use crate::testing::raster;

    /// The sides of the pixels of a drawing that are not -1.
    fn drawn(drawing: &Raster<i32>) -> Option<Sides> {
        let is_seen = |i: &usize| drawing[*i] >= 0;
        let pixels: Vec<Range<usize>> = (0..drawing.len()).filter(is_seen).map(|i| i..i + 1).collect();
        let side = |u: usize, v: usize| drawing[v * drawing.width() + u] == 1;
        (!pixels.is_empty()).then(|| Sides::of(&pixels, drawing.width(), side))
    }

    proptest! {
        /// Window by window, pixel by pixel.
        #[test]
        fn smoothed_sides_are_those_of_most_pixels_around(
            drawing in (1_usize..12, 1_usize..12).prop_flat_map(|size| raster(size, -1_i32..2)),
        ) {
            let Some(sides) = drawn(&drawing) else { return Ok(()) };
            let PixelBox { u: left, v: top, width, height } = sides.bounds;
            let before = sides.sides.clone();
            let after = sides.smoothed().sides;
            for (u, v) in (0..height).flat_map(|v| (0..width).map(move |u| (u, v))) {
                let own = drawing[(v + top) * drawing.width() + u + left];
                prop_assert_eq!(before[v * width + u], own);
                let near = |a: usize, b: usize| a.abs_diff(b) <= SMOOTH_PX;
                let around = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
                let around = around.filter(|&(x, y)| near(x, u) && near(y, v)).map(|(x, y)| before[y * width + x]);
                let seen: Vec<i32> = around.filter(|side| *side >= 0).collect();
                let above = seen.iter().filter(|side| **side == 1).count();
                let expected = match (2 * above).cmp(&seen.len()) {
                    _ if own < 0 => -1,
                    Ordering::Equal => own,
                    most => i32::from(most == Ordering::Greater),
                };
                prop_assert_eq!(after[v * width + u], expected);
            }
        }

        #[test]
        fn every_pixel_of_the_facet_is_in_one_part(
            drawing in (1_usize..12, 1_usize..12).prop_flat_map(|size| raster(size, -1_i32..2)),
            least_px in 0_usize..6,
        ) {
            let Some(parts) = drawn(&drawing).and_then(|sides| sides.into_parts(least_px)) else { return Ok(()) };
            prop_assert!(parts.iter().all(|part| part.pixels.len() >= least_px && part.pixels.is_sorted()));
            let mut pixels: Vec<u32> = parts.into_iter().flat_map(|part| part.pixels).collect();
            pixels.sort_unstable();
            let all: Vec<u32> = (0..drawing.len() as u32).filter(|&i| drawing[i as usize] >= 0).collect();
            prop_assert_eq!(pixels, all);
        }
    }

    #[test]
    fn a_speck_belongs_to_the_side_around_it() {
        let is_above = |u: usize, v: usize| u >= 10 || (u, v) == (3, 3);
        let drawing = (0..20 * 8).map(|i| i32::from(is_above(i % 20, i / 20))).collect();
        let sides = drawn(&Raster::from_vec(20, 8, drawing).unwrap()).unwrap();
        let parts = sides.into_parts(2).unwrap();
        assert_eq!(
            parts.iter().map(|part| (part.is_above, part.pixels.len())).collect::<Vec<_>>(),
            [(false, 80), (true, 80)]
        );
    }
}
