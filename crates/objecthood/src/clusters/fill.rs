//! Gives measured pixels without a facet to a facet that they touch (docs/CONTEXT.md 4.1).

use std::collections::VecDeque;

use rayon::prelude::*;

use crate::clusters::steps::StepLimits;
use crate::facets::Facets;
use crate::neighbours::four_neighbours;
use crate::raster::{Raster, marked};
use crate::regions::Segments;
use crate::simd::vectorized;

/// Gives measured pixels without a facet the facet of a neighbour that they touch. The search is breadth first and starts at the
/// pixels with a facet, in scan order. O(pixels).
pub fn fill_facets(facets: &Facets, disparity: &Raster<f32>, steps: StepLimits) -> Facets {
    let count = facets.segments.count();
    let mut labels = facets.segments.labels().clone();
    let (width, height) = labels.size();
    let mut open = VecDeque::from(find_givers(&labels, disparity, steps));
    let slice = labels.as_mut_slice();
    while let Some(i) = open.pop_front() {
        for (j, _) in four_neighbours(i, width, height) {
            if slice[j] < 0 && steps.touch(disparity, i, j) {
                slice[j] = slice[i];
                open.push_back(j);
            }
        }
    }
    let Facets { models, structure, flats, .. } = facets;
    let segments = Segments::from_numbered(labels, count);
    Facets { segments, models: models.clone(), structure: *structure, flats: flats.clone() }
}

/// The pixels with a facet that touch a measured pixel without one, in scan order. O(pixels + n log n) for n such pixels; parallel
/// over rows.
fn find_givers(labels: &Raster<i32>, disparity: &Raster<f32>, steps: StepLimits) -> Vec<usize> {
    let (width, height) = labels.size();
    let givers_around = |is_bare: &mut Vec<i32>, v: usize| {
        let row = v * width..(v + 1) * width;
        let pixels = labels.as_slice()[row.clone()].iter().zip(&disparity.as_slice()[row.clone()]);
        vectorized(
            #[inline(always)]
            || {
                for (is_bare, (label, d)) in is_bare.iter_mut().zip(pixels) {
                    *is_bare = i32::from(*label < 0) & i32::from(!d.is_nan());
                }
            },
        );
        let mut givers = Vec::new();
        for i in marked(is_bare).map(|u| row.start + u) {
            let near = four_neighbours(i, width, height).map(|(j, _)| j);
            givers.extend(near.filter(|&j| labels[j] >= 0 && steps.touch(disparity, i, j)));
        }
        givers
    };
    let rows = (0..height).into_par_iter().map_init(|| vec![0; width], givers_around);
    let mut givers: Vec<usize> = rows.flatten_iter().collect();
    givers.sort_unstable();
    givers.dedup();
    givers
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{coarse_disparity, raster, small_size};

    proptest! {
        #[test]
        fn what_is_not_labelled_is_filled_from_its_neighbours(
            (disparity, labels) in
                small_size().prop_flat_map(|size| (raster(size, coarse_disparity()), raster(size, -1_i32..2))),
        ) {
            let labels = disparity.with_data(
                (0..labels.len()).map(|i| if disparity[i].is_nan() { -1 } else { labels[i] }).collect(),
            );
            let facets = Facets { segments: Segments::from_numbered(labels.clone(), 2), models: Vec::new(), structure: 0, flats: vec![] };
            let steps = StepLimits { touch_quanta: 3.0, level_quanta: 2.0 };
            let filled = fill_facets(&facets, &disparity, steps).segments;
            let (width, height) = labels.size();
            // Breadth first from every pixel with a facet.
            let mut expected = labels.as_slice().to_vec();
            let mut open: VecDeque<usize> = (0..expected.len()).filter(|&i| expected[i] >= 0).collect();
            while let Some(i) = open.pop_front() {
                for (j, _) in four_neighbours(i, width, height) {
                    if expected[j] < 0 && (disparity[j] - disparity[i]).abs() <= 3.0 {
                        expected[j] = expected[i];
                        open.push_back(j);
                    }
                }
            }
            prop_assert_eq!(filled.labels().as_slice(), expected);
            for i in 0..labels.len() {
                let own = filled.labels()[i];
                let near = four_neighbours(i, width, height).map(|(j, _)| j);
                let mut near = near.filter(|&j| (disparity[j] - disparity[i]).abs() <= 3.0);
                if labels[i] >= 0 {
                    prop_assert_eq!(own, labels[i], "a label stays");
                } else if own >= 0 {
                    prop_assert!(near.any(|j| filled.labels()[j] == own), "it comes from a neighbour");
                } else {
                    prop_assert!(near.all(|j| filled.labels()[j] < 0), "what can be reached is filled");
                }
            }
        }
    }
}
