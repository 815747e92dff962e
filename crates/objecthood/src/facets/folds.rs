//! Cuts facets at folds that noise hid (docs/CONTEXT.md 2.1).

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::facets::facet::Facets;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;

/// A smaller facet is not cut (px at a focal length of 525 px): each half has the pixels of the smallest object.
const LEAST_PX: usize = 400;
/// Each side of a fold has at least this share of the facet, and at least as many pixels as the smallest
/// object (px at a focal length of 525 px).
const LEAST_SHARE: f64 = 0.15;
const LEAST_SIDE_PX: usize = 200;
/// The planes meet at this angle or more (degrees): half that of two sides of a box.
const LEAST_FOLD_DEG: f64 = 40.0;
/// Two planes leave at most this share of the squared error of the curved surface, which has as many
/// parameters.
const MOST_ERROR: f64 = 0.8;
/// The number of stripes along the direction of the steepest bend; their limits are tried as folds.
const STRIPES: usize = 16;
/// The planes, and the line in which they meet, are fitted in turns this many times.
const ROUNDS: usize = 4;
/// A facet is cut at most this many times: at most three sides of a box are seen.
const MOST_CUTS: usize = 2;

/// Cuts a facet along a fold if two planes explain it better than a curved surface.
///
/// Noise raises the tolerance of merging, so that two sides of a box may become one curved facet. Both models
/// have six parameters, so the one with the smaller error is the likelier. Where noise does not raise the
/// tolerance for regions of the facet's size, nothing is done. Source: ours, because the paper's sensor has
/// no such noise. O(n log n) for the n pixels of the other facets; parallel over facets.
pub(super) fn cut_folds(facets: Facets, disparity: &Raster<f32>, space: &DisparitySpace) -> Facets {
    let least_px = space.area_px(LEAST_PX);
    let look = |facet: usize, runs: &[Range<usize>]| {
        let size: usize = runs.iter().map(ExactSizeIterator::len).sum();
        let side_px = space.length_at_525_px((size as f64).sqrt());
        let is_loose =
            facet >= facets.structure && size >= least_px && space.noise().merge_scale(side_px) > 1.0;
        is_loose.then(|| runs.iter().flat_map(|run| run.clone().map(|i| i as u32)).collect::<Vec<u32>>())
    };
    let loose: Vec<(usize, Vec<u32>)> = facets
        .segments
        .runs_of_each()
        .map(look)
        .into_iter()
        .enumerate()
        .filter_map(|(facet, pixels)| Some((facet, pixels?)))
        .collect();
    let search = Search { disparity, space, least_px, least_side_px: space.area_px(LEAST_SIDE_PX) };
    let cut: Vec<Vec<(usize, Vec<u32>)>> = loose
        .into_par_iter()
        .map(|(facet, pixels)| search.cut(pixels).into_iter().skip(1).map(|piece| (facet, piece)).collect())
        .collect();
    facets.cut_off(cut.into_iter().flatten().collect(), disparity)
}

struct Search<'a> {
    /// Disparity (quanta).
    disparity: &'a Raster<f32>,
    space: &'a DisparitySpace,
    least_px: usize,
    least_side_px: usize,
}

impl Search<'_> {
    /// The pieces of a facet: itself, if it has no fold.
    fn cut(&self, pixels: Vec<u32>) -> Vec<Vec<u32>> {
        let mut open = vec![pixels];
        let mut pieces = Vec::new();
        while let Some(pixels) = open.pop() {
            let halves = if pieces.len() + open.len() < MOST_CUTS { self.halves(&pixels) } else { None };
            match halves {
                Some(halves) => open.extend(halves),
                None => pieces.push(pixels),
            }
        }
        pieces
    }

    fn moments(&self, pixels: &[u32]) -> Moments {
        Moments::of(pixels, self.disparity)
    }

    /// The two sides of the fold of a facet.
    fn halves(&self, pixels: &[u32]) -> Option<[Vec<u32>; 2]> {
        if pixels.len() < self.least_px {
            return None;
        }
        let width = self.disparity.width();
        let place = |&i: &u32| Place {
            at: position(i as usize, width),
            disparity: self.disparity[i as usize].into(),
            is_first: false,
        };
        let mut places: Vec<Place> = pixels.iter().map(place).collect();
        let whole = self.moments(pixels);
        let curved = whole.fit(Basis::Quadratic);
        across_bend(&mut places, &curved.model, whole.center)?;
        let least = self.least_side_px.max((LEAST_SHARE * pixels.len() as f64) as usize);
        for _ in 0..ROUNDS {
            if part_by_planes(&mut places) < least {
                return None;
            }
        }
        let fits = moments_of_sides(&places).map(|moments| (moments.fit(Basis::Plane), moments.center));
        let error: f64 = fits.iter().map(|(fit, _)| fit.squared_error).sum();
        let [one, other] = fits.map(|(fit, center)| {
            DVec3::from(self.space.normal(center, fit.model.value(center), fit.model.slope(center)))
        });
        let is_fold = one.dot(other) <= libm::cos(LEAST_FOLD_DEG.to_radians());
        let side = |is_first: bool| {
            let own = pixels.iter().zip(&places).filter(|(_, place)| place.is_first == is_first);
            own.map(|(i, _)| *i).collect()
        };
        (is_fold && error <= MOST_ERROR * curved.squared_error).then(|| [true, false].map(side))
    }
}

/// A pixel of a facet.
struct Place {
    /// Column and row.
    at: [f64; 2],
    disparity: f64,
    /// Its side of the fold.
    is_first: bool,
}

/// The moments of the first side and of the other, each about its centroid, as far as planes need them.
fn moments_of_sides(places: &[Place]) -> [Moments; 2] {
    // Sums of whole numbers are exact in any order.
    let mut sums = [[0.0; 3]; 2];
    for Place { at, is_first, .. } in places {
        let [n, across, down] = &mut sums[usize::from(!is_first)];
        (*n, *across, *down) = (*n + 1.0, *across + at[0], *down + at[1]);
    }
    let mut sides = sums.map(|[n, across, down]| Moments::about([across / n, down / n]));
    for place in places {
        sides[usize::from(!place.is_first)].add_for_plane(place.at, place.disparity);
    }
    sides
}

/// Fits a plane to each side, and parts the places anew by which plane is seen there. Returns the size of the smaller side.
fn part_by_planes(places: &mut [Place]) -> usize {
    let [one, other] = moments_of_sides(places).map(|side| side.fit(Basis::Plane).model);
    // The nearer plane is the one seen at a concave fold, the farther one at a convex fold.
    let (mut first, mut nearer_of_first, mut nearer) = (0, 0, 0);
    for place in &mut *places {
        let is_nearer = one.value(place.at) > other.value(place.at);
        first += usize::from(place.is_first);
        nearer_of_first += usize::from(place.is_first & is_nearer);
        nearer += usize::from(is_nearer);
        place.is_first = is_nearer;
    }
    let is_concave = 2 * nearer_of_first > first;
    if !is_concave {
        places.iter_mut().for_each(|place| place.is_first = !place.is_first);
    }
    nearer.min(places.len() - nearer)
}

/// Parts the places at the best fold across the direction in which the surface bends most.
fn across_bend(places: &mut [Place], curved: &Model, center: [f64; 2]) -> Option<()> {
    let [cos, sin] = curved.steepest_bend();
    let along = |place: &Place| cos * (place.at[0] - center[0]) + sin * (place.at[1] - center[1]);
    let mut sorted: Vec<f64> = places.iter().map(along).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let limits: Vec<f64> = (1..STRIPES).map(|k| sorted[k * sorted.len() / STRIPES]).collect();
    let mut stripes = vec![Moments::about(center); STRIPES];
    for place in &*places {
        let stripe = limits.partition_point(|limit| *limit <= along(place));
        stripes[stripe].add_for_plane(place.at, place.disparity);
    }
    let error = |stripes: &[Moments]| {
        let sum = stripes.iter().skip(1).fold(stripes[0].clone(), |sum, next| sum.merged(next));
        if sum.count() > 0.0 { sum.fit(Basis::Plane).squared_error } else { 0.0 }
    };
    let errors = (1..STRIPES).map(|k| error(&stripes[..k]) + error(&stripes[k..]));
    let (best, _) = errors.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    places.iter_mut().for_each(|place| place.is_first = along(place) < limits[best]);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::{KINECT_QUANTA, Noise};
    use crate::regions::Segments;
    use crate::testing::kinect;

    const SIZE: (usize, usize) = (80, 60);

    /// One facet that fills the image, with this disparity (quanta) at each column; and the space of a camera with this much noise of blocks.
    fn cut(at: impl Fn(f64) -> f64, waves: f64) -> Facets {
        let (width, height) = SIZE;
        // Waves as noise makes them, by no means the same in each row.
        let wave = |u: usize, v: usize| 0.6 * libm::sin(u as f64 / 5.0 + v as f64 / 9.0);
        let seen = (0..width * height).map(|i| (at((i % width) as f64) + wave(i % width, i / width)) as f32);
        let disparity = Raster::from_vec(width, height, seen.collect()).unwrap();
        let pixels: Vec<u32> = (0..(width * height) as u32).collect();
        let model = Moments::of(&pixels, &disparity).fit(Basis::Quadratic).model;
        let segments = Segments::from_numbered(disparity.map(|_| 0), 1);
        let facets = Facets { segments, models: vec![model], structure: 0, flats: Vec::new() };
        let noise = Noise { white: 1.0, blocks_quanta: KINECT_QUANTA.map(|quanta| waves * quanta) };
        cut_folds(facets, &disparity, &kinect().with_noise(noise))
    }

    /// Two sides of a box, whose edge at column 30 is nearer to the camera (or, with -1, farther away).
    fn fold(sign: f64) -> impl Fn(f64) -> f64 {
        move |u| 351.0 - sign * 0.8 * (u - 30.0).abs()
    }

    #[test]
    fn a_fold_that_noise_hid_is_cut() {
        for sign in [1.0, -1.0] {
            let cut = cut(fold(sign), 3.0);
            assert_eq!((cut.segments.count(), cut.models.len()), (2, 2));
            let labels = cut.segments.labels();
            let wrong = (0..labels.len()).filter(|i| (labels[*i] == labels[0]) != (i % SIZE.0 < 30)).count();
            assert!(wrong <= 3 * SIZE.1, "{wrong} pixels of a fold of sign {sign}");
            let slopes = [10, 70].map(|u| cut.models[labels[u] as usize].slope([u as f64, 30.0])[0]);
            assert!(slopes[0] * sign > 0.5 && slopes[1] * sign < -0.5, "{slopes:?}");
        }
    }

    #[test]
    fn a_curved_surface_and_a_flat_one_stay_whole() {
        // 42 px wide each way, seen up to 40 px from its middle.
        let can = |u: f64| 331.0 + 0.6 * (42.0_f64.powi(2) - (u - 40.0).powi(2)).sqrt();
        assert_eq!(cut(can, 3.0).segments.count(), 1);
        assert_eq!(cut(|u| 351.0 + 0.2 * u, 3.0).segments.count(), 1);
    }

    #[test]
    fn where_noise_raises_no_tolerance_nothing_is_cut() {
        assert_eq!(cut(fold(1.0), 1.0).segments.count(), 1);
    }
}
