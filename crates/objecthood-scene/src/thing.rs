//! The things there are: each a function from a generator to a solid that stands on z = 0.

mod angular;
mod content;
mod flat;
mod palette;
mod round;
mod tool;
mod toy;
mod vessel;

pub(crate) use angular::{block, book, brick, package, parcel, slab};
pub(crate) use content::{filling, open_box};
pub(crate) use flat::{bar, booklet, card, coaster, phone, sheet};
pub(crate) use palette::Palette;
pub(crate) use round::{ball, bottle, can, cone, disc};
pub(crate) use tool::{brush, hammer, knife, screwdriver};
pub(crate) use toy::{animal, doll, pawn, pot};
pub(crate) use vessel::{big_mug, bowl, bowl_of, cup, mug, plate};

use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::Shape;
use crate::solid::Part;
use crate::texture::{Albedo, Paint, Texture};

const COLORS: [Albedo; 12] = [
    [0.55, 0.06, 0.05],
    [0.75, 0.55, 0.05],
    [0.08, 0.25, 0.55],
    [0.07, 0.35, 0.12],
    [0.70, 0.70, 0.68],
    [0.65, 0.28, 0.04],
    [0.32, 0.10, 0.38],
    [0.10, 0.42, 0.45],
    [0.62, 0.45, 0.28],
    [0.75, 0.32, 0.38],
    [0.22, 0.22, 0.24],
    [0.48, 0.60, 0.20],
];

fn color(rng: &mut Rng) -> Albedo {
    let tone = rng.range(0.75..1.15);
    rng.pick(&COLORS).map(|c| (c * tone).min(0.85))
}

/// Any paint that a thing of this kind of surface may have.
fn paint(rng: &mut Rng, printed: f64, striped: f64) -> Paint {
    let (base, ink) = (color(rng), color(rng));
    let kind = rng.range(0.0..1.0);
    let texture = if kind < printed {
        Texture::Print { seed: rng.bits() }
    } else if kind < printed + striped {
        Texture::Stripes { period_m: rng.range(0.012..0.035), upright: rng.chance(0.4) }
    } else {
        Texture::Plain
    };
    Paint { base, ink, texture, gloss: 0.0 }
}

fn part(shape: Shape, origin_m: [f64; 3], paint: Paint) -> Part {
    Part { shape, pose: Pose::at(origin_m), paints: vec![paint] }
}
