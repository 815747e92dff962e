//! Tools and cutlery that lie on a table.

use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::thing;

/// One to four of them.
pub(super) fn lying(rng: &mut Rng, layout: &mut Layout) {
    for _ in 0..1 + rng.below(4) {
        let tool = match rng.below(4) {
            0 => thing::screwdriver(rng),
            1 => thing::brush(rng),
            2 => thing::knife(rng),
            _ => thing::hammer(rng),
        };
        layout.stand(rng, &tool, MIDDLE);
    }
}
