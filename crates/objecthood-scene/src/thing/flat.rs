//! Flat things: paper, cards, phones, coasters, cutlery.

use std::ops::Range;

use super::angular::block;
use super::round;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;

/// A plate of these sides: length, width, thickness.
fn plate(kind: &'static str, rng: &mut Rng, sides_m: [Range<f64>; 3], paint: Paint) -> Solid {
    let sides = sides_m.map(|side| rng.range(side));
    block(kind, Role::Object, sides, paint)
}

/// A sheet or pad of paper.
pub(crate) fn sheet(rng: &mut Rng, paint: Paint) -> Solid {
    plate("paper", rng, [0.14..0.22, 0.10..0.16, 0.0005..0.002], paint)
}

/// A card of plastic, or a few.
pub(crate) fn card(rng: &mut Rng, paint: Paint) -> Solid {
    plate("card", rng, [0.08..0.10, 0.05..0.065, 0.0008..0.004], paint)
}

/// A ruler, or a piece of cutlery.
pub(crate) fn bar(rng: &mut Rng, paint: Paint) -> Solid {
    plate("bar", rng, [0.14..0.24, 0.012..0.03, 0.0015..0.005], Paint { gloss: 0.4, ..paint })
}

/// A phone that lies on its back or face.
pub(crate) fn phone(rng: &mut Rng, paint: Paint) -> Solid {
    plate("phone", rng, [0.14..0.165, 0.068..0.08, 0.007..0.011], Paint { gloss: 0.5, ..paint })
}

/// A thin book or notebook without a spine.
pub(crate) fn booklet(rng: &mut Rng, paint: Paint) -> Solid {
    plate("booklet", rng, [0.15..0.24, 0.10..0.17, 0.002..0.012], paint)
}

/// A round mat for a cup.
pub(crate) fn coaster(rng: &mut Rng, paint: Paint) -> Solid {
    round::disc("coaster", Role::Object, rng.range(0.04..0.055), rng.range(0.002..0.008), paint)
}
