//! The methods: the order of the stages, and nothing else.

use crate::discovery::{Discovery, Notice};
use crate::error::Result;
use crate::facets::appearance::Appearance;
use crate::facets::grouping::group_superpixels;
use crate::facets::merging::merge_surfaces;
use crate::facets::refinement::refine;
use crate::frame::Frame;
use crate::objectness::decision::decided;
use crate::objectness::forest::forest;
use crate::objectness::gravity::{camera_up, dominant_plane, on_plane, up};
use crate::objectness::history::History;
use crate::objectness::hypotheses::{Evidence, hypotheses};
use crate::objectness::objects::objects;
use crate::objectness::support::support;
use crate::objectness::{
    Clusters, Scene, Steps, absorb_fragments, drop_low, fill, join_behind_occluders, join_bottoms,
    join_vessels, outcome,
};
use crate::observe::{LabelMap, Observer, Stage};
use crate::oversegment::absorb::absorb;
use crate::oversegment::felzenszwalb::segment;
use crate::oversegment::graph::{PixelGraph, Unmeasured};
use crate::oversegment::linked_pairs::count_linked_pairs;
use crate::oversegment::links::Links;
use crate::oversegment::smoothing::smooth;
use crate::oversegment::structure::find_structure;
use crate::oversegment::watershed::{find_seeds, flood};
use crate::params::{Channels, Params, UpFrom};
use crate::raster::Raster;
use crate::shapes::border::measure_borders;
use crate::shapes::contact::find_contacts;
use crate::shapes::contraction::{contract, sum_votes};
use crate::shapes::convexity::{join_shapes, measure_convexities};
use crate::shapes::descriptor::describe_regions;
use crate::surface::curvature::measure_curvature;
use crate::surface::disparity::DisparitySpace;
use crate::surface::moments::Moments;
use crate::surface::normals::measure_normals;
use crate::surface::plane_fit::fit_planes;
use crate::surface::window_choice::choose_windows;

/// The published method: "Unsupervised Object Exploration Using Context" (RO-MAN 2014).
pub(crate) fn paper(frame: &Frame, params: &Params, observer: &mut dyn Observer) -> Result<Discovery> {
    let params = &without_missing_color(frame, params);
    let points = frame.points_m();

    // What single pixels tell: normals, and where they bend (eq. 2).
    let normals = measure_normals(&points, &params.normals);
    observer.observe(Stage::Normals(&normals));
    let curvature = measure_curvature(&normals, &params.curvature);
    observer.observe(Stage::Curvature(&curvature));
    let borders = high_curvature(frame, &curvature, params);

    // 1. Over-segmentation on colour, depth and curvature (eq. 1).
    drop(curvature);
    let smoothed = frame.color().map(|color| smooth(color, frame.depth_m(), &params.smoothing));
    let unmeasured = unmeasured(params);
    let graph = PixelGraph::new(frame, smoothed.as_ref(), unmeasured, &params.sensor, &params.graph);
    drop(smoothed);
    let components = segment(&graph, &borders, &params.graph);
    let min_size = params.graph.min_size_px;
    let superpixels = absorb(&graph, &components, &borders, frame.depth_m(), &params.absorption, min_size);
    drop((graph, components));
    observer.observe(Stage::Superpixels((&superpixels.segments).into()));

    // 2. Facets: superpixels that look alike (eq. 3).
    let appearance = Appearance::new(&superpixels, frame.color(), &normals, &params.appearance);
    let facets = group_superpixels(&superpixels, &appearance, frame.depth_m(), &params.grouping);
    observer.observe(Stage::Facets(&facets));

    // 3. Shapes: facets joined across convex edges (eq. 4 and 5).
    let described = describe_regions(&facets, &superpixels.core, &points, &normals);
    let convexities = measure_convexities(&find_contacts(&facets, &points, &params.contact), &described);
    let shapes = join_shapes(&facets, &described, &convexities);
    observer.observe(Stage::Shapes((&shapes).into()));

    // 4. Objectness: size, and support against gravity (eq. 6 to 8).
    let plane = dominant_plane(&points, &params.gravity);
    let up = up(plane.as_ref(), &params.gravity);
    let described = describe_regions(&shapes, &superpixels.core, &points, &normals);
    let touching = find_contacts(&shapes, &points, &params.contact);
    let mut support = support(&shapes, &described, &touching, &points, &up);
    observer.observe(Stage::Support { graph: &support, regions: &shapes });
    let space = &DisparitySpace::new(frame.camera(), &params.sensor);
    let evidence = Evidence {
        regions: &shapes,
        points_m: &points,
        normals: &normals,
        support: &support,
        up: &up,
        space,
    };
    let hypotheses = hypotheses(&evidence, 0, params.objectness.min_size_px, params);
    observer.observe(Stage::Hypotheses(&hypotheses));
    let (objects, labels) = objects(decided(hypotheses, params), &facets, &points, &support)?;
    support.mark(&objects);

    let missing_plane = plane.is_none() && params.gravity.up_from == UpFrom::Plane;
    let missing_color = frame.color().is_none();
    let notices = [(missing_plane, Notice::NoPlane), (missing_color, Notice::NoColor)];
    let discovery = Discovery {
        objects,
        up,
        structure: on_plane(plane.as_ref(), &labels, &points, &params.gravity),
        structure_planes: plane.into_iter().collect(),
        labels,
        support,
        notices: notices.into_iter().filter_map(|(holds, notice)| holds.then_some(notice)).collect(),
    };
    observer.observe(Stage::Objects(&discovery));
    Ok(discovery)
}

/// The same four stages, with surfaces fitted in disparity and the evidence of whole borders; what borders cannot tell the
/// surroundings decide. Colour is asked only about parts behind an occluder.
pub(crate) fn context(frame: &Frame, params: &Params, observer: &mut dyn Observer) -> Result<Discovery> {
    let space = &DisparitySpace::new(frame.camera(), &params.sensor);

    // What single pixels tell: the plane that fits their surroundings best.
    let disparity = space.disparity(frame.depth_m());
    let fits = fit_planes(&disparity, space.length_px(params.local_fit.radius_px));
    let orientation = choose_windows(&disparity, &fits, space, &params.local_fit);
    observer.observe(Stage::Normals(&orientation.normal));

    // 1. Over-segmentation: large planes, then a watershed of how badly a plane fits.
    let structure = find_structure(
        &disparity,
        &fits,
        &orientation,
        frame.depth_m(),
        space,
        camera_up(&params.gravity),
        &params.structure,
    );
    observer.observe(Stage::Structure(LabelMap::structure(&structure)));
    let links = Links::new(&disparity, &orientation.slope, &structure.labels, space, &params.watershed);
    let starts = find_seeds(&fits.residual, &links, space, &params.watershed);
    // The flood has one order; beside it there is time for what later stages need.
    let (superpixels, (planes, points)) = rayon::join(
        || flood(&fits.residual, &starts, &links),
        || (structure.planes(frame.depth_m(), &frame.camera()), frame.points_m()),
    );
    observer.observe(Stage::Superpixels(LabelMap::superpixels(&structure, &superpixels)));

    // 2. Facets: superpixels that lie on one surface.
    let (joined, moments) = rayon::join(
        || count_linked_pairs(&superpixels, &links),
        || Moments::of_segments(&superpixels, &disparity),
    );
    let facets = merge_surfaces(
        &superpixels,
        &structure.surfaces,
        structure.labels,
        &moments,
        &joined,
        space,
        &params.merging,
    );
    let facets = refine(facets, &disparity, &params.refinement);
    observer.observe(Stage::Facets(&facets.segments));

    // 3. Shapes: facets whose borders vote for one shape.
    let borders = measure_borders(&facets, &disparity, space, &params.border);
    observer.observe(Stage::Borders { facets: &facets, evidence: &borders });
    let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));
    observer.observe(Stage::Shapes(LabelMap::shapes(&facets, &shapes)));

    // 4. Objectness: what the surroundings of a shape tell, and support against gravity.
    let steps = Steps::of(&params.watershed);
    let facets = fill(facets, &disparity, steps);
    let scene = Scene {
        facets: &facets,
        disparity: &disparity,
        normals: &orientation.normal,
        points_m: &points,
        color: frame.color(),
        space,
        support: structure.support.map(|s| &structure.surfaces[s]),
        steps,
    };
    let mut clusters = Clusters::new(&scene, &shapes);
    absorb_fragments(&mut clusters, &params.fragments);
    drop_low(&mut clusters, &params.height);
    join_vessels(&mut clusters, &params.vessels);
    join_bottoms(&mut clusters, structure.support, &params.vessels);
    join_behind_occluders(&mut clusters, &params.occlusion);
    observer.observe(Stage::Clusters { facets: &facets, history: History::of(&clusters) });

    let outcome = outcome(&clusters, structure.support, &params.objectness);
    let planes = outcome.counted(planes, frame.measured_px());
    let up = up(structure.support.map(|s| &planes[s]), &params.gravity);
    let mut support = forest(&outcome.regions, &points, &orientation.normal, &planes, &up, space, params);
    observer.observe(Stage::Support { graph: &support, regions: &outcome.regions });
    let evidence = Evidence {
        regions: &outcome.regions,
        points_m: &points,
        normals: &orientation.normal,
        support: &support,
        up: &up,
        space,
    };
    let mut hypotheses = hypotheses(&evidence, planes.len(), 1, params);
    outcome.describe(&mut hypotheses, &clusters);
    observer.observe(Stage::Hypotheses(&hypotheses));
    let (objects, labels) = objects(decided(hypotheses, params), &facets.segments, &points, &support)?;
    support.mark(&objects);

    let missing_plane = structure.support.is_none() && params.gravity.up_from == UpFrom::Plane;
    let discovery = Discovery {
        objects,
        labels,
        up,
        structure: outcome.structure_labels(),
        structure_planes: planes,
        support,
        notices: missing_plane.then_some(Notice::NoPlane).into_iter().collect(),
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
    let (enabled, threshold) = (params.curvature.enabled, params.curvature.threshold);
    let high = |(c, z): (&f32, &f32)| enabled & !z.is_nan() & (*c > threshold);
    curvature.with_data(curvature.as_slice().iter().zip(frame.depth_m().as_slice()).map(high).collect())
}
