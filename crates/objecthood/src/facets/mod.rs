//! Stage 2: superpixels grouped to facets, each one face of a convex shape (paper, III-B).
//!
//! `paper` groups superpixels of similar appearance ([`appearance`], [`grouping`]). `context` merges superpixels on one surface
//! ([`merging`]) and straightens their borders ([`refinement`]).

pub mod appearance;
mod bins;
pub mod grouping;
pub mod merging;
pub mod paper;
pub mod refinement;

pub use crate::facets::merging::Facets;

use crate::facets::merging::merge_surfaces;
use crate::facets::refinement::refine;
use crate::oversegment::linked::LinkedSuperpixels;
use crate::oversegment::structure::Structure;
use crate::params;
use crate::surface::surfaces::Surfaces;

/// Stage 2 of `context`: merges superpixels that lie on one surface, and straightens the borders of the facets.
/// See [`merge_surfaces`] and [`refine`].
pub fn find_facets(
    surfaces: &Surfaces,
    structure: &Structure,
    superpixels: &LinkedSuperpixels,
    merging: &params::Merging,
    refinement: &params::Refinement,
) -> Facets {
    let merged = merge_surfaces(superpixels, structure, &surfaces.space, merging);
    refine(merged, &surfaces.disparity, refinement)
}
