//! Raised cells: cells whose surroundings lie before the support, by depth alone.

use crate::facets::flat::field::{Cell, Field, NO_SUPPORT};

/// A cell is raised where the mean over 3 x 3 cells exceeds this many times the disagreement of blocks of 8 px. On a Kinect this is one
/// quantum: empty patches of that size reach it once in some thousand.
const RAISED_SIGMAS: f64 = 3.5;
/// And this share of the greatest mean within [`REACH`] cells: an edge lies at half of its height.
const EDGE_SHARE: f32 = 0.5;
const REACH: usize = 3;

/// Marks the raised cells. `disagreement_quanta`: that of blocks of 8 px. O(cells).
pub(super) fn find_raised(field: &Field, disagreement_quanta: f64) -> Vec<bool> {
    let (width, height) = (field.width, field.height);
    let mean = means(field);
    let least = (RAISED_SIGMAS * disagreement_quanta) as f32;
    // Few cells rise so far that their neighbours have to be examined.
    let is_on_top = |i: usize| {
        let near = |at: usize, all: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(all);
        let columns = near(i % width, width);
        let mut rows = near(i / width, height).map(|v| &mean[v * width..][columns.clone()]);
        rows.all(|row| row.iter().all(|near| mean[i] > EDGE_SHARE * near))
    };
    let is_raised = |i: usize| field.cells[i].support != NO_SUPPORT && mean[i] > least && is_on_top(i);
    (0..mean.len()).map(is_raised).collect()
}

/// The mean rise over the 3 x 3 cells around each cell that lie on a support; 0 where none does. O(cells).
fn means(field: &Field) -> Vec<f32> {
    let value = |cell: &Cell| if cell.support == NO_SUPPORT { [0.0; 2] } else { [cell.rise, 1.0] };
    let values: Vec<[f32; 2]> = field.cells.iter().map(value).collect();
    let mut rows = values.clone();
    for (sums, values) in rows.chunks_mut(field.width).zip(values.chunks(field.width)) {
        add_beside(sums, values, 1);
    }
    let mut sums = rows.clone();
    add_beside(&mut sums, &rows, field.width);
    sums.iter().map(|[sum, count]| if *count > 0.0 { sum / count } else { 0.0 }).collect()
}

/// Adds to each sum the values so many places before and behind it.
fn add_beside(sums: &mut [[f32; 2]], values: &[[f32; 2]], places: usize) {
    let add = |([sum, count], [value, weight]): (&mut [f32; 2], &[f32; 2])| {
        *sum += value;
        *count += weight;
    };
    sums.iter_mut().skip(places).zip(values).for_each(add);
    sums.iter_mut().zip(values.iter().skip(places)).for_each(add);
}

#[cfg(test)]
mod tests {
    use super::*;

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
