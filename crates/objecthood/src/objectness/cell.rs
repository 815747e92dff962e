//! Cells of the plan view.

use glam::DVec2;

/// Side of a cell of the plan view (m): half the distance of contact, so that what is in contact is in neighbouring cells.
pub(crate) const CELL_M: f64 = 0.01;

/// A cell of the plan view. In one number, so that many are sorted fast: by column, then by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cell(u64);

impl Cell {
    #[inline]
    pub(crate) fn at(place_m: DVec2) -> Self {
        let place = place_m / CELL_M;
        Self::new(floor(place.x), floor(place.y))
    }

    #[inline]
    pub(crate) fn new(x: i32, y: i32) -> Self {
        let ascending = |x: i32| u64::from(x.wrapping_sub(i32::MIN) as u32);
        Self(ascending(x) << 32 | ascending(y))
    }

    pub(crate) fn place(self) -> [i32; 2] {
        [self.0 >> 32, self.0].map(|x| (x as u32 as i32).wrapping_add(i32::MIN))
    }
}

/// The integer below, saturating: a conversion and a comparison, which a library's `floor` on the oldest x86-64 is not.
#[inline]
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
