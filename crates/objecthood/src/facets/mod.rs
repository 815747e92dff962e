//! Stage 2: superpixels grouped into facets, each one face of a convex shape (paper, III-B).
//!
//! `paper` groups superpixels of similar appearance ([`appearance`], [`grouping`]). `context` merges
//! superpixels on one surface ([`merging`]), cuts facets that noise merged across a fold (`folds`) and
//! straightens borders ([`refinement`]).
//!
//! On a box of 10 cm, seen from above:
//!
//! ```
//! # use objecthood::attitude::Attitude;
//! # use objecthood::surface::surfaces::find_surfaces;
//! # use objecthood::oversegment::structure::find_structure;
//! # use objecthood::oversegment::linked::flood_superpixels;
//! use objecthood::facets::find_facets;
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
//! let facets = find_facets(&surfaces, &structure, &superpixels, &params.merging, &params.refinement);
//! assert_eq!(facets.structure, 1); // facet 0 is the table
//! let of_box = facets.segments.at(60 * 160 + 80);
//! assert_eq!(of_box, facets.segments.at(50 * 160 + 70)); // its top is one facet
//! # Ok::<(), objecthood::Error>(())
//! ```

pub mod appearance;
mod bins;
pub mod facet;
pub mod flat;
mod folds;
pub mod grouping;
pub mod merging;
pub mod paper;
pub mod refinement;

pub use crate::facets::facet::{Facets, Flat};

use crate::facets::folds::cut_folds;
use crate::facets::merging::merge_surfaces;
use crate::facets::refinement::refine;
use crate::oversegment::linked::LinkedSuperpixels;
use crate::oversegment::structure::Structure;
use crate::params;
use crate::surface::surfaces::Surfaces;

/// Stage 2 of `context`: merges superpixels that lie on one surface, cuts facets at folds that noise hid, and straightens their borders.
/// See [`merge_surfaces`] and [`refine`].
pub fn find_facets(
    surfaces: &Surfaces,
    structure: &Structure,
    superpixels: &LinkedSuperpixels,
    merging: &params::Merging,
    refinement: &params::Refinement,
) -> Facets {
    let merged = merge_surfaces(superpixels, structure, &surfaces.space, merging);
    let cut = cut_folds(merged, &surfaces.disparity, &surfaces.space);
    refine(cut, &surfaces.disparity, refinement)
}
