//! Compactness: the share of its hull that a region fills (ours, because the paper names compactness but gives no formula).

use rayon::prelude::*;

use crate::hull::{RowSpan, fill_hull, find_row_spans};
use crate::objectness::outline::STEP_QUANTA;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::DisparitySpace;

/// Measures the share of its convex hull in the image that each region fills, in [0, 1]; 0 without pixels. `pixels`: the measured
/// pixels of each region, in scan order.
///
/// Two kinds of pixels of the hull do not count, because the region may go on behind them: pixels without depth, and pixels that are
/// nearer by a step than the region beside them. Its pixel beside another one is its last pixel before that in scan order; at the
/// beginning of a row, its first pixel in the row. O(pixels + area of the hulls); parallel over regions.
pub fn measure_compactness(
    regions: &Segments,
    pixels: &[Vec<usize>],
    points_m: &Raster<[f32; 3]>,
    space: &DisparitySpace,
) -> Vec<f32> {
    let width = regions.labels().width();
    let z_m = |i: usize| f64::from(points_m[i][2]);
    let empty_in = |region: usize, spans: &[RowSpan]| {
        let (mut empty, mut beside_m) = (0_usize, f64::NAN);
        let mut rows = spans.iter().peekable();
        for row in fill_hull(spans) {
            if let Some(span) = rows.next_if(|span| span.v == row.v) {
                beside_m = z_m(span.v * width + span.first);
            }
            for i in row.first + row.v * width..=row.last + row.v * width {
                if regions.labels()[i] == region as i32 {
                    beside_m = if z_m(i).is_nan() { beside_m } else { z_m(i) };
                } else if z_m(i) >= beside_m - space.step_m(STEP_QUANTA, beside_m) {
                    empty += 1;
                }
            }
        }
        empty
    };
    let share = |(region, pixels): (usize, &Vec<usize>)| {
        let own = pixels.len() as f32;
        if pixels.is_empty() {
            0.0
        } else {
            own / (own + empty_in(region, &find_row_spans(pixels.iter().copied(), width)) as f32)
        }
    };
    pixels.par_iter().enumerate().map(share).collect()
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
            let mut measured = vec![Vec::new(); 3];
            let own = regions.members().filter(|&(i, _)| !points[i][2].is_nan());
            own.for_each(|(i, region)| measured[region].push(i));
            let got = measure_compactness(&regions, &measured, &points, &space);
            for (region, got) in got.into_iter().enumerate() {
                let is_measured = |i: &usize| !points[*i][2].is_nan();
                let is_own = |i: &usize| regions.labels()[*i] == region as i32 && is_measured(i);
                let own: Vec<usize> = (0..width * height).filter(is_own).collect();
                let at = |i: usize| [(i % width) as i64, (i / width) as i64];
                let corners: Vec<Point> = own.iter().map(|&i| at(i)).collect();
                let is_empty = |i: &usize| {
                    let row = *i / width * width;
                    let left = (row..*i).rev().find(is_own);
                    let beside = left.or((*i..row + width).find(is_own)).or((0..row).rev().find(is_own));
                    let beside_m = f64::from(points[beside.unwrap_or(*i)][2]);
                    let hides = f64::from(points[*i][2]) < beside_m - space.step_m(STEP_QUANTA, beside_m);
                    regions.labels()[*i] != region as i32 && !hides && is_inside(at(*i), &corners)
                };
                let empty = (0..width * height).filter(is_measured).filter(is_empty).count();
                let expected = if own.is_empty() { 0.0 } else { own.len() as f32 / (own.len() + empty) as f32 };
                prop_assert_eq!(got, expected, "region {}", region);
            }
        }
    }
}
