//! Which regions are close to each other in space (paper, III-C: "close in 3-D Euclidean space").

use glam::Vec3;

use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};

/// The number of point pairs in contact between any two regions.
///
/// From every pixel with depth the four directions right, down, down-right and down-left are walked for at most
/// `reach_px`, across pixels without depth or region and of the same region, to the first pixel of another region;
/// the pair counts when its points are nearer than `distance_m`. O(pixels + pairs log pairs).
pub fn contacts(
    segments: &Segments,
    points_m: &Raster<[f32; 3]>,
    params: &params::Contact,
) -> RegionGraph<u32> {
    let regions = touching_pairs(segments, points_m, params)
        .into_iter()
        .filter_map(|(p, q)| Some((segments.at(p)?, segments.at(q)?)));
    RegionGraph::from_pairs(segments.count(), regions)
}

/// So many pixels are passed over together when nothing is within reach of any.
const STRETCH_PX: usize = 16;

/// The pairs that [`contacts`] counts, in scan order.
///
/// The image is gone through backwards, so that what lies ahead of a pixel follows from what lies ahead of the next one in
/// that direction, and nothing is walked twice. O(pixels + pairs), whatever `reach_px`.
pub(crate) fn touching_pairs(
    segments: &Segments,
    points_m: &Raster<[f32; 3]>,
    params: &params::Contact,
) -> Vec<(usize, usize)> {
    let labels = segments.labels();
    let (width, height) = labels.size();
    let reach = params.reach_px.min(width.max(height)) as i32;
    let (mut down, mut down_right, mut down_left) =
        (Ahead::new(width), Ahead::new(width + height - 1), Ahead::new(width + height - 1));
    let mut regions = vec![Segments::NONE; width];
    let mut ways: [Vec<i32>; 4] = std::array::from_fn(|_| vec![0; width]);
    let mut pairs = Vec::new();
    for v in (0..height).rev() {
        let row = v * width..(v + 1) * width;
        let pixels = labels.as_slice()[row.clone()].iter().zip(&points_m.as_slice()[row]);
        for (region, (&label, point)) in regions.iter_mut().zip(pixels) {
            *region = if point[2].is_nan() { Segments::NONE } else { label };
        }
        let [along_row, along_column, to_right, to_left] = &mut ways;
        right(&regions, reach, along_row);
        down.meet(0, &regions, v, reach, along_column);
        // Lanes of equal u - v and of equal u + v.
        down_right.meet(height - 1 - v, &regions, v, reach, to_right);
        down_left.meet(v, &regions, v, reach, to_left);
        for start in (0..width).step_by(STRETCH_PX).rev() {
            let stretch = start..width.min(start + STRETCH_PX);
            let is_quiet = |way: &Vec<i32>| way[stretch.clone()].iter().fold(0, |any, t| any | t) == 0;
            if ways.iter().all(is_quiet) {
                continue;
            }
            for u in stretch.rev() {
                let p = v * width + u;
                // The last direction first, because all is gone through backwards.
                for (way, step) in ways.iter().zip([1, width, width + 1, width - 1]).rev() {
                    let t = way[u] as usize;
                    let apart_m = || Vec3::from(points_m[p]).distance(Vec3::from(points_m[p + t * step]));
                    if t > 0 && apart_m() < params.distance_m {
                        pairs.push((p, p + t * step));
                    }
                }
            }
        }
    }
    pairs.reverse();
    pairs
}

/// What lies ahead of the pixels of a row in one direction, lane by lane: along columns, or along diagonals.
struct Ahead {
    /// The region that comes next.
    region: Vec<i32>,
    /// The row of its next pixel.
    next: Vec<i32>,
    /// The row of the first pixel after that which is of another region.
    other: Vec<i32>,
}

/// A row so far ahead that no difference to it is within reach, nor too large for an `i32`.
const NEVER: i32 = i32::MAX / 2;

impl Ahead {
    fn new(lanes: usize) -> Self {
        Self { region: vec![Segments::NONE; lanes], next: vec![NEVER; lanes], other: vec![NEVER; lanes] }
    }

    /// In how many steps the pixels of row `v` meet another region, 0 = not within `reach`; then the row is what comes next.
    /// The row's first pixel is in lane `first`.
    fn meet(&mut self, first: usize, regions: &[i32], v: usize, reach: i32, steps: &mut [i32]) {
        let v = v as i32;
        let lanes = first..first + regions.len();
        let (ahead, next, other) =
            (&mut self.region[lanes.clone()], &mut self.next[lanes.clone()], &mut self.other[lanes]);
        let steps = &mut steps[..regions.len()];
        // Without branches, so that several lanes are done at once.
        for (u, &region) in regions.iter().enumerate() {
            let is_one = mask(region >= 0);
            other[u] = select(is_one & mask(ahead[u] != region), next[u], other[u]);
            ahead[u] = select(is_one, region, ahead[u]);
            next[u] = select(is_one, v, next[u]);
            let apart = other[u] - v;
            steps[u] = apart & is_one & mask(apart <= reach);
        }
    }
}

/// All bits or none.
#[inline]
fn mask(holds: bool) -> i32 {
    -i32::from(holds)
}

#[inline]
fn select(mask: i32, a: i32, b: i32) -> i32 {
    (a & mask) | (b & !mask)
}

/// In how many steps to the right each pixel of a row meets another region, 0 = not within `reach`.
fn right(regions: &[i32], reach: i32, steps: &mut [i32]) {
    let (mut ahead, mut next, mut other) = (Segments::NONE, NEVER, NEVER);
    for (u, (&region, step)) in regions.iter().zip(steps).enumerate().rev() {
        *step = 0;
        if region >= 0 {
            if region != ahead {
                (ahead, other) = (region, next);
            }
            next = u as i32;
            if other - next <= reach {
                *step = other - next;
            }
        }
    }
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
