//! Measures the sensor's noise in one frame: how much neighbouring blocks of a surface disagree (docs/CONTEXT.md 0.5).
//!
//! Noise of single pixels averages out in fits; waves of 16 to 40 px do not. So the residual of a small
//! window does not show whether a surface will fall apart into pieces. The disagreement of neighbouring
//! blocks does, and it needs no plane.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::noise::{KINECT_RESIDUAL_QUANTA, Reading, SIDES_PX};
use crate::quantile::element_at;
use crate::raster::Raster;
use crate::simd::vectorized;
use crate::surface::disparity::DisparitySpace;

/// Least side of the smallest block (px of this image).
const LEAST_SIDE_PX: usize = 4;
/// The share of the pairs of blocks below which the disagreement is read: blocks across edges disagree most.
const QUARTILE: f64 = 0.25;
/// With fewer pairs of blocks nothing is estimated.
const LEAST_PAIRS: usize = 40;
/// Every this many pixels along rows and columns a residual is read for the white noise.
const RESIDUAL_STEP_PX: usize = 8;

/// Measures the waves of the sensor in one frame: the disagreement (quanta) of neighbouring blocks of 8, 16 and 32 px.
///
/// It is the cost of merging two neighbouring blocks (as of two regions, docs/CONTEXT.md 2.1), first quartile over all pairs of blocks
/// whose pixels are all measured. Block sums of 8 px add up to those of 16 and 32 px. O(pixels), parallel over rows of blocks.
pub fn measure_waves(disparity: &Raster<f32>, space: &DisparitySpace) -> [Option<Reading>; 3] {
    let side = space.length_px(SIDES_PX[0]).max(LEAST_SIDE_PX);
    let mut blocks = Blocks::of(disparity, side);
    std::array::from_fn(|k| {
        if k > 0 {
            blocks = blocks.doubled();
        }
        blocks.disagreement(space)
    })
}

/// Measures the noise of single pixels: the median residual of the planes fitted around them, relative to a Kinect's. `None` without fits.
pub fn measure_white(residual: &Raster<f32>) -> Option<Reading> {
    let (width, height) = residual.size();
    let rows = (0..height).step_by(RESIDUAL_STEP_PX);
    let pixels = rows.flat_map(|v| (0..width).step_by(RESIDUAL_STEP_PX).map(move |u| v * width + u));
    let fitted = pixels.map(|i| f64::from(residual[i])).filter(|residual| residual.is_finite());
    let mut residuals: Buffer<f64> = fitted.collect();
    let samples = residuals.len();
    let median = |residuals: &mut Buffer<f64>| element_at(residuals, 0.5) / KINECT_RESIDUAL_QUANTA;
    (samples > 0).then(|| Reading { value: median(&mut residuals), samples })
}

/// Sums of disparity over the pixels of a block, x and y counted from its middle. Not numbers where a pixel is not measured.
#[derive(Clone, Copy)]
struct Sums {
    /// Σ d.
    d: f64,
    /// Σ d x.
    dx: f64,
    /// Σ d y.
    dy: f64,
}

impl Sums {
    const NONE: Self = Self { d: 0.0, dx: 0.0, dy: 0.0 };

    /// The sums of a block from those of its columns: Σ d and Σ d y. The first column is x right of the middle.
    fn of_columns(x: f64, d: &[f64], dy: &[f64]) -> Self {
        let at = (0..).map(|k| x + f64::from(k));
        let dx = at.zip(d).map(|(x, d)| x * d);
        Self { d: d.iter().sum(), dx: dx.sum(), dy: dy.iter().sum() }
    }

    /// Adds the sums of a block whose middle lies at (x, y).
    fn add_block(&mut self, [x, y]: [f64; 2], block: &Self) {
        self.d += block.d;
        self.dx += block.dx + x * block.d;
        self.dy += block.dy + y * block.d;
    }
}

/// Adds the pixels of a row y below the middle of blocks to the sums of columns.
#[inline(always)]
fn add_row(d: &mut [f64], dy: &mut [f64], row: &[f32], y: f64) {
    for ((sum, sum_y), disparity) in d.iter_mut().zip(dy).zip(row) {
        let disparity = f64::from(*disparity);
        *sum += disparity;
        *sum_y += disparity * y;
    }
}

/// Square blocks that tile the image.
struct Blocks {
    side_px: usize,
    columns: usize,
    /// Row by row.
    sums: Buffer<Sums>,
}

impl Blocks {
    fn of(disparity: &Raster<f32>, side: usize) -> Self {
        let (width, height) = disparity.size();
        let (columns, rows) = (width / side, height / side);
        let middle = (side as f64 - 1.0) / 2.0;
        let mut sums = Buffer::filled(columns * rows, Sums::NONE);
        // Nothing is rounded: places are halves of whole numbers, and disparities have 24 bits and differ by less than a factor of 200.
        // So the order of sums does not matter, and columns are summed side by side.
        let sum_row = |[d, dy]: &mut [Buffer<f64>; 2], (row, sums): (usize, &mut [Sums])| {
            d.fill(0.0);
            dy.fill(0.0);
            for y in 0..side {
                let line = &disparity.as_slice()[(row * side + y) * width..][..columns * side];
                vectorized(
                    #[inline(always)]
                    || add_row(d, dy, line, y as f64 - middle),
                );
            }
            for (sum, (d, dy)) in sums.iter_mut().zip(d.chunks(side).zip(dy.chunks(side))) {
                *sum = Sums::of_columns(-middle, d, dy);
            }
        };
        let columns_px = || [(); 2].map(|()| Buffer::filled(columns * side, 0.0));
        sums.par_chunks_mut(columns.max(1)).enumerate().for_each_init(columns_px, sum_row);
        Self { side_px: side, columns, sums }
    }

    /// Blocks of twice the side.
    fn doubled(&self) -> Self {
        let (columns, rows) = (self.columns / 2, self.sums.len() / self.columns.max(1) / 2);
        let shift = self.side_px as f64 / 2.0;
        let sum = |k: usize| {
            let (column, row) = (k % columns, k / columns);
            let mut sum = Sums::NONE;
            for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let block = &self.sums[(2 * row + y) * self.columns + 2 * column + x];
                sum.add_block([x, y].map(|side| if side == 0 { -shift } else { shift }), block);
            }
            sum
        };
        Self { side_px: 2 * self.side_px, columns, sums: (0..columns * rows).map(sum).collect() }
    }

    /// First quartile of the disagreement of neighbouring blocks (quanta); `None` for too few pairs.
    fn disagreement(&self, space: &DisparitySpace) -> Option<Reading> {
        let right_of = |k: usize| (!(k + 1).is_multiple_of(self.columns)).then_some(k + 1);
        let below = |k: usize| (k + self.columns < self.sums.len()).then_some(k + self.columns);
        let is_measured = |k: &usize| !self.sums[*k].d.is_nan();
        let pairs = (0..self.sums.len()).filter(is_measured).flat_map(|k| {
            let below = below(k).filter(is_measured);
            let right =
                right_of(k).filter(is_measured).map(|other| self.pair(k, other, |s| [s.dx, s.dy], space));
            right.into_iter().chain(below.map(|other| self.pair(k, other, |s| [s.dy, s.dx], space)))
        });
        let mut costs: Buffer<f64> = pairs.collect();
        let samples = costs.len();
        (samples >= LEAST_PAIRS).then(|| Reading { value: element_at(&mut costs, QUARTILE), samples })
    }

    /// The cost of merging two blocks, the first left of or above the second. `along`: the sums along and across their direction.
    fn pair(&self, a: usize, b: usize, along: impl Fn(&Sums) -> [f64; 2], space: &DisparitySpace) -> f64 {
        let (a, b) = (&self.sums[a], &self.sums[b]);
        let side = self.side_px as f64;
        let n = side * side;
        // Σ x² over a block, over both, and half the distance of their middles.
        let (spread, spread_of_both) = (n * (n - 1.0) / 12.0, 2.0 * n * (4.0 * n - 1.0) / 12.0);
        let ([along_a, across_a], [along_b, across_b]) = (along(a), along(b));
        let step = (b.d - a.d) / n;
        // What a plane through both leaves, less what a plane through each leaves.
        let flat = n * step * step / 2.0
            + (sum_of_squares(along_a, across_a) + sum_of_squares(along_b, across_b)) / spread;
        let slope = along_a + along_b + n * step * side / 2.0;
        let added = flat - slope * slope / spread_of_both - (across_a + across_b).powi(2) / (2.0 * spread);
        let steepness = |along: f64, across: f64| sum_of_squares(along, across).sqrt() / spread;
        let gentler = steepness(along_a, across_a).min(steepness(along_b, across_b));
        (added.max(0.0) * 2.0 / n).sqrt() / space.slope_noise(gentler)
    }
}

fn sum_of_squares(a: f64, b: f64) -> f64 {
    a * a + b * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::{KINECT_QUANTA, MeasuredNoise, Noise};
    use crate::random::Lcg;
    use crate::surface::disparity::position;
    use crate::testing::space;

    const SIZE: (usize, usize) = (320, 240);

    /// The noise of a frame with these disparities (quanta), seen with this focal length.
    fn noise_of(
        focal_px: f64,
        (width, height): (usize, usize),
        disparity: impl FnMut(usize) -> f64,
    ) -> Noise {
        let disparity: Vec<f32> = (0..width * height).map(disparity).map(|d| d as f32).collect();
        let disparity = Raster::from_vec(width, height, disparity).unwrap();
        let residual = disparity.map(|_| KINECT_RESIDUAL_QUANTA as f32);
        let space = space([focal_px; 2], [width as f64 / 2.0, height as f64 / 2.0]);
        let white = measure_white(&residual);
        MeasuredNoise { white, blocks_quanta: measure_waves(&disparity, &space) }.alone()
    }

    /// Normal noise of standard deviation 1.
    fn normal(random: &mut Lcg) -> f64 {
        (0..12).map(|_| random.below(10_000) as f64 / 10_000.0).sum::<f64>() - 6.0
    }

    #[test]
    fn a_plane_without_noise_has_none() {
        let noise = noise_of(525.0, SIZE, |i| {
            let [u, v] = position(i, SIZE.0);
            300.0 + 0.125 * u - 0.25 * v
        });
        assert!(noise.blocks_quanta.iter().all(|quanta| *quanta < 1e-3), "{noise:?}");
        assert!((noise.white - 1.0).abs() < 1e-6);
        assert!(noise.step_scale() < 0.7, "{noise:?}");
    }

    #[test]
    fn white_noise_averages_out_over_blocks() {
        let mut random = Lcg::new(3);
        let noise = noise_of(525.0, (640, 480), |_| 300.0 + normal(&mut random));
        // Twice the side: half the disagreement.
        let [a, b, c] = noise.blocks_quanta;
        assert!((1.7..2.4).contains(&(a / b)) && (1.6..2.6).contains(&(b / c)), "{noise:?}");
        assert!((0.05..0.3).contains(&a), "{noise:?}");
    }

    #[test]
    fn waves_are_the_same_at_any_resolution() {
        let waves = |focal_px: f64, size: (usize, usize)| {
            let long = move |i: usize| {
                let [u, v] = position(i, size.0).map(|x| x * 525.0 / focal_px);
                300.0 + libm::sin(u / 9.0) * libm::cos(v / 11.0)
            };
            noise_of(focal_px, size, long).waves()
        };
        let (full, half) = (waves(525.0, (640, 480)), waves(262.5, SIZE));
        assert!(full > 1.2 && (full / half - 1.0).abs() < 0.15, "{full} {half}");
    }

    #[test]
    fn blocks_with_a_hole_do_not_count_and_without_blocks_a_kinect_is_assumed() {
        let holes = noise_of(525.0, SIZE, |i| if i % 5 == 0 { f64::NAN } else { 300.0 });
        assert_eq!(holes.blocks_quanta, KINECT_QUANTA);
        assert_eq!(noise_of(525.0, (5, 4), |_| 300.0).blocks_quanta, KINECT_QUANTA);
        // Blocks of one size only: the other sizes follow as on a Kinect.
        let mut random = Lcg::new(3);
        let narrow = noise_of(525.0, (24, 240), |_| 300.0 + normal(&mut random));
        let falls = narrow.blocks_quanta[1] / narrow.blocks_quanta[0];
        assert!((falls - KINECT_QUANTA[1] / KINECT_QUANTA[0]).abs() < 1e-9, "{narrow:?}");
    }
}
