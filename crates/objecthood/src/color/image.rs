//! The colour of a frame as `context` compares it: L\*a\*b\*, at half the resolution.

use std::ops::Index;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::color::{linear, nearly_lab};
use crate::raster::Raster;
use crate::simd::vectorized;

/// L\*a\*b\* (L in 0..100, a and b about -128..128) of cells of 2 x 2 pixels.
///
/// The mean of four pixels has half their noise, and costs a quarter of their conversion. Indexed by pixels in scan order.
#[derive(Clone, Debug)]
pub struct LabImage {
    cells: Raster<[f32; 3]>,
    /// Columns of the image.
    width: usize,
}

impl LabImage {
    /// Converts an sRGB image. The mean is taken in linear light; where the image ends within a cell, its last pixels count twice. Source:
    /// ours, because the paper smooths RGB by its own eq. 1, and a comparison of colours needs a space of equal steps. O(pixels);
    /// parallel over rows.
    pub fn new(color: &Raster<[u8; 3]>) -> Self {
        let (width, height) = color.size();
        let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
        let mut cells = Buffer::stale(columns * rows, [0.0; 3]);
        cells.par_chunks_mut(columns).enumerate().for_each(|(row, cells)| {
            let rows = [2 * row, (2 * row + 1).min(height - 1)];
            let rows = rows.map(|v| &color.as_slice()[v * width..(v + 1) * width]);
            for (column, cell) in cells.iter_mut().enumerate() {
                let (left, right) = (2 * column, (2 * column + 1).min(width - 1));
                let light = rows.map(|row| [linear(row[left]), linear(row[right])]);
                *cell =
                    std::array::from_fn(|k| 0.25 * light.iter().flatten().map(|light| light[k]).sum::<f32>());
            }
            vectorized(
                #[inline(always)]
                || cells.iter_mut().for_each(|cell| *cell = nearly_lab(*cell)),
            );
        });
        Self { cells: Raster::of_buffer(columns, rows, cells), width }
    }

    /// The colour of the cell in this column and row of cells.
    #[inline]
    pub(crate) fn cell(&self, column: usize, row: usize) -> [f32; 3] {
        self.cells[row * self.cells.width() + column]
    }

    /// An image of these colours, one for each pixel; a cell has that of its first.
    #[cfg(test)]
    pub(crate) fn drawn((width, height): (usize, usize), color: impl Fn(usize, usize) -> [f32; 3]) -> Self {
        let columns = width.div_ceil(2);
        let cells = (0..columns * height.div_ceil(2)).map(|i| color(2 * (i % columns), 2 * (i / columns)));
        Self { cells: Raster::from_vec(columns, height.div_ceil(2), cells.collect()).unwrap(), width }
    }
}

/// The colour of the cell around pixel `i`.
impl Index<usize> for LabImage {
    type Output = [f32; 3];

    #[inline]
    fn index(&self, i: usize) -> &[f32; 3] {
        &self.cells[i / self.width / 2 * self.cells.width() + i % self.width / 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lab;

    #[test]
    fn every_pixel_has_the_color_of_its_cell_also_at_odd_sizes() {
        let (left, right) = ([200, 30, 60], [20, 90, 160]);
        for (width, height) in [(8, 6), (7, 5), (1, 1)] {
            let pixels = (0..width * height).map(|i| if i % width < 4 { left } else { right }).collect();
            let image = LabImage::new(&Raster::from_vec(width, height, pixels).unwrap());
            for i in 0..width * height {
                let expected = lab(if i % width < 4 { left } else { right });
                let distance: f32 = expected.iter().zip(image[i]).map(|(x, y)| (x - y).abs()).sum();
                assert!(distance < 0.01, "{i} of {width} x {height}: {distance}");
                assert_eq!(image[i], image.cell(i % width / 2, i / width / 2));
            }
        }
    }

    #[test]
    fn a_cell_is_the_mean_in_linear_light() {
        let image = LabImage::new(&Raster::from_vec(2, 1, vec![[255; 3], [0; 3]]).unwrap());
        assert!(
            (image[0][0] - 76.07).abs() < 0.1 && image[0] == image[1],
            "half the light of white: {:?}",
            image[0]
        );
    }
}
