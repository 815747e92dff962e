//! The heights of a region, cell by cell of the plan view.

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec2;

use crate::quantile::element_at;

/// Side of a cell of the plan view (m): half of the default `contact.distance_m`.
pub(crate) const CELL_M: f64 = 0.01;
/// The height of a cell is this quantile of the heights of its points.
pub(crate) const CELL_SHARE: f64 = 0.8;

/// A cell of the plan view as one number, which sorts fast: by column, then by row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cell(u64);

impl Cell {
    #[inline(always)]
    pub(crate) fn at(place_m: DVec2) -> Self {
        let place = place_m / CELL_M;
        Self::new(floor(place.x), floor(place.y))
    }

    #[inline(always)]
    pub(crate) fn new(x: i32, y: i32) -> Self {
        let ascending = |x: i32| u64::from(x.wrapping_sub(i32::MIN) as u32);
        Self(ascending(x) << 32 | ascending(y))
    }

    pub(crate) fn place(self) -> [i32; 2] {
        [self.0 >> 32, self.0].map(|x| (x as u32 as i32).wrapping_add(i32::MIN))
    }
}

/// The heights of a region by cell. Few cells are needed, so the height of each is computed on demand.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cells {
    /// The height of every point (m).
    heights_m: Vec<f64>,
    /// Runs of successive points in one cell, sorted by cell.
    runs: Vec<(Cell, Range<u32>)>,
    /// For each cell its runs, and its height (m) once it is computed; sorted by cell.
    all: Vec<(Cell, Range<u32>, OnceLock<f64>)>,
}

impl Cells {
    /// The cells of points at these heights. `starts`: the cell and the first point of each run. O(runs · log(runs)).
    pub(crate) fn new(heights_m: Vec<f64>, starts: &[(Cell, u32)]) -> Self {
        let ends = starts.iter().skip(1).map(|run| run.1).chain([heights_m.len() as u32]);
        let mut runs: Vec<(Cell, Range<u32>)> =
            starts.iter().zip(ends).map(|(&(cell, start), end)| (cell, start..end)).collect();
        runs.sort_unstable_by_key(|run| run.0);
        let mut all: Vec<(Cell, Range<u32>, OnceLock<f64>)> = Vec::new();
        for (k, (cell, _)) in (0..).zip(&runs) {
            match all.last_mut() {
                Some((last, runs, _)) if last == cell => runs.end = k + 1,
                _ => all.push((*cell, k..k + 1, OnceLock::new())),
            }
        }
        Self { heights_m, runs, all }
    }

    /// The greatest height (m) in the cell of a place and the eight around it; `None` where the region has no point.
    pub(crate) fn top_near_m(&self, place_m: DVec2) -> Option<f64> {
        let [x, y] = Cell::at(place_m).place();
        let column = |x: i32| {
            let first = self.all.partition_point(|of_cell| of_cell.0 < Cell::new(x, y.saturating_sub(1)));
            let last = Cell::new(x, y.saturating_add(1));
            (first..self.all.len()).take_while(move |&k| self.all[k].0 <= last)
        };
        let around = [x.saturating_sub(1), x, x.saturating_add(1)].into_iter().flat_map(column);
        around.map(|k| self.height_m(k)).reduce(f64::max)
    }

    /// The cells in order, with their heights (m).
    pub(crate) fn iter(&self) -> impl Iterator<Item = (Cell, f64)> + '_ {
        (0..self.all.len()).map(|k| (self.all[k].0, self.height_m(k)))
    }

    fn height_m(&self, k: usize) -> f64 {
        let (_, runs, height_m) = &self.all[k];
        *height_m.get_or_init(|| {
            let runs = &self.runs[runs.start as usize..runs.end as usize];
            let heights_m =
                runs.iter().flat_map(|(_, run)| &self.heights_m[run.start as usize..run.end as usize]);
            let mut heights_m: Vec<f64> = heights_m.copied().collect();
            element_at(&mut heights_m, CELL_SHARE)
        })
    }
}

/// The largest integer not above `x`, saturating: a conversion and a comparison. On the oldest x86-64, `f64::floor` is a library call.
#[inline(always)]
fn floor(x: f64) -> i32 {
    let toward_zero = x as i32;
    toward_zero.saturating_sub(i32::from(f64::from(toward_zero) > x))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn integers_below_are_those_of_the_library() {
        let edges =
            [0.0, -0.0, 0.5, -0.5, 2.0, -2.0, 1e300, -1e300, 2_147_483_647.5, -2_147_483_648.5, f64::NAN];
        for x in edges.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY]) {
            assert_eq!(floor(x), x.floor() as i32, "{x}");
        }
    }

    proptest! {
        #[test]
        fn cells_are_in_the_order_of_columns_then_rows(
            [a, b] in prop::array::uniform2(prop::array::uniform2(prop_oneof![
                Just(i32::MIN), Just(i32::MAX), -3_i32..3, any::<i32>()
            ])),
        ) {
            let [cell_a, cell_b] = [a, b].map(|[x, y]| Cell::new(x, y));
            prop_assert_eq!((cell_a.place(), cell_a.cmp(&cell_b)), (a, a.cmp(&b)));
        }
    }
}
