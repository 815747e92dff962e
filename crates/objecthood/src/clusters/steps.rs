//! Steps in depth between neighbouring pixels.

use crate::params;
use crate::raster::Raster;
use crate::surface::disparity::DisparitySpace;

/// Disparities of adjacent pixels may differ by this much more, because the sensor rounds to whole quanta.
const ROUNDING_QUANTA: f32 = 1.0;

/// The largest differences in disparity (quanta) that are no step in depth.
#[derive(Clone, Copy, Debug)]
pub struct StepLimits {
    /// Between adjacent pixels.
    pub touch_quanta: f32,
    /// Across a gap.
    pub level_quanta: f32,
}

impl StepLimits {
    /// The limit of the watershed's links; between adjacent pixels one quantum more, which rounding may add.
    pub fn of(params: &params::Watershed, space: &DisparitySpace) -> Self {
        let scale = space.noise().step_scale() as f32;
        let level_quanta = scale * params.link_jump_quanta;
        Self { touch_quanta: level_quanta + scale * ROUNDING_QUANTA, level_quanta }
    }

    /// Whether there is no step between two adjacent pixels.
    pub(crate) fn touch(self, disparity: &Raster<f32>, i: usize, j: usize) -> bool {
        (disparity[j] - disparity[i]).abs() <= self.touch_quanta
    }
}
