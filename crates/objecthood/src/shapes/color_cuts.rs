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
use crate::regions::{RegionEdge, RegionGraph, SegmentId, Segments, connect};
use crate::shapes::border::color_change::spread;
use crate::shapes::border::measure_by_depth;
use crate::shapes::contraction::contract;
use crate::surface::disparity::DisparitySpace;
use crate::surface::model::{Basis, Fit, TERMS};
use crate::surface::moments::Moments;
use crate::surface::surfaces::Surfaces;

/// Least number of pixels of a part (px at a focal length of 525 px): as many as a piece of an inside (docs/CONTEXT.md 4.4.1). Times the
/// waves of the noise, at least 1: where they are larger, small parts took the valleys from their facets that had kept things apart.
const LEAST_PX: usize = 60;
/// Two things have few parts, print has many: a thing and one that crosses it make three.
const MOST_PARTS: usize = 4;
/// The colours of both sides overlap by at most this share: less than the parts of a vessel share.
const MOST_OVERLAP: f64 = 0.2;

/// Cuts each facet that holds things of different colours, if its surface folds inwards where colour changes.
/// Runs before flat things are found, because their facets are the last ones.
///
/// A quadratic is flexible: one fits a bowl and the ball in it, or the near sides of two cans. Colour proposes
/// parts, and the border between two parts decides, as it does between two facets (docs/CONTEXT.md 3.1): under
/// print the surface goes on. Source: the paper divides wherever colour changes; that depth has to agree is
/// ours, because it pays with many facets on printed things. O(image · facets that are cut + bounding boxes of
/// the facets + runs · log(runs) + border pixels · radius^2); proposals and borders in parallel.
pub fn cut_colors(facets: Facets, surfaces: &Surfaces, params: &Params) -> Facets {
    let params = &params.color_cuts;
    let Some(lab) = surfaces.lab.as_ref().filter(|_| params.enabled) else { return facets };
    let (disparity, space) = (&surfaces.disparity, &surfaces.space);
    // At a small focal length the limit is below one pixel.
    let least_px = (space.area_px(LEAST_PX).max(1) as f64 * space.noise().sure_waves().max(1.0)) as usize;
    Search { lab, disparity, space, least_px }.cut(facets, params)
}

/// The parts that a facet may be cut into.
struct Proposal {
    facet: usize,
    parts: Vec<Part>,
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
        facets.cut_off(self.judge(proposals, params), self.disparity)
    }

    fn fit(&self, pixels: &[u32]) -> Fit {
        Moments::of(pixels, self.disparity).fit(Basis::Quadratic)
    }

    /// The proposals for all facets that are no structure, in the order of the facets.
    fn propose(&self, facets: &Facets) -> Vec<Proposal> {
        let propose = |facet: usize, runs: &[Range<usize>]| {
            let size_px: usize = runs.iter().map(ExactSizeIterator::len).sum();
            let is_large = facet >= facets.structure && size_px / 2 >= self.least_px;
            let parts = is_large.then(|| self.find_parts(&self.without_crumbs(runs))).flatten()?;
            Some(Proposal { facet, parts })
        };
        facets.segments.runs_of_each().map(propose).into_iter().flatten().collect()
    }

    /// The runs of a facet without its connected areas that are too small for a part.
    fn without_crumbs(&self, runs: &[Range<usize>]) -> Vec<Range<usize>> {
        let labelled: Vec<(Range<usize>, usize)> = runs.iter().cloned().map(|run| (run, 0)).collect();
        let (area_of, count) = connect(&labelled, self.disparity.width());
        let mut sizes_px = vec![0; count];
        for (run, area) in runs.iter().zip(&area_of) {
            sizes_px[*area as usize] += run.len();
        }
        let is_large = |area: u32| sizes_px[area as usize] >= self.least_px;
        runs.iter().zip(area_of).filter(|(_, area)| is_large(*area)).map(|(run, _)| run.clone()).collect()
    }

    /// The parts of the split whose parts fit best each by itself; `None` without a split.
    fn find_parts(&self, runs: &[Range<usize>]) -> Option<Vec<Part>> {
        let mut pixels: Vec<u32> = Vec::new();
        runs.iter().for_each(|run| pixels.extend(run.start as u32..run.end as u32));
        if pixels.len() / 2 < self.least_px {
            return None;
        }
        let colors: Vec<Vec3> = spread(&pixels).map(|i| weighted(self.lab[i])).collect();
        let least_share = self.least_px as f32 / pixels.len() as f32;
        let parts = find_splits(&colors, least_share).into_iter().filter_map(|split| {
            let is_above = |u: usize, v: usize| split.is_above(weighted(self.lab.cell(u / 2, v / 2)));
            let sides = Sides::of(runs, self.disparity.width(), is_above);
            let parts = sides.smoothed().into_parts(self.least_px)?;
            let is_few = (2..=MOST_PARTS).contains(&parts.len());
            let are_two = parts.iter().any(|part| part.is_above != parts[0].is_above);
            (is_few && are_two && self.overlap(&parts) <= MOST_OVERLAP).then_some(parts)
        });
        let parts: Vec<Vec<Part>> = parts.collect();
        if parts.len() < 2 {
            return parts.into_iter().next();
        }
        parts.into_iter().min_by(|a, b| self.variance(a).total_cmp(&self.variance(b)))
    }

    /// The overlap of the colours of both sides.
    fn overlap(&self, parts: &[Part]) -> f64 {
        let [below, above] = [false, true].map(|is_above| {
            let own = parts.iter().filter(|part| part.is_above == is_above);
            ColorHistogram::of(own.flat_map(|part| spread(&part.pixels)).map(|i| self.lab[i]))
        });
        below.overlap(&above)
    }

    /// The variance (quanta^2) that a surface for each part leaves.
    fn variance(&self, parts: &[Part]) -> f64 {
        let errors = parts.iter().map(|part| self.fit(&part.pixels).squared_error);
        let freedom: usize = parts.iter().map(|part| part.pixels.len().saturating_sub(TERMS.len())).sum();
        errors.sum::<f64>() / freedom.max(1) as f64
    }

    /// What is cut off from facets: the facet, and the pixels. Parts that neither a border nor, without one, their
    /// colours separate stay together. The largest group of parts, the last of equal ones, stays with the facet.
    fn judge(&self, proposals: Vec<Proposal>, params: &params::ColorCuts) -> Vec<(usize, Vec<u32>)> {
        let mut group_of = contract(&self.weigh(&proposals, params)).of_facet.into_iter();
        let mut cut = Vec::new();
        for Proposal { facet, parts } in proposals {
            let mut groups: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
            // In this order nothing is taken for the next proposal.
            for (part, group) in parts.into_iter().zip(&mut group_of) {
                groups.entry(group).or_default().extend(part.pixels);
            }
            let largest = groups.iter().max_by_key(|(_, pixels)| pixels.len()).map(|(group, _)| *group);
            cut.extend(
                groups
                    .into_iter()
                    .filter(|(group, _)| Some(*group) != largest)
                    .map(|(_, pixels)| (facet, pixels)),
            );
        }
        cut
    }

    /// What speaks for one thing (m) between the parts of each proposal, above 0, and against. Parts are numbered
    /// through. Where nothing is measured between two parts, such as across a hole, colour alone decides.
    fn weigh(&self, proposals: &[Proposal], params: &params::ColorCuts) -> RegionGraph<f64> {
        let mut labels = self.disparity.map(|_| -1);
        let mut models = Vec::new();
        let mut weights = BTreeMap::new();
        for Proposal { parts, .. } in proposals {
            let first = models.len();
            for (k, part) in parts.iter().enumerate() {
                part.pixels.iter().for_each(|&i| labels.as_mut_slice()[i as usize] = models.len() as i32);
                models.push(self.fit(&part.pixels).model);
                let before = parts[..k].iter().enumerate();
                weights.extend(before.map(|(j, other)| {
                    let is_alike = other.is_above == part.is_above;
                    ([first + j, first + k], if is_alike { f64::MIN_POSITIVE } else { 0.0 })
                }));
            }
        }
        let count = models.len();
        let segments = Segments::from_numbered(labels, count);
        let parts = Facets { segments, models, structure: 0, flats: Vec::new() };
        // Facets do not depend on the parameters of later stages. Colour proposed the parts: it does not vote again.
        let borders = measure_by_depth(&parts, self.disparity, self.space, &params::Border::default());
        // A step speaks clearly against one thing, because a surface has none.
        let votes = params::Contraction { occlusion_weight: 1.0, ..params::Contraction::default() };
        for RegionEdge { a, b, evidence } in borders.edges() {
            if let Some(weight) = weights.get_mut(&[a.index(), b.index()]) {
                *weight =
                    evidence.vote_m(&votes) + params.least_against * (evidence.fold_m() + evidence.step_m);
            }
        }
        let id = |part: usize| SegmentId(part as u32);
        let edges = weights.into_iter().map(|([a, b], evidence)| RegionEdge { a: id(a), b: id(b), evidence });
        RegionGraph::from_sorted(count, edges.collect())
    }
}

#[cfg(test)]
mod tests;
