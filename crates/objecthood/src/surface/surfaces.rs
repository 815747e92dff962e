//! What single pixels tell in `context`: the plane that fits the surroundings of each best (docs/CONTEXT.md 0.3, 3.2).

use crate::frame::Frame;
use crate::params;
use crate::raster::Raster;
use crate::surface::disparity::DisparitySpace;
use crate::surface::plane_fit::{PlaneFits, plane_fits};
use crate::surface::window_choice::{Orientation, orientation};

/// The surface at every pixel.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// The camera and its noise: the units of all that follows.
    pub space: DisparitySpace,
    /// Disparity (quanta); `NaN` without depth.
    pub disparity: Raster<f32>,
    /// The plane fitted to the window around every pixel.
    pub fits: PlaneFits,
    /// Slope and normal of the window that was chosen for every pixel.
    pub orientation: Orientation,
}

/// Measures the surface at every pixel of a frame. O(pixels).
pub fn find_surfaces(frame: &Frame, sensor: &params::Sensor, params: &params::LocalFit) -> Surfaces {
    let space = DisparitySpace::new(frame.camera(), sensor);
    let disparity = space.disparity(frame.depth_m());
    let fits = plane_fits(&disparity, space.length_px(params.radius_px));
    let orientation = orientation(&disparity, &fits, &space, params);
    Surfaces { space, disparity, fits, orientation }
}
