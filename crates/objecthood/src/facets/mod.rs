//! Stage 2: superpixels grouped to facets, each one face of a convex shape (paper, III-B).
//!
//! `paper` groups what looks alike ([`appearance`], [`grouping`]); `context` merges what lies on one surface
//! ([`merging`]) and straightens the borders ([`refinement`]).

pub mod appearance;
mod bins;
pub mod grouping;
pub mod merging;
pub mod refinement;

use crate::facets::merging::merge_surfaces;
use crate::facets::refinement::refine;
use crate::oversegment::linked::LinkedSuperpixels;
use crate::oversegment::structure::Structure;
use crate::params;
use crate::regions::Segments;
use crate::surface::model::Model;
use crate::surface::surfaces::Surfaces;

/// Facets of `context`: surfaces of one model each. Those of the structure come first.
#[derive(Clone, Debug)]
pub struct Facets {
    /// The label map.
    pub segments: Segments,
    /// The surface of every facet.
    pub models: Vec<Model>,
    /// How many of them are structure.
    pub structure: usize,
}

/// Stage 2 of `context`: merges superpixels that lie on one surface, and straightens the borders of what comes of it.
/// As [`merge_surfaces`] and [`refine`].
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
