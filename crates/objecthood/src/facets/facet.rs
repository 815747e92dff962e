//! The facets of `context`, and the flat things among them.

use std::collections::BTreeMap;

use crate::check::Check;
use crate::raster::Raster;
use crate::regions::{SegmentId, Segments};
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;

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

    /// Cuts pieces off facets, and makes each a facet of its own, after all others. `pieces`: the facet that each
    /// lies in, of which something is left, and its pixels. The surfaces of the pieces, and of what is left of their
    /// facets, are fitted anew. O(image), without a piece O(1).
    pub(crate) fn cut_off(self, pieces: Vec<(usize, Vec<u32>)>, disparity: &Raster<f32>) -> Self {
        if pieces.is_empty() {
            return self;
        }
        let fit = |pixels: &[u32]| Moments::of(pixels, disparity).fit(Basis::Quadratic).model;
        let Self { segments, mut models, structure, flats } = self;
        let mut labels = segments.into_labels();
        let mut left: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (facet, pixels) in pieces {
            pixels.iter().for_each(|&i| labels.as_mut_slice()[i as usize] = models.len() as i32);
            models.push(fit(&pixels));
            left.insert(facet, Vec::new());
        }
        let segments = Segments::from_numbered(labels, models.len());
        for (run, facet) in segments.runs() {
            if let Some(pixels) = left.get_mut(&facet) {
                pixels.extend(run.start as u32..run.end as u32);
            }
        }
        left.iter().for_each(|(facet, pixels)| models[*facet] = fit(pixels));
        Self { segments, models, structure, flats }
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
