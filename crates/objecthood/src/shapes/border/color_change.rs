//! The colours of facets, and which of them differ (docs/CONTEXT.md 3.1).

use std::ops::Range;

use crate::color::histogram::ColorHistogram;
use crate::color::image::LabImage;
use crate::facets::Facets;
use crate::regions::SegmentId;
use crate::surface::disparity::DisparitySpace;

/// The colours of a smaller facet are not compared (px at a focal length of 525 px): it may show only a part of a print.
const LEAST_PX: usize = 60;
/// Colours that overlap by at most this share differ. Half of what cuts along colour allow, because nothing says that the
/// facets hold two things.
const MOST_OVERLAP: f64 = 0.1;
/// At most this many colours of a facet are counted.
const SAMPLED: usize = 200;
/// The steps of this share of the whole, wrapped around, spread evenly over rows and columns.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The colours of each facet that is no structure and not too small.
pub(super) struct FacetColors(Vec<Option<ColorHistogram>>);

impl FacetColors {
    /// O(image).
    pub(super) fn of(facets: &Facets, lab: &LabImage, space: &DisparitySpace) -> Self {
        // At a small focal length the limit is below one pixel.
        let least_px = space.area_px(LEAST_PX).max(1);
        let colors = |facet: usize, runs: &[Range<usize>]| {
            let size_px: usize = runs.iter().map(ExactSizeIterator::len).sum();
            let is_compared = facet >= facets.structure && size_px >= least_px;
            is_compared.then(|| {
                let pixels: Vec<u32> = runs.iter().flat_map(|run| run.start as u32..run.end as u32).collect();
                ColorHistogram::of(spread(&pixels).map(|i| lab[i]))
            })
        };
        Self(facets.segments.runs_of_each().map(colors))
    }

    /// Whether the colours of two facets hardly overlap. Source: ours, because a valley between two colours is
    /// likelier to part two things than one between faces of one colour. O(1).
    pub(super) fn differ(&self, [a, b]: [SegmentId; 2]) -> bool {
        let sides = self.0[a.index()].as_ref().zip(self.0[b.index()].as_ref());
        sides.is_some_and(|(a, b)| a.overlap(b) <= MOST_OVERLAP)
    }
}

/// At most [`SAMPLED`] of these pixels, spread over rows and columns.
pub(in crate::shapes) fn spread(pixels: &[u32]) -> impl Iterator<Item = usize> {
    let all = pixels.len();
    (0..all.min(SAMPLED)).map(move |k| {
        let place = if all <= SAMPLED { k } else { ((k as f64 * GOLDEN).fract() * all as f64) as usize };
        pixels[place] as usize
    })
}
