//! A plane along which a body may be joined.

use glam::DVec3;

/// A plane across a body: axis · X = at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trace {
    /// Unit normal.
    pub(super) axis: DVec3,
    /// Its place along the normal (m).
    pub(super) at_m: f64,
    /// The share of its section along which colour changes.
    pub(super) share: f64,
    /// This share times the median contrast, over that of a wholly clear one: 0 to 1.
    pub(super) clearness: f64,
    /// The median difference of the colours on both sides, close to the plane, without the part that a
    /// gradient makes (Lab, lightness weighted).
    pub(super) contrast: f64,
    /// Pixels nearer than this (m) may show both sides.
    pub(super) blur_m: f64,
    /// The number of stripes that show it, as a share of that of the place which most stripes show.
    pub(super) measured: f64,
}

impl Trace {
    /// Height (m) of a point above the plane.
    pub(super) fn height_m(&self, point: DVec3) -> f64 {
        self.axis.dot(point) - self.at_m
    }

    pub(super) fn is_above(&self, point: DVec3) -> bool {
        self.height_m(point) > 0.0
    }
}
