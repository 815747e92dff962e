//! Columns: places above or below a pixel along gravity, looked up in the image (docs/CONTEXT.md 6.7).

use crate::surface::disparity::DisparitySpace;

/// A column is followed in steps of this length (m).
pub(super) const STEP_M: f64 = 0.01;
/// Air that is at least this high (m) is no overhang of a vessel or a rounded edge.
pub(super) const LEAST_AIR_M: f64 = 0.04;
/// What is seen lies behind a column when it is farther by this much (m) ...
const BEHIND_M: f64 = 0.02;
/// ... and by this many quanta.
const BEHIND_QUANTA: f64 = 4.0;

/// How much farther (m) than a place at depth `z_m` something must be seen to lie behind it.
pub(super) fn behind_m(space: &DisparitySpace, z_m: f64) -> f64 {
    space.step_m(BEHIND_QUANTA, z_m).max(BEHIND_M)
}
