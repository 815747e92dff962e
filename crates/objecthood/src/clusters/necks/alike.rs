//! Whether two parts share their colours (docs/CONTEXT.md 4.7.5 to 4.7.7).

use crate::check::{Bound, Check};
use crate::clusters::colors::Colors;

/// The parameter that sets the limit.
const COLOR_OVERLAP: &str = "necks.color_overlap";

/// Checks that an overlap of colours is larger than `least`.
pub(super) fn check_alike(overlap: f64, least: f64) -> Check {
    Check::new("overlap of their colours", "", overlap, Bound::Above, least).set_by(COLOR_OVERLAP)
}

/// The same for two parts in the same light. O(sampled pixels).
pub(super) fn check_alike_in_light([a, b]: [&Colors; 2], least: f64) -> Check {
    let overlap = a.overlap_in_light(b);
    Check::new("overlap of their colours in the same light", "", overlap, Bound::Above, least)
        .set_by(COLOR_OVERLAP)
}
