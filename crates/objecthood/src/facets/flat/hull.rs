//! Convex hulls of cells.

use glam::DVec2;

use crate::hull::find_row_spans;

/// The outline of whole cells stays this far (cells) behind the hull of their corners, as a mean along a slanting side.
const RAGGED_CELLS: f64 = 0.25;

/// The convex hull of the corners of some cells in scan order (columns and rows of cells), in order: that of the first and the last cell of
/// each row. O(n + rows · log rows).
pub(super) fn hull_of(cells: &[usize], width: usize) -> Vec<[i64; 2]> {
    let spans = find_row_spans(cells.iter().copied(), width).into_iter();
    let mut corners: Vec<[i64; 2]> = spans
        .flat_map(|span| {
            let [left, right, v] = [span.first, span.last + 1, span.v].map(|x| x as i64);
            [[left, v], [right, v], [left, v + 1], [right, v + 1]]
        })
        .collect();
    corners.sort_unstable();
    corners.dedup();
    let mut hull = half_hull(corners.iter().copied());
    hull.extend(half_hull(corners.iter().rev().copied()));
    hull
}

/// The share of their convex hull that so many cells fill.
pub(super) fn solidity(cells: usize, hull: &[[i64; 2]]) -> f64 {
    let next = hull.iter().cycle().skip(1);
    let (mut doubled, mut around) = (0, 0);
    for (a, b) in hull.iter().zip(next) {
        doubled += a[0] * b[1] - a[1] * b[0];
        around += (a[0] - b[0]).abs() + (a[1] - b[1]).abs();
    }
    let ragged = RAGGED_CELLS * around as f64;
    if doubled == 0 { 0.0 } else { ((cells as f64 + ragged) * 2.0 / doubled.abs() as f64).min(1.0) }
}

/// The direction (radians, from 0 to a right angle) of the sides of the smallest rectangle around a convex polygon: one of its sides lies
/// along the polygon (Freeman and Shapira 1975). O(n²).
pub(super) fn turn(polygon: &[DVec2]) -> f64 {
    let extent = |way: DVec2| {
        let along = polygon.iter().map(|point| point.dot(way));
        let [low, high] =
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        high - low
    };
    let sides =
        polygon.iter().zip(polygon.iter().cycle().skip(1)).filter_map(|(a, b)| (b - a).try_normalize());
    let area = |way: &DVec2| extent(*way) * extent(way.perp());
    let way = sides.min_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(DVec2::X);
    libm::atan2(way.y, way.x).rem_euclid(std::f64::consts::FRAC_PI_2)
}

/// One side of the hull of sorted points (Andrew 1979), without its last point.
fn half_hull(points: impl Iterator<Item = [i64; 2]>) -> Vec<[i64; 2]> {
    let turn =
        |o: [i64; 2], a: [i64; 2], b: [i64; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
    let mut hull: Vec<[i64; 2]> = Vec::new();
    for point in points {
        while hull.len() > 1 && turn(hull[hull.len() - 2], hull[hull.len() - 1], point) <= 0 {
            hull.pop();
        }
        hull.push(point);
    }
    hull.pop();
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_turn_of_a_rectangle_is_that_of_its_sides_whichever_corner_is_cut() {
        for turned_deg in [0.0, 7.0, 45.0, 89.0, 130.0_f64] {
            let way = DVec2::from_angle(turned_deg.to_radians());
            let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.8], [2.9, 2.0], [0.0, 2.0]];
            let polygon = corners.map(|[x, y]| way * x + way.perp() * y);
            let got_deg = turn(&polygon).to_degrees();
            let off_deg = (got_deg - turned_deg).rem_euclid(90.0);
            assert!(off_deg.min(90.0 - off_deg) < 1e-6, "{turned_deg}: {got_deg}");
        }
        assert_eq!(turn(&[]), 0.0);
    }

    #[test]
    fn a_rectangle_fills_its_hull_and_an_l_does_not() {
        let cells = |is_in: &dyn Fn(usize, usize) -> bool| -> Vec<usize> {
            (0..400).filter(|i| is_in(i % 20, i / 20)).collect()
        };
        let solidity = |cells: &[usize]| solidity(cells.len(), &hull_of(cells, 20));
        assert_eq!(solidity(&cells(&|u, v| u > 3 && v > 5)), 1.0);
        let bent = solidity(&cells(&|u, v| u < 10 && v < 10 && (u < 2 || v < 2)));
        assert!((bent - (36.0 + 10.0) / 68.0).abs() < 1e-9, "{bent}");
        assert_eq!(solidity(&[]), 0.0);
    }
}
