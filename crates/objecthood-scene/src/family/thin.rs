//! Flat things on a table, 0.5 to 12 mm thick, of a colour like its own or another one.

use super::setting;
use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::solid::Solid;
use crate::texture::Paint;
use crate::thing::{self, Palette};

/// Two to six flat things.
pub(super) fn lying(rng: &mut Rng, layout: &mut Layout) {
    let of_table = if rng.chance(0.5) { Palette::WOOD } else { Palette::shared(rng) };
    let board = Paint { gloss: 0.0, ..of_table.paint(rng, 0.0) };
    setting::cover(layout, board);
    for _ in 0..2 + rng.below(5) {
        let alike = rng.chance(0.35);
        let palette = if alike { of_table } else { Palette::any(rng) };
        let printed = if alike { 0.1 } else { 0.3 };
        let paint =
            if alike { palette.paint(rng, printed) } else { palette.paint_unlike(rng, printed, &board) };
        let flat = flat(rng, paint);
        layout.stand(rng, &flat, MIDDLE);
    }
}

fn flat(rng: &mut Rng, paint: Paint) -> Solid {
    match rng.below(6) {
        0 => thing::sheet(rng, paint),
        1 => thing::card(rng, paint),
        2 => thing::bar(rng, paint),
        3 => thing::phone(rng, paint),
        4 => thing::coaster(rng, paint),
        _ => thing::booklet(rng, paint),
    }
}
