//! Stage 3: facets joined across convex edges into shapes (paper, III-C).
//!
//! `paper` compares centres and mean normals: [`contact`], [`descriptor`], [`convexity`]. `context` collects evidence along the
//! whole common border ([`border`]), and the votes of borders decide ([`contraction`]). In the same way it decides beforehand
//! where colour cuts a facet ([`color_cuts`]), and afterwards it parts flush things ([`seams`]).
//!
//! On a box of 10 cm, seen from above:
//!
//! ```
//! # use objecthood::attitude::Attitude;
//! # use objecthood::surface::surfaces::find_surfaces;
//! # use objecthood::oversegment::structure::find_structure;
//! # use objecthood::oversegment::linked::flood_superpixels;
//! # use objecthood::facets::find_facets;
//! use objecthood::shapes::border::measure_borders;
//! use objecthood::shapes::contraction::{contract, sum_votes};
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
//! let borders = measure_borders(&facets, &surfaces, &params.border);
//! assert!(borders.edges().iter().all(|border| border.evidence.vote_m(&params.contraction) < 0.0)); // steps
//! let shapes = contract(&sum_votes(&borders, facets.structure, &params.contraction));
//! # Ok::<(), objecthood::Error>(())
//! ```

pub mod border;
pub mod color_cuts;
pub mod contact;
pub mod contraction;
pub mod convexity;
pub mod descriptor;
pub mod paper;
pub mod seams;
