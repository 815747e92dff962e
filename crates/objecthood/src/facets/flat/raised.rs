//! Raised cells: those whose surroundings lie before the support, by depth alone.

use crate::facets::flat::field::{Field, NO_SUPPORT};

/// A cell is raised where the mean over 3 x 3 cells exceeds this many times the disagreement of blocks of 8 px. On a Kinect this is one
/// quantum: empty patches of that size reach it once in some thousand.
const RAISED_SIGMAS: f64 = 3.5;
/// And this share of the greatest mean within [`REACH`] cells: an edge lies at half of its height.
const EDGE_SHARE: f32 = 0.5;
const REACH: usize = 3;

/// Marks the raised cells. `disagreement_quanta`: that of blocks of 8 px. O(cells).
pub(super) fn find_raised(field: &Field, disagreement_quanta: f64) -> Vec<bool> {
    let (width, height) = (field.width, field.height);
    let across = sums(&values(field), width, height, 1);
    let mean: Vec<f32> =
        across.iter().map(|[sum, count]| if *count > 0.0 { sum / count } else { 0.0 }).collect();
    let greatest = greatest(&mean, width, height);
    let least = (RAISED_SIGMAS * disagreement_quanta) as f32;
    let is_raised = |i: usize| {
        field.cells[i].support != NO_SUPPORT && mean[i] > least && mean[i] > EDGE_SHARE * greatest[i]
    };
    (0..mean.len()).map(is_raised).collect()
}

/// Rise and weight of every cell.
fn values(field: &Field) -> Vec<[f32; 2]> {
    let value =
        |cell: &super::field::Cell| if cell.support == NO_SUPPORT { [0.0; 2] } else { [cell.rise, 1.0] };
    field.cells.iter().map(value).collect()
}

/// Sums over squares of cells around each cell.
fn sums(values: &[[f32; 2]], width: usize, height: usize, reach: usize) -> Vec<[f32; 2]> {
    let add = |a: [f32; 2], b: [f32; 2]| [a[0] + b[0], a[1] + b[1]];
    around(&around(values, width, height, reach, true, add), width, height, reach, false, add)
}

/// The greatest value in squares of cells around each cell.
fn greatest(values: &[f32], width: usize, height: usize) -> Vec<f32> {
    let rows = around(values, width, height, REACH, true, f32::max);
    around(&rows, width, height, REACH, false, f32::max)
}

/// Combines the values up to `reach` cells away along rows or columns.
fn around<T: Copy>(
    values: &[T],
    width: usize,
    height: usize,
    reach: usize,
    along_rows: bool,
    combine: impl Fn(T, T) -> T,
) -> Vec<T> {
    let mut combined = values.to_vec();
    for t in 1..=reach {
        if along_rows {
            for v in 0..height {
                let row = v * width..(v + 1) * width;
                let (from, to) = (&values[row.clone()], &mut combined[row]);
                for u in t..width {
                    to[u] = combine(to[u], from[u - t]);
                    to[u - t] = combine(to[u - t], from[u]);
                }
            }
        } else {
            for i in t * width..width * height {
                combined[i] = combine(combined[i], values[i - t * width]);
                combined[i - t * width] = combine(combined[i - t * width], values[i]);
            }
        }
    }
    combined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facets::flat::field::Cell;

    #[test]
    fn an_edge_lies_at_half_of_its_height() {
        let rise =
            |i: usize| if (10..20).contains(&(i % 30)) && (10..20).contains(&(i / 30)) { 4.0 } else { 0.0 };
        let cells: Vec<Cell> = (0..900).map(|i| Cell { support: 0, rise: rise(i), lab: [0.0; 3] }).collect();
        let field = Field { width: 30, height: 30, cells, support: Vec::new() };
        let raised = find_raised(&field, 0.285);
        let marked: Vec<usize> = (0..900).filter(|&i| raised[i]).collect();
        let expected: Vec<usize> = (0..900).filter(|&i| rise(i) > 0.0).collect();
        // The corners of a square are rounded by a mean over 3 x 3.
        let corners = [10 * 30 + 10, 10 * 30 + 19, 19 * 30 + 10, 19 * 30 + 19];
        assert_eq!(marked, expected.into_iter().filter(|i| !corners.contains(i)).collect::<Vec<_>>());
        assert!(find_raised(&field, 4.0).iter().all(|raised| !raised));
    }
}
