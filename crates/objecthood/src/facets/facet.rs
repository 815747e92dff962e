//! The facets of `context`, and the flat things among them.

use crate::check::Check;
use crate::regions::{SegmentId, Segments};
use crate::surface::model::Model;

/// Facets of `context`: regions with one surface model each. The facets of the structure come first.
#[derive(Clone, Debug)]
pub struct Facets {
    /// The label map.
    pub segments: Segments,
    /// The surface of every facet.
    pub models: Vec<Model>,
    /// Number of facets that are structure.
    pub structure: usize,
    /// The flat things on supports; their facets have consecutive numbers.
    pub flats: Vec<Flat>,
}

impl Facets {
    /// Whether a facet is a flat thing. O(1).
    pub(crate) fn is_flat(&self, facet: SegmentId) -> bool {
        let first = self.flats.first().map(|flat| flat.facet.index());
        first.is_some_and(|first| (first..first + self.flats.len()).contains(&facet.index()))
    }
}

/// A flat thing: a facet, with the evidence for it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Flat {
    /// Its facet.
    pub facet: SegmentId,
    /// Whether depth proves it: it rises above its surroundings by more than noise. Otherwise colour alone shows it.
    pub is_proven: bool,
    /// The checks that decided; all of them hold.
    pub checks: Vec<Check>,
}

/// Separation of a flat thing that colour alone shows: as good as sure, but below everything that depth shows.
const COLOR_SEPARATION: f32 = 0.75;

impl Flat {
    /// How clear its border is, in [0, 1].
    pub(crate) fn separation(&self) -> f32 {
        if self.is_proven { 1.0 } else { COLOR_SEPARATION }
    }
}
