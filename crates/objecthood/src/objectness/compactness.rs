//! How much of its hull a region fills (ours: the paper names compactness and gives no formula).

use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::DisparitySpace;

/// What is nearer than the region by more than this (quanta) hides it.
const HIDDEN_QUANTA: f64 = 6.0;

/// The first and the last column of a region in a row of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    v: usize,
    first: usize,
    last: usize,
}

/// For every region the share of its convex hull in the image that is its own, in [0, 1]; 0 without pixels.
///
/// Pixels of the hull without depth, and those that show something nearer than the region is on average, do not count: behind
/// them it may go on. O(pixels + area of the hulls).
pub fn compactness(regions: &Segments, points_m: &Raster<[f32; 3]>, space: &DisparitySpace) -> Vec<f32> {
    let (width, height) = regions.labels().size();
    let mut runs: Vec<Vec<Run>> = vec![Vec::new(); regions.count()];
    let mut depth_m = vec![(0.0_f64, 0_usize); regions.count()];
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            let Some(region) = regions.at(i) else { continue };
            let z_m = f64::from(points_m[i][2]);
            if z_m.is_nan() {
                continue;
            }
            let (sum, count) = &mut depth_m[region.index()];
            (*sum, *count) = (*sum + z_m, *count + 1);
            let runs = &mut runs[region.index()];
            match runs.last_mut() {
                Some(run) if run.v == v => run.last = u,
                _ => runs.push(Run { v, first: u, last: u }),
            }
        }
    }
    let filled = |(region, runs): (usize, &Vec<Run>)| {
        let (sum, own) = depth_m[region];
        if own == 0 {
            return 0.0;
        }
        let mean_m = sum / own as f64;
        let nearer_m = mean_m - space.step_m(HIDDEN_QUANTA, mean_m);
        let is_empty = |&i: &usize| {
            let z_m = f64::from(points_m[i][2]);
            regions.labels()[i] != region as i32 && z_m >= nearer_m
        };
        let inside =
            hull(runs).into_iter().flat_map(|Run { v, first, last }| first + v * width..=last + v * width);
        let empty = inside.filter(is_empty).count();
        own as f32 / (own + empty) as f32
    };
    runs.iter().enumerate().map(filled).collect()
}

/// The pixels whose centres lie in the convex hull of the runs' ends; `runs` by ascending row.
fn hull(runs: &[Run]) -> Vec<Run> {
    let left = chain(runs.iter().map(|run| [run.first as i64, run.v as i64]), 1);
    let right = chain(runs.iter().map(|run| [run.last as i64, run.v as i64]), -1);
    let (Some(&[_, top]), Some(&[_, bottom])) = (left.first(), left.last()) else { return Vec::new() };
    let (mut l, mut r) = (0, 0);
    (top..=bottom)
        .map(|v| {
            // Rounded into the hull.
            let first = -crossing(&left, &mut l, v, -1);
            let last = crossing(&right, &mut r, v, 1);
            Run { v: v as usize, first: first as usize, last: last as usize }
        })
        .collect()
}

/// The corners of one side of a hull, from top to bottom: those beyond which no other lies. `side`: 1 = left, -1 = right.
fn chain(points: impl Iterator<Item = [i64; 2]>, side: i64) -> Vec<[i64; 2]> {
    let mut corners: Vec<[i64; 2]> = Vec::new();
    for [u, v] in points {
        while let [.., [a, b], [c, d]] = corners[..] {
            let turn = (c - a) * (v - b) - (d - b) * (u - a);
            if side * turn < 0 {
                break;
            }
            corners.pop();
        }
        corners.push([u, v]);
    }
    corners
}

/// Where a side of the hull crosses row `v`, times `sign`, rounded down; `at`: the corner above, which only moves down.
fn crossing(corners: &[[i64; 2]], at: &mut usize, v: i64, sign: i64) -> i64 {
    while corners.get(*at + 1).is_some_and(|corner| corner[1] <= v) {
        *at += 1;
    }
    let [a, b] = corners[*at];
    let Some([c, d]) = corners.get(*at + 1) else { return sign * a };
    (sign * (a * (d - v) + c * (v - b))).div_euclid(d - b)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{raster, small_size, space};

    type Point = [i64; 2];

    /// Twice the area of a triangle, with its sign.
    fn area([a, b, c]: [Point; 3]) -> i64 {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }

    /// Whether a point lies in any triangle of three points, which may be a line or a point.
    fn is_inside(p: Point, points: &[Point]) -> bool {
        let holds = |[a, b, c]: [Point; 3]| {
            let parts = [area([a, b, p]), area([b, c, p]), area([c, a, p])];
            let is_flat = area([a, b, c]) == 0;
            let within = (0..2).all(|k| {
                let [a, b, c] = [a[k], b[k], c[k]];
                (a.min(b).min(c)..=a.max(b).max(c)).contains(&p[k])
            });
            let same_side = parts.iter().all(|&s| s >= 0) || parts.iter().all(|&s| s <= 0);
            same_side && within && (!is_flat || parts == [0; 3])
        };
        points.iter().any(|&a| points.iter().any(|&b| points.iter().any(|&c| holds([a, b, c]))))
    }

    proptest! {
        #[test]
        fn what_is_empty_in_the_hull_is_counted(
            pixels in small_size().prop_flat_map(|size| raster(size, (-1_i32..3, 0_u8..3))),
        ) {
            let space = space([525.0; 2], [0.0; 2]);
            let (width, height) = pixels.size();
            // Near, far and not measured.
            let z = |level: u8| [0.8, 1.0, f32::NAN][usize::from(level)];
            let points = pixels.map(|&(_, level)| [0.0, 0.0, z(level)]);
            let regions = Segments::from_numbered(pixels.map(|&(region, _)| region), 3);
            let got = compactness(&regions, &points, &space);
            for (region, got) in got.into_iter().enumerate() {
                let is_measured = |i: &usize| !points[*i][2].is_nan();
                let own: Vec<usize> = (0..width * height)
                    .filter(|&i| regions.labels()[i] == region as i32)
                    .filter(is_measured)
                    .collect();
                let mean_m = own.iter().map(|&i| f64::from(points[i][2])).sum::<f64>() / own.len() as f64;
                let at = |i: usize| [(i % width) as i64, (i / width) as i64];
                let corners: Vec<Point> = own.iter().map(|&i| at(i)).collect();
                let is_empty = |i: &usize| {
                    let hides = f64::from(points[*i][2]) < mean_m - space.step_m(HIDDEN_QUANTA, mean_m);
                    regions.labels()[*i] != region as i32 && !hides && is_inside(at(*i), &corners)
                };
                let empty = (0..width * height).filter(is_measured).filter(is_empty).count();
                let expected = if own.is_empty() { 0.0 } else { own.len() as f32 / (own.len() + empty) as f32 };
                prop_assert_eq!(got, expected, "region {}", region);
            }
        }
    }
}
