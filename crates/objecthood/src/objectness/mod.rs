//! Objectness: decides which regions are objects, by their size, support and borders (paper, III-D).
//!
//! [`hypotheses`] rates every region in six parts: [`size`], support, footing (`context` only),
//! [`compactness`], separation and visibility. The last two follow from the [`outline`], and separation also
//! from the contrast across it. [`decision`] keeps the hypotheses that are objects. [`objects`] numbers and
//! describes them.
//!
//! On a box of 10 cm, seen from above:
//!
//! ```
//! # use objecthood::attitude::Attitude;
//! # use objecthood::surface::surfaces::find_surfaces;
//! # use objecthood::oversegment::structure::find_structure;
//! # use objecthood::oversegment::linked::flood_superpixels;
//! # use objecthood::facets::find_facets;
//! # use objecthood::shapes::border::measure_borders;
//! # use objecthood::shapes::contraction::{contract, sum_votes};
//! # use objecthood::clusters::fill::fill_facets;
//! # use objecthood::clusters::rules::{Rules, find_clusters};
//! # use objecthood::clusters::scene::Scene;
//! # use objecthood::clusters::steps::StepLimits;
//! # use objecthood::support::standing::{StandingParams, find_standing};
//! use objecthood::objectness::conclusion::{ContextScene, conclude_context};
//! use objecthood::objectness::hypotheses::find_cluster_hypotheses;
//!
//! # use objecthood::{Camera, Frame, Params, Raster};
//! # let seen_m = |i: usize| if (60..100).contains(&(i % 160)) && (40..80).contains(&(i / 160)) { 0.9 } else { 1.0 };
//! # let depth_m = Raster::from_vec(160, 120, (0..160 * 120).map(seen_m).collect())?;
//! # let frame = Frame::new(depth_m, None, Camera::new(131.0, 131.0, 79.5, 59.5)?)?;
//! let params = Params::default();
//! # let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
//! # let attitude = Attitude::of(&frame, &params.gravity);
//! # let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
//! # let superpixels = flood_superpixels(&surfaces, &structure, &params.watershed);
//! # let facets = find_facets(&surfaces, &structure, &superpixels, &params.merging, &params.refinement);
//! # let borders = measure_borders(&facets, &surfaces, &params.border);
//! # let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));
//! # let steps = StepLimits::of(&params.watershed, &surfaces.space);
//! # let filled = fill_facets(&facets, &surfaces.disparity, steps);
//! # let points_m = frame.points_m();
//! # let scene = Scene::new(&frame, &surfaces, &structure, &filled, &points_m, steps);
//! # let clusters = find_clusters(&scene, &shapes, Rules::of(&params));
//! # let standing = find_standing(&frame, &scene, &clusters, StandingParams::of(&params));
//! let Params { gravity, contraction, objectness, .. } = &params;
//! let hypotheses = find_cluster_hypotheses(&scene, &clusters, &standing, objectness, contraction);
//! let (facets, points_m) = (&filled, &points_m);
//! let all = ContextScene { surfaces: &surfaces, structure: &structure, facets, points_m, standing: &standing };
//! let found = conclude_context(&all, &hypotheses, gravity, objectness)?;
//! assert_eq!(found.objects.len(), 1);
//! # Ok::<(), objecthood::Error>(())
//! ```

pub mod compactness;
pub mod conclusion;
mod contrast;
pub mod decision;
pub mod hypotheses;
pub mod objects;
pub mod outline;
pub mod size;
