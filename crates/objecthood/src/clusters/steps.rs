//! Steps in depth between neighbouring pixels.

use crate::params;
use crate::raster::Raster;

/// Largest differences in disparity (quanta) that are no step in depth.
#[derive(Clone, Copy, Debug)]
pub struct StepLimits {
    /// Between pixels side by side.
    pub touch_quanta: f32,
    /// Across a gap.
    pub level_quanta: f32,
}

impl StepLimits {
    /// The limits of the links of the watershed; side by side one quantum more, which rounding may add.
    pub fn of(params: &params::Watershed) -> Self {
        Self { touch_quanta: params.link_jump_quanta + 1.0, level_quanta: params.link_jump_quanta }
    }

    /// Whether there is no step between two pixels side by side.
    pub(crate) fn touch(self, disparity: &Raster<f32>, i: usize, j: usize) -> bool {
        (disparity[j] - disparity[i]).abs() <= self.touch_quanta
    }
}
