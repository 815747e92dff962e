//! Vessels with contents that touch their walls or fill them, and bowls in bowls.

use super::tables::MIDDLE;
use crate::place::Layout;
use crate::random::Rng;
use crate::solid::{Cavity, Role};
use crate::texture::Paint;
use crate::thing::{self, Palette};

/// One to four vessels, each with something in it.
pub(super) fn filled(rng: &mut Rng, layout: &mut Layout) {
    for _ in 0..1 + rng.below(4) {
        match rng.below(6) {
            0 => nested(rng, layout),
            1 | 2 => boxed(rng, layout),
            3 => poured(rng, layout),
            4 => rolled(rng, layout),
            _ => served(rng, layout),
        }
    }
}

/// Two or three bowls in each other, often of one set, the last perhaps with a ball.
fn nested(rng: &mut Rng, layout: &mut Layout) {
    let mut outer = rng.range(0.085..0.10);
    let first = thing::bowl_of(rng, outer);
    let is_set = rng.chance(0.5);
    let Some(lowest) = layout.stand(rng, &first, MIDDLE) else { return };
    let mut bowls = vec![lowest];
    for _ in 0..1 + rng.below(2) {
        outer *= rng.range(0.66..0.82);
        let mut next = thing::bowl_of(rng, outer);
        if is_set {
            next.parts[0].paints.clone_from(&first.parts[0].paints);
        }
        let Some(index) = layout.nest(&next, &bowls) else { return };
        bowls.push(index);
    }
    if rng.chance(0.4) {
        let ball = thing::ball(rng, outer * 0.45);
        if let Some(Cavity::Round { floor_z, .. }) = layout.solids[bowls[bowls.len() - 1]].form.cavity {
            layout.fill_at(&ball, &bowls, [0.0, 0.0, floor_z]);
        }
    }
}

/// A box without a lid, or a tray; things at its walls and in its corners.
fn boxed(rng: &mut Rng, layout: &mut Layout) {
    const WALL_M: f64 = 0.003;
    let (is_tray, palette) = (rng.chance(0.4), Palette::any(rng));
    let depth = if is_tray { rng.range(0.012..0.025) } else { rng.range(0.05..0.10) };
    let inner = [rng.range(0.14..0.26), rng.range(0.12..0.20), depth];
    let paint = palette.paint(rng, 0.2);
    let open = thing::open_box(if is_tray { "tray" } else { "open box" }, inner, WALL_M, paint);
    let Some(vessel) = layout.stand(rng, &open, MIDDLE) else { return };
    for corner in 0..4 {
        if rng.chance(0.35) && corner > 0 {
            continue;
        }
        let [half_x, half_y] = [0, 1].map(|k| inner[k] / 2.0 * rng.range(0.5..0.92) / 2.0);
        let [side_x, side_y] = [corner % 2, corner / 2].map(|k| if k == 0 { -1.0 } else { 1.0 });
        // In the corner, or at one wall only.
        let away = if rng.chance(0.5) { 0.0 } else { rng.range(0.0..0.01) };
        let place = [side_x * (inner[0] / 2.0 - half_x), side_y * (inner[1] / 2.0 - half_y - away), WALL_M];
        if rng.chance(0.3) {
            let radius = half_x.min(half_y).min(0.04);
            let ball = thing::ball(rng, radius);
            layout.fill_at(&ball, &[vessel], [side_x * (inner[0] / 2.0 - radius), place[1], WALL_M]);
        } else {
            let sides = [2.0 * half_x, 2.0 * half_y, rng.range(0.02..0.08)];
            let content = thing::block("box", Role::Object, sides, palette.paint_unlike(rng, 0.3, &paint));
            layout.fill_at(&content, &[vessel], place);
        }
    }
}

/// A mug or bowl filled to a third or more with something loose or liquid.
fn poured(rng: &mut Rng, layout: &mut Layout) {
    let vessel = if rng.chance(0.5) { thing::bowl(rng) } else { thing::mug(rng) };
    let share = rng.range(0.3..0.8);
    let Some(content) = thing::filling(rng, &vessel.form, share) else { return };
    let Some(index) = layout.stand(rng, &vessel, MIDDLE) else { return };
    if let Some(Cavity::Round { floor_z, .. } | Cavity::Flat { floor_z, .. }) = vessel.form.cavity {
        layout.fill_at(&content, &[index], [0.0, 0.0, floor_z]);
    }
}

/// A mug with a ball that touches its wall.
fn rolled(rng: &mut Rng, layout: &mut Layout) {
    let mug = if rng.chance(0.5) { thing::mug(rng) } else { thing::big_mug(rng) };
    let Some(Cavity::Flat { floor_z, radius_m }) = mug.form.cavity else { return };
    let Some(index) = layout.stand(rng, &mug, MIDDLE) else { return };
    let radius = radius_m * rng.range(0.45..0.9);
    let ball = thing::ball(rng, radius);
    layout.fill_at(&ball, &[index], [radius - radius_m, 0.0, floor_z]);
}

/// A plate with food: round pieces that reach its rim, or one that fills it.
fn served(rng: &mut Rng, layout: &mut Layout) {
    let plate = thing::plate(rng);
    let Some(Cavity::Flat { floor_z, radius_m }) = plate.form.cavity else { return };
    let Some(index) = layout.stand(rng, &plate, MIDDLE) else { return };
    let palette = Palette::any(rng);
    let mut serve = |rng: &mut Rng, radius: f64, x: f64| {
        let paint = Paint { gloss: 0.0, ..palette.paint(rng, 0.0) };
        let piece = thing::disc("food", Role::Object, radius, rng.range(0.008..0.03), paint);
        layout.fill_at(&piece, &[index], [x, 0.0, floor_z]);
    };
    if rng.chance(0.4) {
        let radius = radius_m * rng.range(0.6..1.0);
        serve(rng, radius, 0.0);
    } else {
        for side in [-1.0, 1.0] {
            let radius = radius_m * rng.range(0.38..0.49);
            serve(rng, radius, side * (radius_m - radius));
        }
    }
}
