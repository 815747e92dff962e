//! The graph segmentation alone, as other libraries have it: of the colour image, without depth.

use objecthood::oversegment::felzenszwalb::{Components, segment};
use objecthood::oversegment::graph::{PixelGraph, Unmeasured};
use objecthood::oversegment::smoothing::smooth;
use objecthood::params::Channels;
use objecthood::{Camera, Frame, Params, Raster, Result};

/// A frame of this colour image that is as deep everywhere, so that colour alone decides.
///
/// # Errors
/// When the image is none.
pub fn flat_frame(color: &Raster<[u8; 3]>) -> Result<Frame> {
    let depth_m = color.map(|_| 1.0);
    Frame::new(depth_m, Some(color.clone()), Camera::new(1.0, 1.0, 0.0, 0.0)?)
}

/// The parameters of the paper for colour alone.
pub fn color_alone() -> Params {
    let mut params = Params::default();
    params.graph.channels = Channels::Color;
    params
}

/// Smooths the image, builds and sorts the edges between 8-neighbours, and joins: all that the others do in one call.
pub fn graph_segmentation(frame: &Frame, borders: &Raster<bool>, params: &Params) -> Components {
    let smoothed = frame.color().map(|color| smooth(color, frame.depth_m(), &params.smoothing));
    let graph = PixelGraph::new(frame, smoothed.as_ref(), Unmeasured::ByColor, &params.sensor, &params.graph);
    drop(smoothed);
    segment(&graph, borders, &params.graph)
}
