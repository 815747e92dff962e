//! The methods: the order of the stages, and nothing else.

use crate::discovery::{Discovery, Notice};
use crate::error::Result;
use crate::facets::appearance::Appearance;
use crate::facets::grouping::facets;
use crate::frame::Frame;
use crate::objectness::decision::decide;
use crate::objectness::gravity::{dominant_plane, up};
use crate::objectness::objects::objects;
use crate::objectness::support::support;
use crate::observe::{Observer, Stage};
use crate::oversegment::absorb::absorb;
use crate::oversegment::felzenszwalb::segment;
use crate::oversegment::graph::{PixelGraph, Unmeasured};
use crate::oversegment::smoothing::smooth;
use crate::params::{Channels, Params, UpFrom};
use crate::raster::Raster;
use crate::shapes::contact::contacts;
use crate::shapes::convexity::{convexities, shapes};
use crate::shapes::descriptor::descriptors;
use crate::surface::curvature::curvature;
use crate::surface::normals::normals;

/// The published method: "Unsupervised Object Exploration Using Context" (RO-MAN 2014).
pub(crate) fn paper(frame: &Frame, params: &Params, observer: &mut dyn Observer) -> Result<Discovery> {
    let params = &without_missing_color(frame, params);
    let points = frame.points_m();

    // What single pixels tell: normals, and where they bend (eq. 2).
    let normals = normals(&points, &params.normals);
    observer.observe(Stage::Normals(&normals));
    let curvature = curvature(&normals, &params.curvature);
    observer.observe(Stage::Curvature(&curvature));
    let borders = high_curvature(frame, &curvature, params);

    // 1. Over-segmentation on colour, depth and curvature (eq. 1).
    let smoothed = frame.color().map(|color| smooth(color, frame.depth_m(), &params.smoothing));
    let graph = PixelGraph::new(frame, smoothed.as_ref(), unmeasured(params), &params.sensor, &params.graph);
    let components = segment(&graph, &borders, &params.graph);
    let min_size = params.graph.min_size_px;
    let superpixels = absorb(&graph, &components, &borders, frame.depth_m(), &params.absorption, min_size);
    observer.observe(Stage::Superpixels(&superpixels.segments));

    // 2. Facets: superpixels that look alike (eq. 3).
    let appearance = Appearance::new(&superpixels, frame.color(), &normals, &params.appearance);
    let facets = facets(&superpixels, &appearance, frame.depth_m(), &params.grouping);
    observer.observe(Stage::Facets(&facets));

    // 3. Shapes: facets joined across convex edges (eq. 4 and 5).
    let described = descriptors(&facets, &superpixels.core, &points, &normals);
    let convexities = convexities(&contacts(&facets, &points, &params.contact), &described);
    let shapes = shapes(&facets, &described, &convexities);
    observer.observe(Stage::Shapes(&shapes));

    // 4. Objectness: size, and support against gravity (eq. 6 to 8).
    let plane = dominant_plane(&points, &params.gravity);
    let up = up(plane.as_ref(), &params.gravity);
    let described = descriptors(&shapes, &superpixels.core, &points, &normals);
    let touching = contacts(&shapes, &points, &params.contact);
    let mut support = support(&shapes, &described, &touching, &points, &up);
    observer.observe(Stage::Support(&support));
    let hypotheses = decide(&shapes, &points, &support, &up, &params.objectness);
    let (objects, labels) = objects(hypotheses, &facets, &points, &support)?;
    support.mark(&objects);

    let missing_plane = plane.is_none() && params.gravity.up_from == UpFrom::Plane;
    let missing_color = frame.color().is_none();
    let notices = [(missing_plane, Notice::NoPlane), (missing_color, Notice::NoColor)];
    let discovery = Discovery {
        labels,
        objects,
        up,
        structure_planes: plane.into_iter().collect(),
        support,
        notices: notices.into_iter().filter_map(|(holds, notice)| holds.then_some(notice)).collect(),
    };
    observer.observe(Stage::Objects(&discovery));
    Ok(discovery)
}

/// The parameters with which depth alone decides when the frame has no colour.
fn without_missing_color(frame: &Frame, params: &Params) -> Params {
    let mut params = params.clone();
    if frame.color().is_none() {
        params.graph.channels = Channels::Depth;
        params.appearance.color_weight = 0.0;
    }
    params
}

/// Where curvature bounds superpixels, or depth alone makes them, pixels without depth stand apart.
fn unmeasured(params: &Params) -> Unmeasured {
    let bounded = params.curvature.enabled || params.graph.channels == Channels::Depth;
    if bounded { Unmeasured::Apart } else { Unmeasured::ByColor }
}

/// The pixels that bound superpixels: depth and a curvature above the threshold.
fn high_curvature(frame: &Frame, curvature: &Raster<f32>, params: &Params) -> Raster<bool> {
    let high =
        |(c, z): (&f32, &f32)| params.curvature.enabled && !z.is_nan() && *c > params.curvature.threshold;
    curvature.with_data(curvature.as_slice().iter().zip(frame.depth_m().as_slice()).map(high).collect())
}
