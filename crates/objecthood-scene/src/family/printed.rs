//! Boxes that stand alone and bear strong print, which is no joint.

use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::{Paint, Texture};
use crate::thing::{self, Palette};

/// One to four boxes with blocks of colour, bands, labels, stripes or pages of print.
pub(super) fn boxes(rng: &mut Rng, layout: &mut Layout) {
    for _ in 0..1 + rng.below(4) {
        let package = printed(rng);
        layout.stand(rng, &package, MIDDLE);
    }
}

fn printed(rng: &mut Rng) -> Solid {
    let sides = [rng.range(0.05..0.17), rng.range(0.05..0.13), rng.range(0.04..0.20)];
    let palette = Palette::any(rng);
    let base = palette.paint(rng, 0.0);
    let ink = palette.paint_unlike(rng, 0.0, &base).base;
    let paint = Paint { ink, texture: print(rng, sides), ..base };
    let mut package = thing::block("box", Role::Object, sides, paint);
    // The lid is often of one of the two colours; on sides that look sideways a band goes round, on others it ends.
    let lid = match rng.below(3) {
        0 => paint,
        1 => Paint { gloss: paint.gloss, ..Paint::plain(paint.base) },
        _ => Paint { gloss: paint.gloss, ..Paint::plain(paint.ink) },
    };
    let ends = if rng.chance(0.5) { paint } else { Paint { gloss: paint.gloss, ..Paint::plain(paint.base) } };
    package.parts[0].paints = vec![ends, ends, paint, paint, lid, lid];
    package
}

/// What goes across a face of a box of these sides, or lies within it.
fn print(rng: &mut Rng, [x, _, z]: [f64; 3]) -> Texture {
    let upright = rng.chance(0.4);
    let length = if upright { x } else { z };
    match rng.below(6) {
        // A block from an edge to somewhere in the middle.
        0 | 1 => Texture::Band { low_m: length * rng.range(-0.25..0.25), high_m: length, upright },
        2 => {
            let low_m = length * rng.range(-0.4..0.1);
            Texture::Band { low_m, high_m: low_m + length * rng.range(0.1..0.3), upright }
        }
        3 => {
            let half_m = [x * rng.range(0.25..0.42), z * rng.range(0.2..0.42)];
            Texture::Label { seed: rng.bits(), half_m }
        }
        4 => Texture::Stripes { period_m: length * rng.range(0.2..0.7), upright },
        _ => Texture::Print { seed: rng.bits() },
    }
}
