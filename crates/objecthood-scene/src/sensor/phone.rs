//! The depth of a phone: few points of time of flight or stereo, made dense and smooth by software.
//!
//! | effect | model | source |
//! |---|---|---|
//! | resolution | depth is measured once in 4 x 4 px | Apple, `ARKit`: depth maps of 256 x 192 beside images of 1920 x 1440; a quarter at 640 x 480 is still kind |
//! | edges | depths of cells are smoothed by a Gaussian of 0.6 cells and interpolated: ramps of 6 to 8 px from a tenth to nine tenths of a step | ours, because maps of phones have no steps |
//! | noise | normal, 0.3 % of the depth, correlated over some cells | Luetzenburg, Kroon and Bjørk 2021: 1 cm for things of 10 cm and more; that ours grows with the depth is ours, as light is what runs short |
//! | holes | none within 5 m: software fills them | Apple, as above; the range is that of the same paper |

use rayon::prelude::*;

use super::Measured;
use crate::noise;
use crate::view::View;
use crate::world::World;

const CELL_PX: usize = 4;
const SMOOTHING_CELLS: f64 = 0.6;
const REACH_CELLS: usize = 2;
const NOISE_SHARE: f64 = 0.003;
const NOISE_WIDTH_CELLS: f64 = 1.5;
const FARTHEST_M: f64 = 5.0;

pub(super) fn measure(world: &World, view: &View) -> Vec<Measured> {
    let cells = Cells::of(world, view).smoothed();
    let pixel = |i: usize| {
        let (u, v) = (i % view.width, i / view.width);
        let depth = cells.at(u, v);
        if depth.is_nan() { Measured::NONE } else { Measured { depth_m: depth as f32, source: i } }
    };
    (0..view.sights.len()).into_par_iter().map(pixel).collect()
}

/// One depth (m) for every cell; `NaN` = none.
struct Cells {
    columns: usize,
    rows: usize,
    depths_m: Vec<f64>,
}

impl Cells {
    /// What the middles of the cells see.
    fn of(world: &World, view: &View) -> Self {
        let (columns, rows) = (view.width.div_ceil(CELL_PX), view.height.div_ceil(CELL_PX));
        let noise = noise::smooth(world.noise_seed(), 61, columns, rows, NOISE_WIDTH_CELLS);
        let middle = |cell: usize, size: usize| (cell * CELL_PX + CELL_PX / 2).min(size - 1);
        let cell = |k: usize| {
            let (u, v) = (middle(k % columns, view.width), middle(k / columns, view.height));
            let sight = view.sights[v * view.width + u].filter(|sight| sight.t < FARTHEST_M);
            sight.map_or(f64::NAN, |sight| sight.t * (1.0 + NOISE_SHARE * noise[k]))
        };
        Self { columns, rows, depths_m: (0..columns * rows).map(cell).collect() }
    }

    /// Means of the cells around that have depth, weighted by a Gaussian.
    fn smoothed(self) -> Self {
        let mean = |k: usize| {
            let (x, y) = (k % self.columns, k / self.columns);
            let (mut sum, mut weights) = (0.0, 0.0);
            for row in y.saturating_sub(REACH_CELLS)..(y + REACH_CELLS + 1).min(self.rows) {
                for column in x.saturating_sub(REACH_CELLS)..(x + REACH_CELLS + 1).min(self.columns) {
                    let depth = self.depths_m[row * self.columns + column];
                    let (dx, dy) = (column.abs_diff(x) as f64, row.abs_diff(y) as f64);
                    let square = (dx * dx + dy * dy) / (SMOOTHING_CELLS * SMOOTHING_CELLS);
                    let weight = if depth.is_nan() { 0.0 } else { libm::exp(-square / 2.0) };
                    sum += if depth.is_nan() { 0.0 } else { weight * depth };
                    weights += weight;
                }
            }
            sum / weights
        };
        let depths_m = (0..self.depths_m.len()).into_par_iter().map(mean).collect();
        Self { depths_m, ..self }
    }

    /// Bilinear between the middles of cells that have depth.
    fn at(&self, u: usize, v: usize) -> f64 {
        let place = |at: usize, cells: usize| {
            let x = (at as f64 - (CELL_PX / 2) as f64) / CELL_PX as f64;
            let x = x.clamp(0.0, (cells - 1) as f64);
            let first = (x as usize).min(cells.saturating_sub(2));
            (first, (first + 1).min(cells - 1), x - first as f64)
        };
        let ((x0, x1, wx), (y0, y1, wy)) = (place(u, self.columns), place(v, self.rows));
        let (mut sum, mut weights) = (0.0, 0.0);
        for (x, y, weight) in [
            (x0, y0, (1.0 - wx) * (1.0 - wy)),
            (x1, y0, wx * (1.0 - wy)),
            (x0, y1, (1.0 - wx) * wy),
            (x1, y1, wx * wy),
        ] {
            let depth = self.depths_m[y * self.columns + x];
            if !depth.is_nan() {
                sum += weight * depth;
                weights += weight;
            }
        }
        sum / weights
    }
}
