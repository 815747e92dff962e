//! The size of a surface, by which structure is distinguished from faces of things (docs/CONTEXT.md 1.1.1,
//! step 6) and boards from smaller ones (1.1.3, 1.1.8).

use glam::DVec3;

use crate::camera::Camera;
use crate::quantile::element_at;
use crate::tangents::tangents;

/// A surface with a larger area than this ...
const LARGE_M2: f64 = 0.18;
/// ... and a longer side than this is structure.
const LONG_M: f64 = 0.5;
/// A surface as long as structure with a larger area than this is a board: structure if things stand on it.
const BOARD_M2: f64 = 0.06;
/// Least cosine between normal and ray in the area of a pixel: smaller cosines are raised to it.
const LEAST_COSINE: f64 = 0.15;
/// A side of a surface begins at this quantile of its points ...
const LOW_SHARE: f64 = 0.05;
/// ... and ends at this one.
const HIGH_SHARE: f64 = 0.95;

/// The size of a surface.
pub(super) struct SurfaceSize {
    pub(super) area_m2: f64,
    /// Its longer side, from the 5th to the 95th percentile of its points.
    longest_m: f64,
}

impl SurfaceSize {
    /// Measures a surface with this normal by points on it, each of which stands for `area_px` pixels. O(points).
    pub(super) fn measure(points: &[DVec3], normal: DVec3, area_px: usize, camera: &Camera) -> Self {
        let area_m2 = points.iter().map(|p| {
            let cosine = (-normal.dot(*p) / p.length()).max(LEAST_COSINE);
            area_px as f64 * p.z * p.z / (camera.fx_px * camera.fy_px) / cosine
        });
        let width_m = |axis: DVec3| {
            let mut along: Vec<f64> = points.iter().map(|p| p.dot(axis)).collect();
            element_at(&mut along, HIGH_SHARE) - element_at(&mut along, LOW_SHARE)
        };
        let [t1, t2] = tangents(normal);
        Self { area_m2: area_m2.sum(), longest_m: width_m(t1).max(width_m(t2)) }
    }

    /// Whether it is structure whatever stands on it.
    pub(super) fn is_large(&self) -> bool {
        self.area_m2 > LARGE_M2 && self.longest_m > LONG_M
    }

    /// Whether it is large enough for the board of a shelf.
    pub(super) fn is_board(&self) -> bool {
        self.area_m2 > BOARD_M2 && self.longest_m > LONG_M
    }
}
