//! The image in cells of 2 x 2 pixels, as colour has it, within a frame of one cell that is outside
//! (docs/CONTEXT.md 1.1.9).

use std::ops::Range;

use crate::buffers::Buffer;
use crate::color::image::LabImage;
use crate::raster::Raster;
use crate::regions::{connect, runs};

/// A cell with a measured pixel of no surface.
pub(super) const BARE: i32 = -1;
/// A cell without a measured pixel: what colour it has must not count.
const HOLE: i32 = -2;
/// A measured pixel of no surface decides, whatever the others of its cell are.
const DECIDES: i32 = i32::MAX;
/// A cell beyond the border of the image.
const OUTSIDE: i32 = -3;

/// The surface of every cell.
pub(super) struct Cells {
    /// The surface of all its measured pixels, [`BARE`], [`HOLE`] or [`OUTSIDE`].
    pub of: Raster<i32>,
    /// Columns and rows of the image.
    size: (usize, usize),
}

impl Cells {
    /// The cells of the pixels' `labels`. O(pixels).
    pub(super) fn of(labels: &Raster<i32>, disparity: &Raster<f32>) -> Self {
        let (width, height) = labels.size();
        let columns = width.div_ceil(2) + 2;
        let rows = height.div_ceil(2) + 2;
        let mut of = Raster::of_buffer(columns, rows, Buffer::filled(columns * rows, OUTSIDE));
        let row = |v: usize| v * width..(v + 1) * width;
        // Of each two pixels of a column what decides.
        let mut most = vec![[HOLE; 2]; width.div_ceil(2)];
        for (cells, top) in of.as_mut_slice().chunks_exact_mut(columns).skip(1).zip((0..height).step_by(2)) {
            most.fill([HOLE; 2]);
            for v in top..(top + 2).min(height) {
                let pixels = labels.as_slice()[row(v)].iter().zip(&disparity.as_slice()[row(v)]);
                for (most, (label, d)) in most.as_flattened_mut().iter_mut().zip(pixels) {
                    let free = if d.is_nan() { HOLE } else { DECIDES };
                    *most = (*most).max(if *label >= 0 { *label } else { free });
                }
            }
            for (cell, [one, other]) in cells[1..].iter_mut().zip(&most) {
                let most = *one.max(other);
                *cell = if most == DECIDES { BARE } else { most };
            }
        }
        Self { of, size: (width, height) }
    }

    pub(super) fn count(&self) -> usize {
        self.of.len()
    }

    /// Cells in a row, with the two outside.
    fn columns(&self) -> usize {
        self.of.width()
    }

    /// Whether a cell is of a surface.
    pub(super) fn is_surface(&self, cell: usize) -> bool {
        self.of[cell] >= 0
    }

    /// The pixels of a cell of the image.
    pub(super) fn pixels(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = self.size;
        let [column, row] = self.place(cell);
        let rows = 2 * row..(2 * row + 2).min(height);
        rows.flat_map(move |v| (2 * column..(2 * column + 2).min(width)).map(move |u| v * width + u))
    }

    /// The cells beside a cell of the image.
    pub(super) fn around(&self, cell: usize) -> [usize; 4] {
        [cell + 1, cell - 1, cell + self.columns(), cell - self.columns()]
    }

    pub(super) fn color(&self, cell: usize, lab: &LabImage) -> [f32; 3] {
        let [column, row] = self.place(cell);
        lab.cell(column, row)
    }

    /// The mean colour of some of the cells within a distance of a cell; `None` if there are none.
    pub(super) fn mean_color(
        &self,
        cell: usize,
        distance: usize,
        lab: &LabImage,
        counts: impl Fn(usize) -> bool,
    ) -> Option<[f32; 3]> {
        let [column, row] = self.place(cell);
        let [columns, rows] = [self.size.0.div_ceil(2), self.size.1.div_ceil(2)];
        let near = |at: usize, all: usize| at.saturating_sub(distance)..(at + distance + 1).min(all);
        let (mut sum, mut count) = ([0.0_f32; 3], 0_u32);
        let columns = near(column, columns);
        for row in near(row, rows) {
            let first = (row + 1) * self.columns() + 1;
            let colors = &lab.row_of_cells(row)[columns.clone()];
            for (cell, color) in (first + columns.start..).zip(colors) {
                if counts(cell) {
                    sum = std::array::from_fn(|k| sum[k] + color[k]);
                    count += 1;
                }
            }
        }
        (count > 0).then(|| sum.map(|sum| sum / count as f32))
    }

    /// Whether each cell is of a piece of its surface that is smaller than a share of it. O(cells).
    pub(super) fn specks(&self, share: f32) -> Vec<bool> {
        let runs: Vec<(Range<usize>, usize)> = runs(&self.of, 0..self.of.height()).collect();
        let mut sizes = vec![0_usize; runs.iter().map(|(_, surface)| surface + 1).max().unwrap_or(0)];
        runs.iter().for_each(|(run, surface)| sizes[*surface] += run.len());
        let (piece_of, pieces) = connect(&runs, self.columns());
        let mut piece_cells = vec![0_usize; pieces];
        for ((run, _), &piece) in runs.iter().zip(&piece_of) {
            piece_cells[piece as usize] += run.len();
        }
        let mut is_speck = vec![false; self.count()];
        for ((run, surface), piece) in runs.into_iter().zip(piece_of) {
            is_speck[run].fill((piece_cells[piece as usize] as f32) < share * sizes[surface] as f32);
        }
        is_speck
    }

    /// Column and row of a cell of the image, from 0.
    fn place(&self, cell: usize) -> [usize; 2] {
        [cell % self.columns() - 1, cell / self.columns() - 1]
    }
}
