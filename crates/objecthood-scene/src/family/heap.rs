//! A heap: things let down one by one over the same part of a table.

use super::setting::{self, TABLE_M};
use super::{tables, views};
use crate::place::{Layout, Spot};
use crate::random::Rng;
use crate::solid::Solid;
use crate::thing;
use crate::world::Viewpoint;

/// Half of the ground that it covers (m).
const HALF_M: [f64; 2] = [0.23, 0.18];
const HIGHEST_M: f64 = 0.32;
/// Where one finds no place, another is tried, so often for each thing wanted.
const TRIES_A_THING: usize = 4;

/// Twenty-two to thirty things where they come to lie, and thin boxes that lean on them.
pub(super) fn piled(rng: &mut Rng) -> (Layout, Viewpoint) {
    let viewpoint = views::at_table(rng);
    let mut layout = setting::with_table(rng, false);
    let ([x, y], on) = (HALF_M, layout.table());
    let spot = Spot { on, low_m: [-x, -y, TABLE_M], high_m: [x, y, TABLE_M + HIGHEST_M] };
    let leaning = 1 + rng.below(3);
    let dropped = 21 + rng.below(7);
    for _ in 0..TRIES_A_THING * dropped {
        if layout.placed().len() < dropped {
            let thing = piece(rng);
            layout.drop_in(rng, &thing, &spot);
        }
    }
    for against in layout.placed() {
        if layout.placed().len() < dropped + leaning {
            let slab = thing::slab(rng);
            layout.lean(rng, &slab, against);
        }
    }
    (layout, viewpoint)
}

/// What heaps are made of: mostly boxes, on which others come to lie.
fn piece(rng: &mut Rng) -> Solid {
    match rng.below(10) {
        0..3 => thing::package(rng),
        3 => thing::book(rng),
        4 | 5 => thing::brick(rng),
        6 => thing::can(rng).laid(),
        7 => thing::can(rng),
        _ => tables::any(rng),
    }
}
