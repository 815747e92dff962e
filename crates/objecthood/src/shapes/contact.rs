//! Which regions are close to each other in space (paper, III-C: "close in 3-D Euclidean space").

use glam::Vec3;

use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};

/// The number of point pairs in contact between any two regions.
///
/// From every pixel with depth the four directions right, down, down-right and down-left are walked for at most
/// `reach_px`, across pixels without depth or region and of the same region, to the first pixel of another region;
/// the pair counts when its points are nearer than `distance_m`. O(pixels · `reach_px`).
pub fn contacts(
    segments: &Segments,
    points_m: &Raster<[f32; 3]>,
    params: &params::Contact,
) -> RegionGraph<u32> {
    let regions = touching_pairs(segments, points_m, params)
        .filter_map(|(p, q)| Some((segments.at(p)?, segments.at(q)?)));
    RegionGraph::from_pairs(segments.count(), regions)
}

/// The pairs that [`contacts`] counts, in scan order.
pub(crate) fn touching_pairs<'a>(
    segments: &'a Segments,
    points_m: &'a Raster<[f32; 3]>,
    params: &'a params::Contact,
) -> impl Iterator<Item = (usize, usize)> + 'a {
    let labels = segments.labels();
    let (width, height) = labels.size();
    let region = move |i: usize| segments.at(i).filter(|_| !points_m[i][2].is_nan());
    let owned = (0..labels.len()).filter_map(move |p| Some((p, region(p)?)));
    owned.flat_map(move |(p, own)| {
        let (u, v) = (p % width, p / width);
        let (right, down, left) = (width - 1 - u, height - 1 - v, u);
        let ways = [(right, 1), (down, width), (down.min(right), width + 1), (down.min(left), width - 1)];
        ways.into_iter().filter_map(move |(room, step)| {
            let mut way = (1..=room.min(params.reach_px)).map(|t| p + t * step);
            let other = way.find(|&q| region(q).is_some_and(|other| other != own))?;
            let apart_m = Vec3::from(points_m[p]).distance(Vec3::from(points_m[other]));
            (apart_m < params.distance_m).then_some((p, other))
        })
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn contacts_are_the_brute_force_ones(
            (width, pixels) in (1_usize..9, 1_usize..9)
                .prop_flat_map(|(w, h)| (Just(w), prop::collection::vec((-1_i32..4, 0_u8..8, 0.0_f32..0.06), w * h))),
            reach_px in 1_usize..6,
        ) {
            let height = pixels.len() / width;
            let labels = Raster::from_vec(width, height, pixels.iter().map(|p| p.0).collect()).unwrap();
            let segments = Segments::from_labels(&labels);
            let point = |(i, p): (usize, &(i32, u8, f32))| match p.1 {
                0 => [f32::NAN; 3],
                _ => [(i % width) as f32 * 0.004, (i / width) as f32 * 0.004, 1.0 + p.2],
            };
            let points = Raster::from_vec(width, height, pixels.iter().enumerate().map(point).collect()).unwrap();
            let params = params::Contact { reach_px, distance_m: 0.02 };

            let mut expected = BTreeMap::new();
            for p in 0..labels.len() {
                let at = |step: (isize, isize), t: usize| {
                    let u = (p % width) as isize + step.0 * t as isize;
                    let v = (p / width) as isize + step.1 * t as isize;
                    points.get(usize::try_from(u).ok()?, v as usize).map(|_| v as usize * width + u as usize)
                };
                let region = |i: usize| segments.at(i).filter(|_| !points[i][2].is_nan());
                let Some(a) = region(p) else { continue };
                for step in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
                    for q in (1..=reach_px).map_while(|t| at(step, t)) {
                        let Some(b) = region(q).filter(|&b| b != a) else { continue };
                        if Vec3::from(points[p]).distance(Vec3::from(points[q])) < 0.02 {
                            *expected.entry((a.min(b), a.max(b))).or_insert(0) += 1;
                        }
                        break;
                    }
                }
            }
            let graph = contacts(&segments, &points, &params);
            let got: Vec<_> = graph.edges().iter().map(|e| ((e.a, e.b), e.evidence)).collect();
            prop_assert_eq!(got, expected.into_iter().collect::<Vec<_>>());
        }
    }
}
