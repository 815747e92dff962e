//! Stage 1 of `paper`: over-segmentation on colour, depth and curvature (III-A, eq. 1).

use crate::frame::Frame;
use crate::oversegment::Superpixels;
use crate::oversegment::absorb::absorb;
use crate::oversegment::felzenszwalb::segment;
use crate::oversegment::graph::{PixelGraph, Unmeasured};
use crate::oversegment::smoothing::smooth;
use crate::params::{self, Channels, Params};
use crate::raster::Raster;

/// The parameters of the over-segmentation.
#[derive(Clone, Copy, Debug)]
pub struct SegmentationParams<'a> {
    /// For the smoothing of the colour image.
    pub smoothing: &'a params::Smoothing,
    /// For the unit of disparity.
    pub sensor: &'a params::Sensor,
    /// For the pixels that bound superpixels.
    pub curvature: &'a params::Curvature,
    /// For the weights of the graph and its segmentation.
    pub graph: &'a params::Graph,
    /// For the pixels of high curvature, which are absorbed.
    pub absorption: &'a params::Absorption,
}

impl<'a> SegmentationParams<'a> {
    /// Selects the groups of the over-segmentation from all parameters.
    pub fn of(params: &'a Params) -> Self {
        let Params { smoothing, sensor, curvature, graph, absorption, .. } = params;
        Self { smoothing, sensor, curvature, graph, absorption }
    }
}

/// Segments the pixel graph of a frame. Pixels of high curvature separate regions; they are absorbed into adjacent regions
/// afterwards. O(pixels log pixels).
pub fn segment_graph(frame: &Frame, curvature: &Raster<f32>, params: SegmentationParams<'_>) -> Superpixels {
    let borders = find_high_curvature(frame, curvature, params.curvature);
    let smoothed = frame.color().map(|color| smooth(color, frame.depth_m(), params.smoothing));
    let unmeasured = treat_unmeasured(params.curvature, params.graph);
    let graph = PixelGraph::new(frame, smoothed.as_ref(), unmeasured, params.sensor, params.graph);
    // Freed, not kept for the next frame: from here on memory peaks.
    smoothed.into_iter().flatten().for_each(|plane| drop(plane.into_vec()));
    let components = segment(&graph, &borders, params.graph);
    let min_size = params.graph.min_size_px;
    absorb(&graph, &components, &borders, frame.depth_m(), params.absorption, min_size)
}

/// Pixels without depth are separate when curvature bounds superpixels or depth alone makes them; else their colour decides.
fn treat_unmeasured(curvature: &params::Curvature, graph: &params::Graph) -> Unmeasured {
    let bounded = curvature.enabled || graph.channels == Channels::Depth;
    if bounded { Unmeasured::Apart } else { Unmeasured::ByColor }
}

/// The pixels that bound superpixels: they have depth and a curvature above the threshold.
fn find_high_curvature(frame: &Frame, curvature: &Raster<f32>, params: &params::Curvature) -> Raster<bool> {
    let (enabled, threshold) = (params.enabled, params.threshold);
    let high = |(c, z): (&f32, &f32)| enabled & !z.is_nan() & (*c > threshold);
    curvature.with_data(curvature.as_slice().iter().zip(frame.depth_m().as_slice()).map(high).collect())
}
