//! Depths at a grid of pixels, with measurements of their neighbours.

use crate::quantile::element_at;
use crate::raster::Raster;

/// Distance (px) of the sampled pixels in images of 640 columns; in proportion in others.
const GRID_PX: usize = 8;

/// That width.
const GRID_OF_PX: usize = 640;

/// With fewer depths on the grid nothing is reported about depth.
const FEWEST: usize = 100;

/// Neighbours whose depths differ by more than this share are a jump.
const JUMP: f32 = 0.05;

/// Noise is this quantile of the deviations of triples of neighbours from a line: half of the triples may lie
/// on pixels that rounding made equal.
const NOISE_SHARE: f64 = 0.75;

/// Units per metre in which integer depth is stored.
const UNITS_PER_M: [f64; 6] = [1.0, 100.0, 1000.0, 4000.0, 5000.0, 10_000.0];

/// Depths are whole numbers of a unit when they are as near to them as 32 bits allow.
const WHOLE: f64 = 0.01;

/// A depth (m) as a number of 16 bits, if it is a whole number of these units.
pub(super) fn whole(z: f32, per_m: f64) -> Option<u16> {
    let number = f64::from(z) * per_m;
    let whole = libm::round(number);
    ((number - whole).abs() < WHOLE && whole <= f64::from(u16::MAX)).then_some(whole as u16)
}

/// What a grid of pixels shows of a depth image.
pub(super) struct Sample {
    /// Distance of the columns and rows of the grid.
    pub(super) grid_px: usize,
    /// Depths (m) of the grid, ascending.
    pub(super) depths_m: Vec<f32>,
    /// Whether neighbours are near enough to each other to tell something about the sensor.
    pub(super) is_fine: bool,
    /// Share of the neighbours in rows, and in columns, whose depth jumps; 0 if there are none, or if they
    /// are too far apart.
    pub(super) jumps: [f64; 2],
    /// Units per metre of which all depths of the grid are whole numbers, if these are usual units.
    pub(super) units_per_m: Option<f64>,
    /// [`NOISE_SHARE`] of all triples of neighbours deviate from a line by less than this beyond one unit,
    /// over depth squared (1/m); 0 if there are none, or if they are too far apart.
    pub(super) noise_per_m: f64,
}

impl Sample {
    /// Samples a depth image. O(n) for n pixels, of which one in 64 is read.
    pub(super) fn of(depth_m: &Raster<f32>, is_fine: bool) -> Self {
        let (width, height) = depth_m.size();
        let grid_px = grid_px(width);
        let depths = depth_m.as_slice();
        let mut sample = Self {
            grid_px,
            is_fine,
            depths_m: Vec::new(),
            jumps: [0.0; 2],
            units_per_m: None,
            noise_per_m: 0.0,
        };
        let mut bends = Vec::new();
        let (mut jumps, mut pairs) = ([0_usize; 2], [0_usize; 2]);
        for v in (1..height.saturating_sub(1)).step_by(grid_px) {
            for u in (1..width.saturating_sub(1)).step_by(grid_px) {
                let i = v * width + u;
                let z = depths[i];
                if z.is_nan() {
                    continue;
                }
                sample.depths_m.push(z);
                for (axis, step) in [1, width].into_iter().enumerate() {
                    let (before, after) = (depths[i - step], depths[i + step]);
                    if !after.is_nan() {
                        pairs[axis] += 1;
                        jumps[axis] += usize::from((after - z).abs() > JUMP * z.max(after));
                    }
                    let bend = (before + after - 2.0 * z).abs();
                    if !bend.is_nan() {
                        bends.push([bend, z].map(f64::from));
                    }
                }
            }
        }
        sample.depths_m.sort_unstable_by(f32::total_cmp);
        let is_whole = |per_m: &f64| sample.depths_m.iter().all(|&z| whole(z, *per_m).is_some());
        sample.units_per_m = UNITS_PER_M.into_iter().find(is_whole);
        if is_fine {
            let unit_m = sample.units_per_m.map_or(0.0, f64::recip);
            let per_m = |&[bend, z]: &[f64; 2]| (bend - unit_m).max(0.0) / (z * z);
            let mut noise: Vec<f64> = bends.iter().map(per_m).collect();
            sample.jumps = [0, 1].map(|axis| jumps[axis] as f64 / pairs[axis].max(1) as f64);
            sample.noise_per_m = element_at(&mut noise, NOISE_SHARE);
        }
        sample
    }

    /// Whether there is enough depth to judge it.
    pub(super) fn is_enough(&self) -> bool {
        self.depths_m.len() >= FEWEST
    }

    /// The depth (m) below which this share of the grid lies; `NaN` without depth.
    pub(super) fn quantile_m(&self, share: f64) -> f64 {
        let place = (share * self.depths_m.len() as f64) as usize;
        f64::from(self.depths_m.get(place).copied().unwrap_or(f32::NAN))
    }
}

/// The grid for images of this width.
pub(super) fn grid_px(width: usize) -> usize {
    (GRID_PX * width / GRID_OF_PX).max(1)
}
