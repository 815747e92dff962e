//! Cuts facets along colour where their surface folds inwards (docs/CONTEXT.md 2.3).

mod sides;
mod splits;

use std::collections::BTreeMap;
use std::ops::Range;

use glam::Vec3;

use self::sides::{Part, Sides};
use self::splits::find_splits;
use crate::color::histogram::ColorHistogram;
use crate::color::image::LabImage;
use crate::color::weighted;
use crate::facets::facet::Facets;
use crate::params::{self, Params};
use crate::raster::Raster;
use crate::regions::{RegionEdge, RegionGraph, Segments};
use crate::shapes::border::{BorderEvidence, measure_borders_among};
use crate::shapes::contraction::contract;
use crate::surface::disparity::DisparitySpace;
use crate::surface::model::{Basis, Fit};
use crate::surface::moments::Moments;
use crate::surface::surfaces::Surfaces;

/// Least number of pixels of a part (px at a focal length of 525 px): as many as the smallest piece of a vessel.
const LEAST_PX: usize = 60;
/// Two things have few parts, print has many.
const MOST_PARTS: usize = 4;
/// The colours of both sides overlap by at most this share: as little as those of two vessels.
const MOST_OVERLAP: f64 = 0.2;
/// About this many colours of a facet are compared.
const SAMPLED_PX: usize = 200;

/// Cuts each facet that holds things of different colours, if its surface folds inwards where colour changes.
///
/// A quadratic is flexible: one fits a bowl and the ball in it, or the near sides of two cans. Colour proposes
/// parts, and the border between two parts decides, as it does between two facets (docs/CONTEXT.md 3.1): below
/// print the surface goes on. Source: the paper divides wherever colour changes; that depth has to agree is
/// ours, because it pays with many facets on printed things. O(pixels of the facets that are no structure);
/// parallel over facets.
pub fn cut_colors(facets: Facets, surfaces: &Surfaces, params: &Params) -> Facets {
    let params = &params.color_cuts;
    let Some(lab) = surfaces.lab.as_ref().filter(|_| params.enabled) else { return facets };
    let (disparity, space) = (&surfaces.disparity, &surfaces.space);
    // At a small focal length the limit is below one pixel.
    Search { lab, disparity, space, least_px: space.area_px(LEAST_PX).max(1) }.cut(facets, params)
}

/// The parts that a facet may be cut into.
struct Proposal {
    facet: usize,
    /// The pixels of each part, in scan order.
    parts: Vec<Vec<u32>>,
}

struct Search<'a> {
    lab: &'a LabImage,
    /// Disparity (quanta).
    disparity: &'a Raster<f32>,
    space: &'a DisparitySpace,
    least_px: usize,
}

impl Search<'_> {
    fn cut(&self, facets: Facets, params: &params::ColorCuts) -> Facets {
        let proposals = self.propose(&facets);
        if proposals.is_empty() {
            return facets;
        }
        let mut pieces = self.join(&proposals, params).into_iter();
        let Facets { segments, mut models, structure, flats } = facets;
        let mut labels = segments.into_labels();
        for Proposal { facet, parts } in proposals {
            let mut pixels_of: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
            for (part, piece) in parts.into_iter().zip(&mut pieces) {
                pixels_of.entry(piece).or_default().extend(part);
            }
            if pixels_of.len() < 2 {
                continue;
            }
            // The first piece keeps the number of the facet.
            let numbers = std::iter::once(facet).chain(models.len()..);
            for (number, pixels) in numbers.zip(pixels_of.into_values()) {
                let model = self.fit(&pixels).model;
                match models.get_mut(number) {
                    Some(of_facet) => *of_facet = model,
                    None => models.push(model),
                }
                pixels.iter().for_each(|&i| labels.as_mut_slice()[i as usize] = number as i32);
            }
        }
        Facets { segments: Segments::from_numbered(labels, models.len()), models, structure, flats }
    }

    fn fit(&self, pixels: &[u32]) -> Fit {
        Moments::of(pixels, self.disparity).fit(Basis::Quadratic)
    }

    /// The proposals for all facets that are no structure, in the order of the facets.
    fn propose(&self, facets: &Facets) -> Vec<Proposal> {
        let propose = |facet: usize, runs: &[Range<usize>]| {
            let size_px: usize = runs.iter().map(ExactSizeIterator::len).sum();
            let is_large = facet >= facets.structure && size_px >= 2 * self.least_px;
            let parts = is_large.then(|| self.find_parts(runs, size_px)).flatten()?;
            Some(Proposal { facet, parts: parts.into_iter().map(|part| part.pixels).collect() })
        };
        facets.segments.runs_of_each().map(propose).into_iter().flatten().collect()
    }

    /// The parts of the split whose parts fit best each by itself; `None` without a split.
    fn find_parts(&self, runs: &[Range<usize>], size_px: usize) -> Option<Vec<Part>> {
        let mut pixels: Vec<u32> = Vec::with_capacity(size_px);
        runs.iter().for_each(|run| pixels.extend(run.start as u32..run.end as u32));
        let sampled = pixels.iter().step_by(size_px.div_ceil(SAMPLED_PX));
        let colors: Vec<Vec3> = sampled.map(|&i| weighted(self.lab[i as usize])).collect();
        let least_share = self.least_px as f32 / size_px as f32;
        let parts = find_splits(&colors, least_share).into_iter().filter_map(|split| {
            let is_above = |u: usize, v: usize| split.is_above(weighted(self.lab.cell(u / 2, v / 2)));
            let sides = Sides::of(runs, self.disparity.width(), is_above);
            let parts = sides.smoothed().into_parts(self.least_px)?;
            let is_few = (2..=MOST_PARTS).contains(&parts.len());
            (is_few && self.overlap(&parts) <= MOST_OVERLAP).then_some(parts)
        });
        let parts: Vec<Vec<Part>> = parts.collect();
        if parts.len() < 2 {
            return parts.into_iter().next();
        }
        parts.into_iter().min_by(|a, b| self.error(a).total_cmp(&self.error(b)))
    }

    /// The overlap of the colours of both sides.
    fn overlap(&self, parts: &[Part]) -> f64 {
        let [below, above] = [false, true].map(|is_above| {
            let own = || parts.iter().filter(|part| part.is_above == is_above).flat_map(|part| &part.pixels);
            let step = own().count().div_ceil(SAMPLED_PX).max(1);
            ColorHistogram::of(own().step_by(step).map(|&i| self.lab[i as usize]))
        });
        below.overlap(&above)
    }

    /// The squared error (quanta^2) that the surfaces of the parts leave.
    fn error(&self, parts: &[Part]) -> f64 {
        parts.iter().map(|part| self.fit(&part.pixels).squared_error).sum()
    }

    /// The piece that each part belongs to, all parts of all proposals in a row: parts of one facet that their
    /// borders do not separate are one piece.
    fn join(&self, proposals: &[Proposal], params: &params::ColorCuts) -> Vec<u32> {
        let mut labels = self.disparity.map(|_| -1);
        let (mut facet_of, mut models) = (Vec::new(), Vec::new());
        for Proposal { facet, parts } in proposals {
            for pixels in parts {
                pixels.iter().for_each(|&i| labels.as_mut_slice()[i as usize] = models.len() as i32);
                models.push(self.fit(pixels).model);
                facet_of.push(*facet);
            }
        }
        let pixels: Vec<u32> = proposals.iter().flat_map(|proposal| proposal.parts.concat()).collect();
        let count = models.len();
        let segments = Segments::from_numbered(labels, count);
        let parts = Facets { segments, models, structure: 0, flats: Vec::new() };
        // Facets do not depend on the parameters of later stages.
        let border = params::Border::default();
        let borders = measure_borders_among(&pixels, &parts, self.disparity, self.space, &border);
        let own = borders.edges().iter().filter(|edge| facet_of[edge.a.index()] == facet_of[edge.b.index()]);
        let unity = own.map(|&RegionEdge { a, b, ref evidence }| RegionEdge {
            a,
            b,
            evidence: unity_m(evidence, params.against_share),
        });
        contract(&RegionGraph::from_sorted(count, unity.collect())).of_facet
    }
}

/// How much of a border (m) speaks for one thing: above 0 if less than `against_share` of it speaks against one.
/// A step counts as much as a clear valley, because no step is expected within a facet.
fn unity_m(border: &BorderEvidence, against_share: f64) -> f64 {
    let contraction = params::Contraction::default();
    let folds_m: f64 = border.folds.iter().map(|fold| fold.vote_m(&contraction)).sum();
    folds_m - border.step_m + against_share * (border.fold_m() + border.step_m)
}

#[cfg(test)]
mod tests;
