//! Columns: the places above or below a pixel along gravity, looked up in the image (docs/CONTEXT.md
//! 6.7.1 and 6.7.2).

use glam::DVec3;

use crate::regions::SegmentId;
use crate::support::scene::SupportScene;
use crate::surface::disparity::DisparitySpace;

/// A column is followed in steps of this length (m).
pub(super) const STEP_M: f64 = 0.01;
/// Air that is at least this high (m) is no overhang of a vessel or a rounded edge.
pub(super) const LEAST_AIR_M: f64 = 0.04;
/// The image shows something behind a place of a column if it is farther by at least this (m) ...
const BEHIND_M: f64 = 0.02;
/// ... and by this many quanta.
const BEHIND_QUANTA: f64 = 4.0;

/// A place of a column, and what the image shows there.
pub(super) struct Place {
    /// The region that is seen there.
    pub region: Option<SegmentId>,
    /// How much farther (m) than the place that region is; `NaN` in a hole.
    pub farther_m: f64,
    /// If it is at least this much farther (m), it lies behind the place.
    pub behind_m: f64,
}

/// The number of places in a column of this length (m). A column with fewer leaves the image.
pub(super) fn steps_in(length_m: f64) -> usize {
    (length_m / STEP_M).round() as usize
}

/// The places beyond pixel `i` in a direction (unit vector), for at most `length_m`, as long as they are in the image.
pub(super) fn places<'a>(
    scene: &SupportScene<'a>,
    i: usize,
    direction: DVec3,
    length_m: f64,
) -> impl Iterator<Item = Place> + use<'a> {
    let scene = *scene;
    let point = scene.point_at(i);
    (1..=steps_in(length_m)).map_while(move |step| {
        let place = point + direction * (step as f64 * STEP_M);
        let j = scene.space.camera().pixel_at(place, scene.points_m.size())?;
        Some(Place {
            region: scene.regions.at(j),
            farther_m: f64::from(scene.points_m[j][2]) - place.z,
            behind_m: behind_m(scene.space, place.z),
        })
    })
}

fn behind_m(space: &DisparitySpace, z_m: f64) -> f64 {
    space.step_m(BEHIND_QUANTA, z_m).max(BEHIND_M)
}
