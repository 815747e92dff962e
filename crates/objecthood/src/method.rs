//! The methods: the order of the stages, and nothing else.
//!
//! Every stage is a function from outputs of earlier stages and its own parameters to one output. [`recall`] runs a stage only
//! if its output is not kept already.

use crate::attitude::Attitude;
use crate::clusters::fill::fill_facets;
use crate::clusters::rules::{Rules, find_clusters};
use crate::clusters::scene::Scene;
use crate::clusters::steps::StepLimits;
use crate::discovery::Discovery;
use crate::error::Result;
use crate::facets::find_facets;
use crate::facets::flat::{FlatParams, find_flats};
use crate::facets::paper::group_alike;
use crate::frame::Frame;
use crate::objectness::conclusion::{ContextScene, PaperScene, conclude_context, conclude_paper};
use crate::objectness::hypotheses::{Evidence, find_cluster_hypotheses, find_hypotheses};
use crate::objectness::outline::ColorEvidence;
use crate::observe::{LabelMap, Observer, Output};
use crate::outputs::{ContextOutputs, PaperOutputs, recall, try_recall};
use crate::oversegment::linked::flood_superpixels;
use crate::oversegment::paper::{SegmentationParams, segment_graph};
use crate::oversegment::structure::find_structure;
use crate::params::{Channels, Params};
use crate::plausibility::find_doubts;
use crate::shapes::border::measure_borders;
use crate::shapes::color_cuts::cut_colors;
use crate::shapes::contraction::{contract, sum_votes};
use crate::shapes::paper::join_convex;
use crate::shapes::seams::{Seams, find_seams};
use crate::support::gravity::find_ground;
use crate::support::paper::stack_by_height;
use crate::support::standing::{StandingParams, find_standing};
use crate::surface::curvature::measure_curvature;
use crate::surface::disparity::DisparitySpace;
use crate::surface::normals::measure_normals;
use crate::surface::surfaces::find_surfaces;

/// The published method: "Unsupervised Object Exploration Using Context" (RO-MAN 2014).
pub(crate) fn paper<'k>(
    frame: &Frame,
    params: &Params,
    kept: &'k mut PaperOutputs,
    observer: &mut dyn Observer,
) -> Result<&'k Discovery> {
    let params = &without_missing_color(frame, params);

    // Single pixels: normals, and the curvature of the surface (eq. 2).
    let points_m = recall(&mut kept.points_m, || frame.points_m());
    let normals = recall(&mut kept.normals, || measure_normals(points_m, &params.normals));
    observer.observe(Output::Normals(normals));
    let curvature = recall(&mut kept.curvature, || measure_curvature(normals, &params.curvature));
    observer.observe(Output::Curvature(curvature));

    // 1. Over-segmentation on colour, depth and curvature (eq. 1).
    let superpixels =
        recall(&mut kept.superpixels, || segment_graph(frame, curvature, SegmentationParams::of(params)));
    observer.observe(Output::Superpixels((&superpixels.segments).into()));

    // 2. Facets: superpixels that look alike (eq. 3).
    let facets = recall(&mut kept.facets, || {
        group_alike(frame, superpixels, normals, &params.appearance, &params.grouping)
    });
    observer.observe(Output::Facets(facets));

    // 3. Shapes: facets joined across convex edges (eq. 4 and 5).
    let shapes =
        recall(&mut kept.shapes, || join_convex(superpixels, facets, points_m, normals, &params.contact));
    observer.observe(Output::Shapes(shapes.into()));

    // 4. Objectness: size, and support against gravity (eq. 6 to 8).
    let ground = recall(&mut kept.ground, || {
        find_ground(points_m, &Attitude::of(frame, &params.gravity), &params.gravity)
    });
    let support = recall(&mut kept.support, || {
        stack_by_height(superpixels, shapes, points_m, normals, &params.contact, &ground.up)
    });
    observer.observe(Output::Support { graph: support, regions: shapes });
    let hypotheses = recall(&mut kept.hypotheses, || {
        let (space, up) = (&DisparitySpace::new(frame.camera(), &params.sensor), &ground.up);
        let (regions, footing, color) = (shapes, None, ColorEvidence::default());
        let evidence = Evidence { regions, points_m, normals, support, footing, up, space, color };
        find_hypotheses(&evidence, &params.objectness, &params.contraction)
    });
    observer.observe(Output::Hypotheses(hypotheses));
    let doubts = recall(&mut kept.doubts, || find_doubts(frame));
    let discovery = try_recall(&mut kept.discovery, || {
        let scene = &PaperScene { facets, points_m, ground, support };
        let found = conclude_paper(frame, scene, hypotheses, &params.gravity, &params.objectness)?;
        Ok(found.with_doubts(doubts))
    })?;
    observer.observe(Output::Objects(discovery));
    Ok(discovery)
}

/// The same four stages, with surfaces fitted in disparity and evidence from whole borders. Where borders cannot decide, the
/// surroundings do. Colour is asked where depth is silent: at seams, behind occluders, on smeared edges.
pub(crate) fn context<'k>(
    frame: &Frame,
    params: &Params,
    kept: &'k mut ContextOutputs,
    observer: &mut dyn Observer,
) -> Result<&'k Discovery> {
    // Single pixels: the plane that fits the surroundings of each best. Smeared edges become steps before.
    let surfaces = recall(&mut kept.surfaces, || find_surfaces(frame, &params.sensor, &params.local_fit));
    observer.observe(Output::Normals(&surfaces.orientation.normal));
    let (given, frame) = (frame, &surfaces.frame);

    // 1. Over-segmentation: large planes, then a watershed of the residuals of the plane fits.
    let structure = recall(&mut kept.structure, || {
        find_structure(frame.depth_m(), surfaces, &Attitude::of(frame, &params.gravity), &params.structure)
    });
    observer.observe(Output::Structure(LabelMap::structure(structure)));
    let superpixels =
        recall(&mut kept.superpixels, || flood_superpixels(surfaces, structure, &params.watershed));
    observer.observe(Output::Superpixels(LabelMap::superpixels(structure, &superpixels.segments)));

    // 2. Facets: superpixels that lie on one surface, cut where colour and depth agree, and flat things.
    let facets = recall(&mut kept.facets, || {
        let found = find_facets(surfaces, structure, superpixels, &params.merging, &params.refinement);
        find_flats(cut_colors(found, surfaces, params), surfaces, structure, FlatParams::of(params))
    });
    observer.observe(Output::Facets(&facets.segments));

    // 3. Shapes: facets whose borders vote for one shape. Colour cuts what flush things share.
    let borders = recall(&mut kept.borders, || measure_borders(facets, surfaces, &params.border));
    observer.observe(Output::Borders { facets, evidence: borders });
    let shapes =
        recall(&mut kept.shapes, || contract(&sum_votes(borders, facets.structure, &params.contraction)));
    let seams = recall(&mut kept.seams, || find_seams((facets, shapes), structure, surfaces, params));
    let (facets, _, shapes) = Seams::or(seams, (facets, borders, shapes));
    observer.observe(Output::Shapes(LabelMap::shapes(facets, shapes)));

    // 4. Objectness: shapes joined by their surroundings, support against gravity, and the score.
    let steps = StepLimits::of(&params.watershed, &surfaces.space);
    let filled = recall(&mut kept.filled, || fill_facets(facets, &surfaces.disparity, steps));
    let points_m = recall(&mut kept.points_m, || frame.points_m());
    let scene = &Scene::new(frame, surfaces, structure, filled, points_m, steps).with_seams(seams.as_ref());
    let clusters = recall(&mut kept.clusters, || find_clusters(scene, shapes, Rules::of(params)));
    observer.observe(Output::Clusters { facets: filled, clusters });
    let standing =
        recall(&mut kept.standing, || find_standing(frame, scene, clusters, StandingParams::of(params)));
    observer.observe(Output::Support { graph: &standing.graph, regions: &standing.candidates.regions });
    let hypotheses = recall(&mut kept.hypotheses, || {
        find_cluster_hypotheses(scene, clusters, standing, &params.objectness, &params.contraction)
    });
    observer.observe(Output::Hypotheses(hypotheses));
    let discovery = try_recall(&mut kept.discovery, || {
        let scene = &ContextScene { surfaces, structure, facets: filled, points_m, standing };
        conclude_context(scene, hypotheses, &params.gravity, &params.objectness)
            .map(|found| found.with_doubts(recall(&mut kept.doubts, || find_doubts(given)).as_slice()))
    })?;
    observer.observe(Output::Objects(discovery));
    Ok(discovery)
}

/// The parameters; for a frame without colour, changed so that depth alone decides.
fn without_missing_color(frame: &Frame, params: &Params) -> Params {
    let mut params = params.clone();
    if frame.color().is_none() {
        params.graph.channels = Channels::Depth;
        params.appearance.color_weight = 0.0;
    }
    params
}
