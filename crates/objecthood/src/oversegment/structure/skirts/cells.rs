//! The image in cells of 2 x 2 pixels, as colour has it.

use crate::color::image::LabImage;
use crate::neighbours::four_neighbours;
use crate::raster::Raster;

/// A cell with a measured pixel of no surface.
pub(super) const BARE: i32 = -1;
/// A cell without a measured pixel.
const HOLE: i32 = -2;

/// The surface of every cell.
pub(super) struct Cells {
    /// The surface of all its measured pixels, [`BARE`] or [`HOLE`].
    pub of: Vec<i32>,
    columns: usize,
    rows: usize,
    /// Columns and rows of the image.
    size: (usize, usize),
}

impl Cells {
    /// The cells of the pixels' `labels`. O(pixels).
    pub(super) fn of(labels: &Raster<i32>, disparity: &Raster<f32>) -> Self {
        let size = labels.size();
        let (columns, rows) = (size.0.div_ceil(2), size.1.div_ceil(2));
        let mut cells = Self { of: vec![HOLE; columns * rows], columns, rows, size };
        for cell in 0..cells.count() {
            let measured = cells.pixels(cell).filter(|&i| labels[i] >= 0 || !disparity[i].is_nan());
            let (mut all, mut any) = (true, HOLE);
            for i in measured {
                all &= labels[i] >= 0;
                any = any.max(labels[i]);
            }
            cells.of[cell] = if all { any } else { BARE };
        }
        cells
    }

    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The pixels of a cell.
    pub(super) fn pixels(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = self.size;
        let (left, top) = (cell % self.columns * 2, cell / self.columns * 2);
        let rows = top..(top + 2).min(height);
        rows.flat_map(move |v| (left..(left + 2).min(width)).map(move |u| v * width + u))
    }

    /// The cells beside a cell.
    pub(super) fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        four_neighbours(cell, self.columns, self.rows).map(|(next, _)| next)
    }

    pub(super) fn color(&self, cell: usize, lab: &LabImage) -> [f32; 3] {
        lab.cell(cell % self.columns, cell / self.columns)
    }

    /// The mean colour of some of the cells within a distance of a cell; `None` if there are none.
    pub(super) fn mean_color(
        &self,
        cell: usize,
        distance: usize,
        lab: &LabImage,
        counts: impl Fn(usize) -> bool,
    ) -> Option<[f32; 3]> {
        let (column, row) = (cell % self.columns, cell / self.columns);
        let columns = column.saturating_sub(distance)..(column + distance + 1).min(self.columns);
        let rows = row.saturating_sub(distance)..(row + distance + 1).min(self.rows);
        let cells = rows.flat_map(|row| columns.clone().map(move |column| row * self.columns + column));
        let (mut sum, mut count) = ([0.0_f32; 3], 0_u32);
        for color in cells.filter(|&cell| counts(cell)).map(|cell| self.color(cell, lab)) {
            sum = std::array::from_fn(|k| sum[k] + color[k]);
            count += 1;
        }
        (count > 0).then(|| sum.map(|sum| sum / count as f32))
    }

    /// Whether each cell is of a piece of its surface that is smaller than a share of it. O(cells).
    pub(super) fn islands(&self, share: f32) -> Vec<bool> {
        let surfaces = self.of.iter().max().map_or(0, |&last| (last + 1).max(0) as usize);
        let mut sizes = vec![0_usize; surfaces];
        self.of.iter().filter(|&&surface| surface >= 0).for_each(|&surface| sizes[surface as usize] += 1);
        let (mut is_met, mut is_island) = (vec![false; self.count()], vec![false; self.count()]);
        for start in (0..self.count()).filter(|&cell| self.of[cell] >= 0) {
            if std::mem::replace(&mut is_met[start], true) {
                continue;
            }
            let mut piece = vec![start];
            let mut next = 0;
            while let Some(&cell) = piece.get(next) {
                next += 1;
                for other in self.around(cell).filter(|&other| self.of[other] == self.of[start]) {
                    if !std::mem::replace(&mut is_met[other], true) {
                        piece.push(other);
                    }
                }
            }
            if (piece.len() as f32) < share * sizes[self.of[start] as usize] as f32 {
                piece.into_iter().for_each(|cell| is_island[cell] = true);
            }
        }
        is_island
    }
}
