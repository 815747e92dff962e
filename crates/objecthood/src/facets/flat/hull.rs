//! Convex hulls of cells.

/// The outline of whole cells stays this far (cells) behind the hull of their corners, as a mean along a slanting side.
const RAGGED_CELLS: f64 = 0.25;

/// The share of its convex hull (of the corners of cells) that a set of cells fills. O(n log n).
pub(super) fn solidity(cells: &[usize], width: usize) -> f64 {
    let mut corners: Vec<[i64; 2]> = cells
        .iter()
        .flat_map(|&i| {
            let (u, v) = ((i % width) as i64, (i / width) as i64);
            [[u, v], [u + 1, v], [u, v + 1], [u + 1, v + 1]]
        })
        .collect();
    corners.sort_unstable();
    corners.dedup();
    let mut hull = half_hull(corners.iter().copied());
    hull.extend(half_hull(corners.iter().rev().copied()));
    let next = hull.iter().cycle().skip(1);
    let (mut doubled, mut around) = (0, 0);
    for (a, b) in hull.iter().zip(next) {
        doubled += a[0] * b[1] - a[1] * b[0];
        around += (a[0] - b[0]).abs() + (a[1] - b[1]).abs();
    }
    let ragged = RAGGED_CELLS * around as f64;
    if doubled == 0 { 0.0 } else { ((cells.len() as f64 + ragged) * 2.0 / doubled.abs() as f64).min(1.0) }
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
    fn a_rectangle_fills_its_hull_and_an_l_does_not() {
        let cells = |is_in: &dyn Fn(usize, usize) -> bool| -> Vec<usize> {
            (0..400).filter(|i| is_in(i % 20, i / 20)).collect()
        };
        assert_eq!(solidity(&cells(&|u, v| u > 3 && v > 5), 20), 1.0);
        let bent = solidity(&cells(&|u, v| u < 10 && v < 10 && (u < 2 || v < 2)), 20);
        assert!((bent - (36.0 + 10.0) / 68.0).abs() < 1e-9, "{bent}");
        assert_eq!(solidity(&[], 20), 0.0);
    }
}
