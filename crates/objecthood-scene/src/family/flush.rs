//! Boxes pushed together: no step, no valley, only what is painted on them tells them apart.

use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::solid::Role;
use crate::texture::Paint;
use crate::thing::{self, Palette};

/// One to three rows or towers of two or three boxes, which look alike or differ in colour or print.
pub(super) fn pushed_together(rng: &mut Rng, layout: &mut Layout, alike: bool) {
    for _ in 0..1 + rng.below(3) {
        let palette = Palette::any(rng);
        let printed = if rng.chance(0.4) { 0.8 } else { 0.0 };
        let count = if rng.chance(0.35) { 3 } else { 2 };
        let paints = paints(rng, palette, printed, alike);
        if rng.chance(0.55) {
            row(rng, layout, &paints[..count]);
        } else {
            tower(rng, layout, &paints[..count]);
        }
    }
}

/// Of each box of a group; neighbours differ, unless all are alike.
fn paints(rng: &mut Rng, palette: Palette, printed: f64, alike: bool) -> [Paint; 3] {
    let mut paints = [palette.paint(rng, printed); 3];
    if !alike {
        paints[1] = palette.paint_unlike(rng, printed, &paints[0]);
        paints[2] = palette.paint_unlike(rng, printed, &paints[1]);
    }
    paints
}

/// Side by side: fronts and tops lie in one plane, or only the fronts.
fn row(rng: &mut Rng, layout: &mut Layout, paints: &[Paint]) {
    let (depth, height) = (rng.range(0.05..0.12), rng.range(0.05..0.18));
    let is_level = rng.chance(0.8);
    let block = |&paint: &Paint| {
        let height = if is_level { height } else { height * rng.range(0.6..1.0) };
        let depth = if is_level { depth } else { depth * rng.range(0.7..1.0) };
        thing::block("box", Role::Object, [rng.range(0.05..0.12), depth, height], paint)
    };
    let boxes: Vec<_> = paints.iter().map(block).collect();
    let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
    let Some(mut last) = layout.stand(rng, &boxes[0], MIDDLE) else { return };
    for next in &boxes[1..] {
        let Some(index) = layout.stand_flush(next, last, side) else { return };
        last = index;
    }
}

/// One on the other, with equal outlines.
fn tower(rng: &mut Rng, layout: &mut Layout, paints: &[Paint]) {
    let outline = [rng.range(0.06..0.15), rng.range(0.06..0.13)];
    let mut lower = None;
    for &paint in paints {
        let height = rng.range(0.03..0.10);
        let block = thing::block("box", Role::Object, [outline[0], outline[1], height], paint);
        let placed = match lower {
            Some(lower) => layout.stack_flush(&block, lower),
            None => layout.stand(rng, &block, MIDDLE),
        };
        if placed.is_none() {
            return;
        }
        lower = placed;
    }
}
