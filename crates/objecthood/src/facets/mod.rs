//! Stage 2: superpixels grouped to facets, each one face of a convex shape (paper, III-B).
//!
//! `paper` groups what looks alike ([`appearance`], [`grouping`]); `context` merges what lies on one surface
//! ([`merging`]) and straightens the borders ([`refinement`]).

pub mod appearance;
mod bins;
pub mod grouping;
pub mod merging;
pub mod refinement;

use crate::regions::Segments;
use crate::surface::model::Model;

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
