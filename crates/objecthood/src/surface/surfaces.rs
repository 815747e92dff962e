//! The surface at every pixel in `context`: the plane that fits its surroundings best (docs/CONTEXT.md 0.3, 0.4).

use crate::color::image::LabImage;
use crate::estimates::Estimates;
use crate::frame::Frame;
use crate::noise::MeasuredNoise;
use crate::params::{self, ColorFor};
use crate::raster::Raster;
use crate::surface::bands::Bands;
use crate::surface::blocks::{measure_waves, measure_white};
use crate::surface::bridges::bridge_holes;
use crate::surface::disparity::DisparitySpace;
use crate::surface::noise_choice::KnownNoise;
use crate::surface::plane_fit::{PlaneFits, fit_planes};
use crate::surface::sharpen::sharpen;
use crate::surface::window_choice::{Orientation, choose_windows};

/// The surface at every pixel.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Surfaces {
    /// The frame, after its smeared edges became steps.
    pub frame: Frame,
    /// The camera and the sensor's noise, which convert between pixels, quanta and metres.
    pub space: DisparitySpace,
    /// Colour as it is compared; `None` without a colour image.
    pub lab: Option<LabImage>,
    /// Disparity (quanta); `NaN` without depth from 0.1 to 20 m, except in small holes that are bridged.
    pub disparity: Raster<f32>,
    /// The bands along the borders in which nothing is measured.
    pub bands: Bands,
    /// The share of the pixels that are small holes in a grid, and were bridged.
    pub bridged_share: f32,
    /// The share of the measured pixels whose depth was changed because they lay on smeared edges.
    pub sharpened_share: f32,
    /// The frames that the noise of `space` is a mean over; 0 when none told of it.
    pub noise_frames: u32,
    /// The stages that ask colour.
    pub color: ColorFor,
    /// The plane fitted to the window around every pixel.
    pub fits: PlaneFits,
    /// Slope and normal of the window that was chosen for every pixel.
    pub orientation: Orientation,
}

/// Measures the surface at every pixel of a frame. O(pixels).
pub fn find_surfaces(frame: &Frame, sensor: &params::Sensor, params: &params::LocalFit) -> Surfaces {
    let space = DisparitySpace::new(frame.camera(), sensor);
    let mut disparity = space.disparity(frame.depth_m());
    let bands = Bands::of(&disparity);
    let bridged_share = bridge_holes(&mut disparity);

    let known = KnownNoise::of(sensor, frame.estimates(), &disparity, &space);
    let mut measured = MeasuredNoise { white: None, blocks_quanta: measure_waves(&disparity, &space) };
    let is_matched = known.with(&measured).noise.is_matched();
    let color = frame.color().filter(|_| sensor.color != ColorFor::None);
    let sharp = sharpen(&disparity, color, is_matched, &space);
    let lab = color.map(|color| LabImage::new(color, frame.depth_m()));
    let (frame, sharpened_share) = sharp
        .as_ref()
        .map_or_else(|| (frame.clone(), 0.0), |sharp| with_changes(frame, [&disparity, sharp], &space));
    let disparity = sharp.unwrap_or(disparity);

    let fits = fit_planes(&disparity, space.length_px(params.radius_px));
    measured.white = measure_white(&fits.residual);
    let Estimates { noise, frames: noise_frames, .. } = known.with(&measured);
    let space = space.with_noise(noise);
    let orientation = choose_windows(&disparity, &fits, &space, params);
    Surfaces {
        frame,
        space,
        lab,
        disparity,
        bands,
        bridged_share,
        sharpened_share,
        noise_frames,
        color: sensor.color,
        fits,
        orientation,
    }
}

impl Surfaces {
    /// The colours for skirts and for the stages from the shapes on, if these ask them.
    pub(crate) fn lab_for_shapes(&self) -> Option<&LabImage> {
        self.lab.as_ref().filter(|_| self.color == ColorFor::All)
    }
}

/// The frame with the depths of the pixels whose disparity was changed, and the share of its measured pixels that they are.
fn with_changes(frame: &Frame, [before, after]: [&Raster<f32>; 2], space: &DisparitySpace) -> (Frame, f32) {
    let mut depth_m = frame.depth_m().clone();
    let mut changed = 0_usize;
    let images = before.as_slice().iter().zip(after.as_slice());
    for (z_m, (before, after)) in depth_m.as_mut_slice().iter_mut().zip(images) {
        // A hole that was bridged has a disparity, but no depth.
        if !z_m.is_nan() && !after.is_nan() && before != after {
            *z_m = space.depth_m(f64::from(*after)) as f32;
            changed += 1;
        }
    }
    (frame.with_restored_depth(depth_m), changed as f32 / frame.measured_px() as f32)
}
