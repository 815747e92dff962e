//! Own superpixels in the place of ours: the method `context` with a plain grid instead of the watershed. The structure is ours.
//!
//! Every stage is a function from outputs of earlier stages and its own parameters to one output. Structure, facets and shapes can be
//! replaced in the same way.
//!
//! `cargo run --release -p objecthood --example 02_own_superpixels`

mod world;

use objecthood::attitude::Attitude;
use objecthood::clusters::fill::fill_facets;
use objecthood::clusters::rules::{Rules, find_clusters};
use objecthood::clusters::scene::Scene;
use objecthood::clusters::steps::StepLimits;
use objecthood::facets::find_facets;
use objecthood::objectness::conclusion::{ContextScene, conclude_context};
use objecthood::objectness::hypotheses::find_cluster_hypotheses;
use objecthood::oversegment::linked::LinkedSuperpixels;
use objecthood::oversegment::structure::find_structure;
use objecthood::shapes::border::measure_borders;
use objecthood::shapes::contraction::{contract, sum_votes};
use objecthood::support::standing::{StandingParams, find_standing};
use objecthood::surface::surfaces::find_surfaces;
use objecthood::{Discovery, Frame, Params, Raster};
use world::{Solid, snapshot};

/// Side of the squares (px). Smaller ones follow borders more closely.
const SIDE_PX: usize = 4;

/// Squares of equal size, numbered row by row.
fn grid(width: usize, height: usize) -> objecthood::Result<Raster<i32>> {
    let columns = width.div_ceil(SIDE_PX);
    let square = |i: usize| (i / width / SIDE_PX * columns + i % width / SIDE_PX) as i32;
    Raster::from_vec(width, height, (0..width * height).map(square).collect())
}

fn discover_with(labels: &Raster<i32>, frame: &Frame, params: &Params) -> objecthood::Result<Discovery> {
    let surfaces = find_surfaces(frame, &params.sensor, &params.local_fit);
    let attitude = Attitude::of(frame, &params.gravity);
    let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);

    // 1. Over-segmentation: ours would be `flood_superpixels`.
    let superpixels = LinkedSuperpixels::from_labels(labels, &surfaces, &structure, &params.watershed)?;

    // 2. Facets.
    let facets = find_facets(&surfaces, &structure, &superpixels, &params.merging, &params.refinement);
    // 3. Shapes.
    let borders = measure_borders(&facets, &surfaces, &params.border);
    let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));
    // 4. Objectness.
    let steps = StepLimits::of(&params.watershed, &surfaces.space);
    let filled = fill_facets(&facets, &surfaces.disparity, steps);
    let points_m = frame.points_m();
    let scene = Scene::new(frame, &surfaces, &structure, &filled, &points_m, steps);
    let clusters = find_clusters(&scene, &shapes, Rules::of(params));
    let standing = find_standing(frame, &scene, &clusters, StandingParams::of(params));
    let Params { gravity, contraction, objectness, .. } = params;
    let hypotheses = find_cluster_hypotheses(&scene, &clusters, &standing, objectness, contraction);
    let all = ContextScene {
        surfaces: &surfaces,
        structure: &structure,
        facets: &filled,
        points_m: &points_m,
        standing: &standing,
    };
    conclude_context(&all, &hypotheses, gravity, objectness)
}

#[expect(clippy::print_stdout, reason = "an example talks to its reader")]
pub(crate) fn main() -> objecthood::Result<()> {
    let frame = snapshot(&[
        Solid { base_m: [-0.15, 0.0, 0.0], size_m: [0.18, 0.14, 0.12], yaw_deg: 25.0, color: [180, 40, 30] },
        Solid { base_m: [0.17, 0.05, 0.0], size_m: [0.14, 0.14, 0.18], yaw_deg: -30.0, color: [30, 70, 150] },
    ]);
    let (width, height) = frame.size();
    let found = discover_with(&grid(width, height)?, &frame, &Params::default())?;
    println!(
        "{} objects from superpixels that are squares of {SIDE_PX} x {SIDE_PX} pixels",
        found.objects.len()
    );
    Ok(())
}
