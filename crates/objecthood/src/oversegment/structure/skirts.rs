//! Skirts: pixels of a surface whose measured depth rises towards a thing that stands on it (docs/CONTEXT.md
//! 1.1.9).
//!
//! Depth is measured over windows, and filled depth is smooth. So around the foot of a thing the measured
//! table rises towards it, and pixels of the background at its sides have the depth of the thing. Depth
//! cannot tell them from the thing, but they look like the surface.

mod cells;

use std::collections::VecDeque;

use self::cells::{BARE, Cells};
use crate::color::difference;
use crate::color::image::LabImage;
use crate::raster::Raster;

/// A colour that differs by less looks like the surface (Lab, lightness weighted): print and light change even faces by less.
const ALIKE: f32 = 11.0;
/// Colours on both sides of an edge differ by more than this (Lab, lightness weighted).
const EDGE: f32 = 16.0;
/// The share of each step in colour by which the reference colour follows: a shadow at a foot darkens slowly,
/// a blurred edge fast.
const FOLLOWED: f32 = 0.25;
/// The colour of a surface is the mean within this distance (cells).
const AROUND: usize = 4;
/// The colour beyond the end of a skirt is the mean within this distance (cells): more than the grain of a texture.
const BEYOND: usize = 2;
/// Pieces of a surface smaller than this share of it count only once the flood reaches them: a plate's bottom
/// lies within the tolerance of the table, but looks different.
const SPECK_SHARE: f32 = 0.01;

/// Gives skirts back to the surfaces that they belong to.
///
/// From the surfaces of the structure a flood takes the cells of 2 x 2 pixels that look like them, up to `reach_px` far (px of this
/// image). A cell that it took is a skirt if the nearest place where the flood ended is an edge of colour. Where it ended only because
/// it had come far enough, the thing looks like its surface, and depth decides. Returns the pixels given back, in scan order. Source:
/// ours, because colour is sharp where such depth is not. O(pixels).
pub(super) fn reclaim_skirts(
    labels: &mut Raster<i32>,
    disparity: &Raster<f32>,
    lab: &LabImage,
    reach_px: usize,
) -> Vec<u32> {
    let cells = Cells::of(labels, disparity);
    let flood = Flood::from_surfaces(&cells, lab, (reach_px / 2).max(1) as u32);
    let mut skirts = Vec::new();
    for (cell, surface) in flood.skirts(lab) {
        for i in cells.pixels(cell) {
            if labels[i] < 0 && !disparity[i].is_nan() {
                labels.as_mut_slice()[i] = surface;
                skirts.push(i as u32);
            }
        }
    }
    skirts.sort_unstable();
    skirts
}

/// A cell that the flood reached.
#[derive(Clone, Copy)]
struct Reached {
    /// The surface that it came from.
    surface: i32,
    /// Steps from that surface.
    steps: u32,
    /// The colour that is looked for from here.
    color: [f32; 3],
}

/// How a flood ended.
#[derive(Clone, Copy, PartialEq)]
enum End {
    /// At an edge of colour.
    Edge,
    /// It had come far enough, or what lies beyond looks alike after all.
    Open,
}

/// The cells that look like a surface near them.
struct Flood<'a> {
    cells: &'a Cells,
    reach: u32,
    reached: Vec<Option<Reached>>,
    /// The cells that it took, in its order.
    taken: Vec<usize>,
}

impl<'a> Flood<'a> {
    fn from_surfaces(cells: &'a Cells, lab: &LabImage, reach: u32) -> Self {
        let mut flood = Self { cells, reach, reached: vec![None; cells.count()], taken: Vec::new() };
        let mut open = VecDeque::new();
        let is_speck = cells.specks(SPECK_SHARE);
        let start = |cell: usize| {
            let surface = cells.of[cell];
            let color = cells.mean_color(cell, AROUND, lab, |other| cells.of[other] == surface);
            color.map(|color| Reached { surface, steps: 0, color })
        };
        for cell in (0..cells.count()).filter(|&cell| cells.is_surface(cell) && !is_speck[cell]) {
            if cells.around(cell).into_iter().any(|next| cells.of[next] == BARE) {
                flood.reached[cell] = start(cell);
                open.push_back(cell);
            }
        }
        while let Some(cell) = open.pop_front() {
            let Some(from) = flood.reached[cell].filter(|from| from.steps < reach) else { continue };
            for next in cells.around(cell) {
                let may_take = cells.of[next] == BARE || is_speck[next];
                if !may_take || flood.reached[next].is_some() {
                    continue;
                }
                let own = cells.color(next, lab);
                if difference(own, from.color) > ALIKE {
                    continue;
                }
                let color = std::array::from_fn(|k| from.color[k] + FOLLOWED * (own[k] - from.color[k]));
                if is_speck[next] {
                    flood.reached[next] = start(next);
                } else {
                    flood.reached[next] = Some(Reached { steps: from.steps + 1, color, ..from });
                    flood.taken.push(next);
                }
                open.push_back(next);
            }
        }
        flood
    }

    /// The cells whose nearest end is an edge of colour, each with its surface.
    fn skirts(&self, lab: &LabImage) -> Vec<(usize, i32)> {
        let mut ends: Vec<Option<End>> = vec![None; self.cells.count()];
        let mut open = VecDeque::new();
        let own: Vec<Option<End>> = self.taken.iter().map(|&cell| self.end(cell, lab)).collect();
        for kind in [End::Open, End::Edge] {
            for (&cell, _) in self.taken.iter().zip(&own).filter(|(_, end)| **end == Some(kind)) {
                ends[cell] = Some(kind);
                open.push_back(cell);
            }
        }
        while let Some(cell) = open.pop_front() {
            for next in self.cells.around(cell) {
                if self.is_taken(next) && ends[next].is_none() {
                    ends[next] = ends[cell];
                    open.push_back(next);
                }
            }
        }
        let skirts = self.taken.iter().filter(|&&cell| ends[cell] == Some(End::Edge));
        skirts.filter_map(|&cell| Some((cell, self.reached[cell]?.surface))).collect()
    }

    /// How the flood ended at a cell that it took; `None` if it went on in all directions.
    fn end(&self, cell: usize, lab: &LabImage) -> Option<End> {
        let reached = self.reached[cell]?;
        let mut end = None;
        for beyond in self.cells.around(cell).into_iter().filter(|&next| self.is_bare(next)) {
            let color = self.cells.mean_color(beyond, BEYOND, lab, |other| self.is_bare(other))?;
            let is_edge = reached.steps < self.reach && difference(color, reached.color) > EDGE;
            if !is_edge {
                return Some(End::Open);
            }
            end = Some(End::Edge);
        }
        end
    }

    fn is_taken(&self, cell: usize) -> bool {
        self.cells.of[cell] == BARE && self.reached[cell].is_some()
    }

    /// Whether a cell is measured, and neither of a surface nor taken.
    fn is_bare(&self, cell: usize) -> bool {
        self.cells.of[cell] == BARE && self.reached[cell].is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (120, 60);
    const REACH_PX: usize = 20;
    const TABLE: [f32; 3] = [70.0, 10.0, 20.0];
    const THING: [f32; 3] = [40.0, 40.0, -30.0];

    /// The surface after skirts were given back: it ends at column 40, and colours begin at the given columns.
    fn reclaimed(colors: &[(usize, [f32; 3])]) -> usize {
        let color =
            |u: usize| colors.iter().rev().find(|(from, _)| u >= *from).map_or(TABLE, |found| found.1);
        let lab = LabImage::drawn(SIZE, |u, _| color(u));
        let disparity = Raster::filled(SIZE.0, SIZE.1, 400.0_f32).unwrap();
        let label = |i: usize| if i % SIZE.0 < 40 { 0 } else { -1 };
        let mut labels = disparity.with_data((0..disparity.len()).map(label).collect());
        reclaim_skirts(&mut labels, &disparity, &lab, REACH_PX);
        let ends: Vec<usize> =
            labels.as_slice().chunks(SIZE.0).map(|row| row.iter().filter(|&&s| s == 0).count()).collect();
        assert!(ends.iter().all(|&end| end == ends[0]), "{ends:?}");
        ends[0]
    }

    #[test]
    fn a_skirt_goes_to_the_edge_of_color() {
        assert_eq!(reclaimed(&[(50, THING)]), 50);
        let shaded = [60.0, 9.0, 18.0];
        assert_eq!(reclaimed(&[(44, shaded), (50, THING)]), 50, "a shadow at the foot");
        assert_eq!(reclaimed(&[(40, THING)]), 40, "no skirt");
    }

    #[test]
    fn depth_decides_where_a_thing_looks_like_its_surface() {
        assert_eq!(reclaimed(&[]), 40);
        assert_eq!(reclaimed(&[(60, THING)]), 40, "farther than a skirt reaches");
    }

    #[test]
    fn a_small_speck_that_looks_otherwise_is_no_place_to_start_from() {
        // A plate of one colour on a table of another; its bottom is taken for the table.
        let is_plate = |u: usize, v: usize| (60..90).contains(&u) && (20..40).contains(&v);
        let is_bottom = |u: usize, v: usize| (72..78).contains(&u) && (28..32).contains(&v);
        let lab = LabImage::drawn(SIZE, |u, v| if is_plate(u, v) { THING } else { TABLE });
        let disparity = Raster::filled(SIZE.0, SIZE.1, 400.0_f32).unwrap();
        let at = |i: usize| (i % SIZE.0, i / SIZE.0);
        let label = |i: usize| {
            let (u, v) = at(i);
            if is_plate(u, v) && !is_bottom(u, v) { -1 } else { 0 }
        };
        let before: Raster<i32> = disparity.with_data((0..disparity.len()).map(label).collect());
        let mut labels = before.clone();
        reclaim_skirts(&mut labels, &disparity, &lab, REACH_PX);
        assert_eq!(labels.as_slice(), before.as_slice());
    }
}
