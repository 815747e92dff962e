//! Inputs for the tests of several algorithms of `context`.

use proptest::prelude::*;
use proptest::strategy::BoxedStrategy;

use crate::camera::Camera;
use crate::params;
use crate::raster::Raster;
use crate::surface::disparity::DisparitySpace;
use crate::surface::plane_fit::{PlaneFit, PlaneFits};

/// The space of a Kinect, in which parameters in pixels hold unscaled.
pub(crate) fn kinect() -> DisparitySpace {
    space([525.0, 525.0], [319.5, 239.5])
}

/// The space of a camera with these focal lengths and this principal point (px).
pub(crate) fn space([fx_px, fy_px]: [f64; 2], [cx_px, cy_px]: [f64; 2]) -> DisparitySpace {
    DisparitySpace::new(Camera { fx_px, fy_px, cx_px, cy_px }, &params::Sensor::default())
}

/// Columns and rows of a small image.
pub(crate) fn small_size() -> impl Strategy<Value = (usize, usize)> {
    (1_usize..15, 1_usize..15)
}

/// An image of this size whose pixels are drawn one by one.
pub(crate) fn raster<T: Clone + std::fmt::Debug + 'static>(
    (width, height): (usize, usize),
    pixel: impl Strategy<Value = T> + 'static,
) -> BoxedStrategy<Raster<T>> {
    let pixels = prop::collection::vec(pixel, width * height);
    pixels.prop_map(move |data| Raster::from_vec(width, height, data).expect("one value a pixel")).boxed()
}

/// A disparity in whole quanta, so that ties are common; one in six is missing.
pub(crate) fn coarse_disparity() -> impl Strategy<Value = f32> + Clone {
    prop_oneof![1 => Just(f32::NAN), 5 => (200_u8..=208).prop_map(f32::from)]
}

/// Plane fits from single planes.
pub(crate) fn plane_fits(fits: &Raster<PlaneFit>) -> PlaneFits {
    PlaneFits {
        value: fits.map(|fit| fit.value),
        slope: [0, 1].map(|k| fits.map(|fit| fit.slope[k])),
        residual: fits.map(|fit| fit.residual),
    }
}
