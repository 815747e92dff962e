//! Clusters: shapes are joined into things by their surroundings (`context`, the beginning of stage 4).
//!
//! Every shape begins as a cluster. The [`rules`] join clusters or give them to the background: fragments, height, vessels, bottoms,
//! necks, occlusion. A rule decides by [checks](crate::check). The [`history`] records its joins and its refusals. The clusters that remain and are
//! large enough are candidates for objects.
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
//! use objecthood::clusters::fill::fill_facets;
//! use objecthood::clusters::rules::{Rules, find_clusters};
//! use objecthood::clusters::scene::Scene;
//! use objecthood::clusters::steps::StepLimits;
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
//! let steps = StepLimits::of(&params.watershed, &surfaces.space);
//! let filled = fill_facets(&facets, &surfaces.disparity, steps);
//! let points_m = frame.points_m();
//! let scene = Scene::new(&frame, &surfaces, &structure, &filled, &points_m, steps);
//! let clusters = find_clusters(&scene, &shapes, Rules::of(&params));
//! # Ok::<(), objecthood::Error>(())
//! ```

pub(crate) mod borders;
pub(crate) mod bottoms;
pub(crate) mod bumps;
pub(crate) mod candidates;
pub(crate) mod cluster;
pub mod clustering;
mod colors;
mod convexity;
mod deep_bottoms;
pub mod fill;
pub(crate) mod fragments;
pub(crate) mod height;
pub mod history;
pub(crate) mod necks;
pub(crate) mod occlusion;
mod own_support;
mod patches;
mod rim;
pub mod rules;
pub mod scene;
pub mod steps;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod vessels;
