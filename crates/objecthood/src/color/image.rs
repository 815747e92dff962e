//! The colour of a frame as `context` compares it: L\*a\*b\*, at half the resolution.

use std::ops::Index;

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::color::{light_of_values, nearly_lab};
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
    /// Converts an sRGB image. The mean is taken in linear light, over the pixels with depth; over all in a cell that has none. Where the
    /// image ends within a cell, its last pixels count twice. Source: ours, because the paper smooths RGB by its own eq. 1, and a
    /// comparison of colours needs a space of equal steps. O(pixels); parallel over rows.
    pub fn new(color: &Raster<[u8; 3]>, depth_m: &Raster<f32>) -> Self {
        let (width, height) = color.size();
        let (columns, rows) = (width.div_ceil(2), height.div_ceil(2));
        let mut cells = Buffer::stale(columns * rows, [0.0; 3]);
        let light = light_of_values();
        cells.par_chunks_mut(columns).enumerate().for_each(|(row, cells)| {
            let rows = [2 * row, (2 * row + 1).min(height - 1)];
            let row = |v: usize| v * width..(v + 1) * width;
            let (depths_m, rows) =
                (rows.map(|v| &depth_m.as_slice()[row(v)]), rows.map(|v| &color.as_slice()[row(v)]));
            let colors = rows[0].chunks(2).zip(rows[1].chunks(2));
            let depths_m = depths_m[0].chunks(2).zip(depths_m[1].chunks(2));
            for (cell, ((above, below), (above_m, below_m))) in cells.iter_mut().zip(colors.zip(depths_m)) {
                let ([first, second], [third, fourth]) = (pair(above), pair(below));
                let has_depth = [pair(above_m), pair(below_m)].map(|pair| pair.map(|z_m| !z_m.is_nan()));
                *cell = mean([first, second, third, fourth], has_depth.as_flattened(), light);
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

    /// The colours of the cells in this row of cells.
    #[inline]
    pub(crate) fn row_of_cells(&self, row: usize) -> &[[f32; 3]] {
        &self.cells.as_slice()[row * self.cells.width()..][..self.cells.width()]
    }

    /// An image of these colours, one for each pixel; a cell has that of its first.
    #[cfg(test)]
    pub(crate) fn drawn((width, height): (usize, usize), color: impl Fn(usize, usize) -> [f32; 3]) -> Self {
        let columns = width.div_ceil(2);
        let cells = (0..columns * height.div_ceil(2)).map(|i| color(2 * (i % columns), 2 * (i / columns)));
        Self { cells: Raster::from_vec(columns, height.div_ceil(2), cells.collect()).unwrap(), width }
    }
}

/// Two pixels of a row of a cell. The last one of the image may stand for both.
#[inline]
fn pair<T: Copy>(pixels: &[T]) -> [T; 2] {
    [pixels[0], pixels[pixels.len() - 1]]
}

/// The mean light of the pixels of a cell that have depth; of all where none has. `light`: that of each value.
#[inline]
fn mean(pixels: [[u8; 3]; 4], has_depth: &[bool], light: &[f32; 256]) -> [f32; 3] {
    let seen = has_depth.iter().filter(|seen| **seen).count();
    let of = |k: usize, pixel: usize| light[usize::from(pixels[pixel][k])];
    if seen == 0 || seen == pixels.len() {
        return std::array::from_fn(|k| 0.25 * (of(k, 0) + of(k, 1) + of(k, 2) + of(k, 3)));
    }
    let weight = 1.0 / seen as f32;
    let counted = || (0..pixels.len()).filter(|&pixel| has_depth[pixel]);
    std::array::from_fn(|k| counted().fold(0.0, |sum, pixel| sum + weight * of(k, pixel)))
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

    fn seen(width: usize, height: usize) -> Raster<f32> {
        Raster::filled(width, height, 1.0).unwrap()
    }

    #[test]
    fn every_pixel_has_the_color_of_its_cell_also_at_odd_sizes() {
        let (left, right) = ([200, 30, 60], [20, 90, 160]);
        for (width, height) in [(8, 6), (7, 5), (1, 1)] {
            let pixels = (0..width * height).map(|i| if i % width < 4 { left } else { right }).collect();
            let image =
                LabImage::new(&Raster::from_vec(width, height, pixels).unwrap(), &seen(width, height));
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
        let image = LabImage::new(&Raster::from_vec(2, 1, vec![[255; 3], [0; 3]]).unwrap(), &seen(2, 1));
        assert!(
            (image[0][0] - 76.07).abs() < 0.1 && image[0] == image[1],
            "half the light of white: {:?}",
            image[0]
        );
    }

    #[test]
    fn pixels_without_depth_do_not_count_beside_others() {
        let color = Raster::from_vec(4, 1, vec![[255; 3], [0; 3], [255; 3], [0; 3]]).unwrap();
        let depth_m = Raster::from_vec(4, 1, vec![1.0, f32::NAN, f32::NAN, f32::NAN]).unwrap();
        let image = LabImage::new(&color, &depth_m);
        assert!((image[0][0] - 100.0).abs() < 0.1, "white alone: {:?}", image[0]);
        assert!((image[2][0] - 76.07).abs() < 0.1, "none has depth: {:?}", image[2]);
    }
}
