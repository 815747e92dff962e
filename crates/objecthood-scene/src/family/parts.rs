//! Bodies of several convex parts.

use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::thing;

/// One to four of them.
pub(super) fn bodies(rng: &mut Rng, layout: &mut Layout) {
    for _ in 0..1 + rng.below(4) {
        let body = match rng.below(8) {
            0 | 1 => thing::doll(rng),
            2 | 3 => thing::animal(rng),
            4 => thing::pawn(rng),
            5 => thing::pot(rng),
            6 => thing::big_mug(rng),
            _ => thing::bottle(rng),
        };
        layout.stand(rng, &body, MIDDLE);
    }
}
