//! Stage 1 of `paper`: over-segmentation on colour, depth and curvature (III-A, eq. 1).
//!
//! The whole of `paper`, on a box of 10 cm, seen from above:
//!
//! ```
//! use objecthood::facets::paper::group_alike;
//! use objecthood::objectness::conclusion::{PaperScene, conclude_paper};
//! use objecthood::objectness::hypotheses::{Evidence, find_hypotheses};
//! use objecthood::objectness::outline::ColorEvidence;
//! use objecthood::oversegment::paper::{SegmentationParams, segment_graph};
//! use objecthood::params::Channels;
//! use objecthood::shapes::paper::join_convex;
//! use objecthood::support::gravity::find_ground;
//! use objecthood::support::paper::stack_by_height;
//! use objecthood::surface::curvature::measure_curvature;
//! use objecthood::surface::disparity::DisparitySpace;
//! use objecthood::surface::normals::measure_normals;
//!
//! # use objecthood::attitude::Attitude;
//! # use objecthood::{Camera, Frame, Method, Params, Raster};
//! # let seen_m = |i: usize| if (60..100).contains(&(i % 160)) && (40..80).contains(&(i / 160)) { 0.9 } else { 1.0 };
//! # let depth_m = Raster::from_vec(160, 120, (0..160 * 120).map(seen_m).collect())?;
//! # let frame = Frame::new(depth_m, None, Camera::new(131.0, 131.0, 79.5, 59.5)?)?;
//! let mut params = Params { method: Method::Paper, ..Params::default() };
//! params.graph.channels = Channels::Depth; // the frame has no colour
//! let points_m = &frame.points_m();
//! let normals = &measure_normals(points_m, &params.normals);
//! let curvature = measure_curvature(normals, &params.curvature);
//! let superpixels = segment_graph(&frame, &curvature, SegmentationParams::of(&params));
//! assert_eq!(superpixels.segments.count(), 2);
//!
//! let facets = &group_alike(&frame, &superpixels, normals, &params.appearance, &params.grouping);
//! let shapes = &join_convex(&superpixels, facets, points_m, normals, &params.contact);
//! assert_eq!((facets.count(), shapes.count()), (2, 2));
//!
//! let ground = &find_ground(points_m, &Attitude::of(&frame, &params.gravity), &params.gravity);
//! let support = &stack_by_height(&superpixels, shapes, points_m, normals, &params.contact, &ground.up);
//! assert_eq!((support.edges[0].lower.0, support.edges[0].upper.0), (0, 1)); // the box stands on the table
//!
//! let space = &DisparitySpace::new(frame.camera(), &params.sensor);
//! let evidence = Evidence { regions: shapes, points_m, normals, support, footing: None, up: &ground.up, space, color: ColorEvidence::default() };
//! let hypotheses = find_hypotheses(&evidence, &params.objectness, &params.contraction);
//! let scene = PaperScene { facets, points_m, ground, support };
//! let found = conclude_paper(&frame, &scene, &hypotheses, &params.gravity, &params.objectness)?;
//! assert_eq!(found.objects.len(), 1);
//! # Ok::<(), objecthood::Error>(())
//! ```

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
