//! Straightens the borders of facets (docs/CONTEXT.md 2.2).

use rayon::prelude::*;

use crate::facets::facet::Facets;
use crate::params;
use crate::raster::{Raster, marked, part};
use crate::regions::Segments;
use crate::simd::vectorized;
use crate::surface::disparity::position;

/// Passes over the borders.
const PASSES: usize = 4;
/// A neighbour whose disparity differs by more than this (quanta) has no vote: it lies on another surface in space.
const NEIGHBOUR_QUANTA: f32 = 15.0;
/// Least number of pixels for one task of a thread.
const LEAST_PX_A_THREAD: usize = 1024;
/// A misfit counts at most this much (quanta), so that outliers follow their neighbours.
const MISFIT_CAP: f64 = 6.0;
/// Bonus for a pixel's present facet (quanta).
const INERTIA: f64 = 0.1;

/// Gives each border pixel and each pixel without a facet the facet of least energy among its neighbours' facets: a small misfit
/// and many neighbours in the facet make the energy small (iterated conditional modes, Besag 1986). All pixels change at the same
/// time, so their order does not matter. The models do not change.
///
/// After the first pass only pixels beside a change are examined again: the others would keep their facets. O(pixels + border
/// pixels + passes · changes); parallel over pixels.
pub fn refine(facets: Facets, disparity: &Raster<f32>, params: &params::Refinement) -> Facets {
    let Facets { segments, models, structure, flats } = facets;
    let count = segments.count();
    let mut labels = segments.into_labels();
    let (width, height) = labels.size();
    let mut active = find_open_pixels(&labels, disparity);
    let mut asked_in = start_passes(width, height);
    for pass in 1..=PASSES as u8 {
        let change = |&i: &u32| {
            let i = i as usize;
            let at = position(i, width);
            let value = |l: usize| models[l].value(at);
            let label = find_best(i, &labels, disparity, value, params.agreement_quanta);
            (label != labels[i]).then_some((i, label))
        };
        let changes: Vec<(usize, i32)> =
            active.par_iter().with_min_len(LEAST_PX_A_THREAD).filter_map(change).collect();
        changes.iter().for_each(|&(i, label)| labels.as_mut_slice()[i] = label);
        active.clear();
        for (i, _) in changes {
            for j in [i - width, i, i + width].into_iter().flat_map(|i| [i - 1, i, i + 1]) {
                if asked_in[j] < pass {
                    asked_in[j] = pass;
                    active.extend(is_open(j, &labels, disparity).then_some(j as u32));
                }
            }
        }
    }
    Facets { segments: Segments::from_numbered(labels, count), models, structure, flats }
}

/// For each pixel, the last pass in which it was tested for being open: 0 = none yet. The border of the image holds 255, a pass
/// that never runs, so its pixels are never tested.
fn start_passes(width: usize, height: usize) -> Vec<u8> {
    let mut asked_in = vec![0; width * height];
    asked_in[..width].fill(u8::MAX);
    asked_in[(height - 1) * width..].fill(u8::MAX);
    for row in asked_in.chunks_mut(width) {
        (row[0], row[width - 1]) = (u8::MAX, u8::MAX);
    }
    asked_in
}

/// Finds the pixels that are open, in scan order ([`is_open`]). O(pixels); parallel over rows.
fn find_open_pixels(labels: &Raster<i32>, disparity: &Raster<f32>) -> Vec<u32> {
    let (width, height) = labels.size();
    let inner = width.saturating_sub(2);
    let of_row = |marks: &mut Vec<i32>, v: usize| {
        let [above, own, below] = [v - 1, v, v + 1].map(|v| &labels.as_slice()[v * width..(v + 1) * width]);
        let (left, right) = (part(own, 0, inner), part(own, 2, inner));
        let [above, own, below] = [above, own, below].map(|row| part(row, 1, inner));
        let measured = part(&disparity.as_slice()[v * width..], 1, inner);
        // A quick test, because most pixels have the facet of their neighbours, or no depth. Slices of one length and no branches
        // let vector units test many pixels at once.
        vectorized(
            #[inline(always)]
            || {
                for (k, mark) in marks.iter_mut().enumerate() {
                    let (label, d) = (own[k], measured[k]);
                    let differs =
                        (left[k] ^ label) | (right[k] ^ label) | (above[k] ^ label) | (below[k] ^ label);
                    *mark = i32::from((differs != 0) | (label < 0)) & i32::from(!d.is_nan());
                }
            },
        );
        let pixels = marked(marks).map(|k| v * width + 1 + k);
        pixels.filter(|&i| is_open(i, labels, disparity)).map(|i| i as u32).collect::<Vec<_>>()
    };
    let rows = (1..height.max(2) - 1).into_par_iter().map_init(|| vec![0; inner], of_row);
    rows.flatten_iter().collect()
}

/// Whether a pixel is open: measured, and either without a facet or beside a 4-neighbour of another facet. The pixel must not lie
/// at the border of the image.
fn is_open(i: usize, labels: &Raster<i32>, disparity: &Raster<f32>) -> bool {
    let width = labels.width();
    let own = labels[i];
    let differs = |j: usize| labels[j] >= 0 && labels[j] != own;
    !disparity[i].is_nan() && (own < 0 || [i + 1, i - 1, i + width, i - width].into_iter().any(differs))
}

/// The label of least energy among the labels of the 8 neighbours that are near in disparity, the first one on ties. Without such
/// a neighbour, the pixel's own label.
fn find_best(
    i: usize,
    labels: &Raster<i32>,
    disparity: &Raster<f32>,
    value: impl Fn(usize) -> f64,
    agreement: f64,
) -> i32 {
    let around_in = |v: usize| (&labels.as_slice()[v - 1..v + 2], &disparity.as_slice()[v - 1..v + 2]);
    let (own, d, width) = (labels[i], disparity[i], labels.width());
    let [(above, d_above), (beside, d_beside), (below, d_below)] = [i - width, i, i + width].map(around_in);
    let voters = [above[0], above[1], above[2], beside[0], beside[2], below[0], below[1], below[2]];
    let disparities =
        [d_above[0], d_above[1], d_above[2], d_beside[0], d_beside[2], d_below[0], d_below[1], d_below[2]];
    // False when the neighbour has no disparity (NaN).
    let mut left = those(|k| (voters[k] >= 0) & ((disparities[k] - d).abs() <= NEIGHBOUR_QUANTA));
    let energy = |label: i32, votes: u32| {
        let misfit = (f64::from(d) - value(label as usize)).abs().min(MISFIT_CAP);
        let inertia = if label == own { INERTIA } else { 0.0 };
        misfit - agreement * f64::from(votes) - inertia
    };
    let mut least: Option<(f64, i32)> = None;
    while left != 0 {
        let label = voters[left.trailing_zeros() as usize];
        let same = left & those(|k| voters[k] == label);
        left &= !same;
        if least.is_none() && left == 0 {
            // All neighbours have one label.
            return label;
        }
        let energy = energy(label, same.count_ones());
        if least.is_none_or(|(least, _)| energy.total_cmp(&least).is_lt()) {
            least = Some((energy, label));
        }
    }
    least.map_or(own, |(_, label)| label)
}

/// Eight bits, bit k for neighbour k.
#[inline(always)]
fn those(is: impl Fn(usize) -> bool) -> u8 {
    (0..8).fold(0, |bits, k| bits | u8::from(is(k)) << k)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::surface::model::{Basis, Model};
    use crate::surface::moments::Moments;
    use crate::testing::{coarse_disparity, raster, small_size};

    /// A surface of constant disparity.
    fn level(quanta: f64) -> Model {
        let mut moments = Moments::about([0.0; 2]);
        moments.add([0.0; 2], quanta);
        moments.fit(Basis::Plane).model
    }

    /// One pass, written from docs/CONTEXT.md 2.2: the new label of each pixel.
    fn naive_pass(
        labels: &Raster<i32>,
        disparity: &Raster<f32>,
        models: &[Model],
        agreement: f64,
    ) -> Raster<i32> {
        let (width, height) = labels.size();
        let new_label = |i: usize| {
            let (u, v) = (i % width, i / width);
            let is_inside = u > 0 && v > 0 && u + 1 < width && v + 1 < height;
            if !is_inside || disparity[i].is_nan() {
                return labels[i];
            }
            // The 8 neighbours, in scan order.
            let near: Vec<(usize, usize)> = (0..labels.len())
                .map(|j| (j, (j % width).abs_diff(u).pow(2) + (j / width).abs_diff(v).pow(2)))
                .filter(|&(_, squared)| squared == 1 || squared == 2)
                .collect();
            let meets_another =
                near.iter().any(|&(j, squared)| squared == 1 && labels[j] >= 0 && labels[j] != labels[i]);
            if labels[i] >= 0 && !meets_another {
                return labels[i];
            }
            let voters: Vec<i32> = near
                .iter()
                .filter(|&&(j, _)| labels[j] >= 0 && (disparity[j] - disparity[i]).abs() <= 15.0)
                .map(|&(j, _)| labels[j])
                .collect();
            let energy = |label: i32| {
                let misfit = f64::from(disparity[i]) - models[label as usize].value([u as f64, v as f64]);
                let votes = voters.iter().filter(|&&voter| voter == label).count();
                let own = if label == labels[i] { 0.1 } else { 0.0 };
                misfit.abs().min(6.0) - agreement * votes as f64 - own
            };
            let best =
                voters.iter().reduce(|best, next| if energy(*next) < energy(*best) { next } else { best });
            *best.unwrap_or(&labels[i])
        };
        labels.with_data((0..labels.len()).map(new_label).collect())
    }

    proptest! {
        #[test]
        fn borders_are_refined_as_naively(
            (disparity, labels) in
                small_size().prop_flat_map(|size| (raster(size, coarse_disparity()), raster(size, -1_i32..3))),
            agreement_quanta in 0.0..2.0,
        ) {
            // Two alike, so that energies tie.
            let models = [201.0, 204.0, 204.0].map(level).to_vec();
            let mut expected = labels.clone();
            for _ in 0..4 {
                expected = naive_pass(&expected, &disparity, &models, agreement_quanta);
            }
            let segments = Segments::from_numbered(labels.clone(), 3);
            let facets = Facets { segments, models: models.clone(), structure: 1, flats: vec![] };
            let refined = refine(facets, &disparity, &params::Refinement { agreement_quanta });
            prop_assert_eq!(refined.segments.labels(), &expected);
            prop_assert_eq!((refined.models, refined.structure, refined.segments.count()), (models, 1, 3));
            for i in 0..labels.len() {
                prop_assert!(labels[i] < 0 || expected[i] >= 0, "no pixel loses its facet");
                prop_assert!(!disparity[i].is_nan() || labels[i] == expected[i], "what is not measured stays");
            }
        }
    }

    #[test]
    fn passes_over_many_pixels_are_the_same_on_any_number_of_threads() {
        let (width, height) = (120, 90);
        let at = |i: usize| (i * 7 + i / 11 * 3 + i / 120 * 5) % 13;
        let disparity = (0..width * height).map(|i| 200.0 + (at(i) % 5) as f32).collect();
        let disparity = Raster::from_vec(width, height, disparity).unwrap();
        let labels = disparity.with_data((0..width * height).map(|i| at(i) as i32 % 4 - 1).collect());
        assert!(find_open_pixels(&labels, &disparity).len() > 4 * LEAST_PX_A_THREAD);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let models = [201.0, 203.0, 204.0].map(level).to_vec();
            let facets = Facets {
                segments: Segments::from_numbered(labels.clone(), 3),
                models,
                structure: 0,
                flats: vec![],
            };
            let params = params::Refinement::default();
            pool.install(|| refine(facets, &disparity, &params)).segments.into_labels()
        };
        let alone = on(1);
        assert_ne!(alone, labels);
        assert!([2, 8].into_iter().all(|threads| on(threads) == alone));
    }

    #[test]
    fn a_ragged_border_becomes_straight() {
        // Two levels that meet at column 6; in every other row the border is two pixels off.
        let at = |i: usize| (i % 12, i / 12);
        let disparity =
            Raster::from_vec(12, 9, (0..108).map(|i| if at(i).0 < 6 { 200.0 } else { 204.0 }).collect());
        let disparity = disparity.unwrap();
        let ragged = disparity.with_data(
            (0..108).map(|i| i32::from(at(i).0 >= 6 + 2 * usize::from(at(i).1 % 2 == 1))).collect(),
        );
        let facets = Facets {
            segments: Segments::from_numbered(ragged, 2),
            models: vec![level(200.0), level(204.0)],
            structure: 0,
            flats: vec![],
        };
        let refined = refine(facets, &disparity, &params::Refinement::default());
        for i in (0..108).filter(|&i| (1..8).contains(&at(i).1)) {
            assert_eq!(refined.segments.labels()[i], i32::from(at(i).0 >= 6), "{:?}", at(i));
        }
    }
}
