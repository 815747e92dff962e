//! The surface at every pixel in `context`: the plane that fits its surroundings best (docs/CONTEXT.md 0.3, 0.4).

use crate::estimates::Estimates;
use crate::frame::Frame;
use crate::params;
use crate::raster::Raster;
use crate::surface::bridges::bridge_holes;
use crate::surface::disparity::DisparitySpace;
use crate::surface::noise_choice::choose_noise;
use crate::surface::plane_fit::{PlaneFits, fit_planes};
use crate::surface::window_choice::{Orientation, choose_windows};

/// The surface at every pixel.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Surfaces {
    /// The camera and the sensor's noise, which convert between pixels, quanta and metres.
    pub space: DisparitySpace,
    /// Disparity (quanta); `NaN` without depth from 0.1 to 20 m, except in small holes that are bridged.
    pub disparity: Raster<f32>,
    /// The share of the pixels that are small holes in a grid, and were bridged.
    pub bridged_share: f32,
    /// The frames that the noise of `space` is a mean over; 0 when none told of it.
    pub noise_frames: u32,
    /// The plane fitted to the window around every pixel.
    pub fits: PlaneFits,
    /// Slope and normal of the window that was chosen for every pixel.
    pub orientation: Orientation,
}

/// Measures the surface at every pixel of a frame. O(pixels).
pub fn find_surfaces(frame: &Frame, sensor: &params::Sensor, params: &params::LocalFit) -> Surfaces {
    let space = DisparitySpace::new(frame.camera(), sensor);
    let mut disparity = space.disparity(frame.depth_m());
    let bridged_share = bridge_holes(&mut disparity);
    let fits = fit_planes(&disparity, space.length_px(params.radius_px));
    let images = [&disparity, &fits.residual];
    let Estimates { noise, frames: noise_frames, .. } =
        choose_noise(sensor, frame.estimates(), images, &space);
    let space = space.with_noise(noise);
    let orientation = choose_windows(&disparity, &fits, &space, params);
    Surfaces { space, disparity, bridged_share, noise_frames, fits, orientation }
}
