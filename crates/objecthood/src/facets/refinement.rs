//! The borders of facets, straightened (METHOD 3.6).

use rayon::prelude::*;

use crate::facets::Facets;
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::position;

/// Passes over the borders.
const PASSES: usize = 4;
/// Neighbours in the image that differ by more (quanta) are none in space.
const NEIGHBOUR_QUANTA: f32 = 15.0;
/// Misfit beyond this (quanta) counts as this: an outlier is no worse than another.
const MISFIT_CAP: f64 = 6.0;
/// What a pixel's present facet is preferred by (quanta).
const INERTIA: f64 = 0.1;

/// Gives border pixels and those without a facet to the facet of a neighbour that fits their disparity best and
/// holds most of their neighbours: iterated conditional modes (Besag 1986), synchronous, so that no order of the pixels
/// matters. The models stay. O(passes · border pixels).
pub fn refine(facets: Facets, disparity: &Raster<f32>, params: &params::Refinement) -> Facets {
    let Facets { segments, models, structure } = facets;
    let count = segments.count();
    let mut labels = segments.labels().clone();
    for _ in 0..PASSES {
        let (width, height) = labels.size();
        let mut next = labels.as_slice().to_vec();
        next.par_chunks_mut(width).enumerate().skip(1).take(height.saturating_sub(2)).for_each(|(v, row)| {
            for (u, label) in row.iter_mut().enumerate().skip(1).take(width.saturating_sub(2)) {
                let i = v * width + u;
                if is_open(i, &labels, disparity) {
                    let value = |l: usize| models[l].value(position(i, width));
                    *label = best(i, &labels, disparity, value, params.agreement_quanta);
                }
            }
        });
        let changed = next != labels.as_slice();
        labels = labels.with_data(next);
        if !changed {
            break;
        }
    }
    Facets { segments: Segments::from_numbered(labels, count), models, structure }
}

/// Whether a pixel inside the image is measured and has no facet, or a 4-neighbour of another.
fn is_open(i: usize, labels: &Raster<i32>, disparity: &Raster<f32>) -> bool {
    let width = labels.width();
    let own = labels[i];
    let differs = |j: usize| labels[j] >= 0 && labels[j] != own;
    !disparity[i].is_nan() && (own < 0 || [i + 1, i - 1, i + width, i - width].into_iter().any(differs))
}

/// The label of least energy among those of the 8 neighbours, the first one on ties; the own without any.
fn best(
    i: usize,
    labels: &Raster<i32>,
    disparity: &Raster<f32>,
    value: impl Fn(usize) -> f64,
    agreement: f64,
) -> i32 {
    let width = labels.width();
    let mut around = [(Segments::NONE, 0_u32); 8];
    let mut candidates = 0;
    for j in [i - width - 1, i - width, i - width + 1, i - 1, i + 1, i + width - 1, i + width, i + width + 1]
    {
        // False when the neighbour is not measured.
        let is_near = (disparity[j] - disparity[i]).abs() <= NEIGHBOUR_QUANTA;
        if labels[j] < 0 || !is_near {
            continue;
        }
        match around[..candidates].iter_mut().find(|(label, _)| *label == labels[j]) {
            Some((_, votes)) => *votes += 1,
            None => {
                around[candidates] = (labels[j], 1);
                candidates += 1;
            }
        }
    }
    let energy = |label: i32, votes: u32| {
        let misfit = (f64::from(disparity[i]) - value(label as usize)).abs().min(MISFIT_CAP);
        let inertia = if label == labels[i] { INERTIA } else { 0.0 };
        misfit - agreement * f64::from(votes) - inertia
    };
    let scored = around[..candidates].iter().map(|&(label, votes)| (energy(label, votes), label));
    scored.min_by(|x, y| x.0.total_cmp(&y.0)).map_or(labels[i], |(_, label)| label)
}
