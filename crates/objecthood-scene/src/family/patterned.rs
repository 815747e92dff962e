//! Tables with strong pattern, stains and shadows, on which nothing flat lies.

use glam::DVec3;

use super::setting::{self, TABLE_M};
use super::{tables, views};
use crate::light::Lighting;
use crate::place::{Layout, Spot};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::Role;
use crate::texture::{Paint, Texture};
use crate::thing::{self, Palette};
use crate::world::{Viewpoint, World};

/// A rug or cloth is as thick as this (m): less than any sensor sees.
const CLOTH_M: f64 = 0.0004;
/// The lamp is small and high, so that shadows are sharp: its least height over the table (m).
const LAMP_M: f64 = 1.7;

/// A table without flat things, and none to two tall ones.
pub(super) fn table(rng: &mut Rng, seed: u64) -> World {
    let viewpoint = views::at_table(rng);
    let lighting = sharp(rng);
    let mut layout = setting::with_table(rng, false);
    let paint = pattern(rng);
    let ground = if rng.chance(0.35) {
        cloth(rng, &mut layout, paint)
    } else {
        setting::cover(&mut layout, paint);
        let half_m = tables::MIDDLE.half_m;
        spot(layout.table(), half_m, TABLE_M)
    };
    if rng.chance(0.6) {
        shade(rng, &mut layout, &lighting, &viewpoint);
    }
    for _ in 0..rng.below(3) {
        let tall = if rng.chance(0.6) { thing::package(rng) } else { thing::can(rng) };
        layout.drop_in(rng, &tall, &ground);
    }
    World::new(seed, layout.solids, layout.contacts, lighting, viewpoint)
}

fn spot(on: usize, [x, y]: [f64; 2], floor: f64) -> Spot {
    Spot { on, low_m: [-x, -y, floor], high_m: [x, y, floor + 0.35] }
}

fn pattern(rng: &mut Rng) -> Paint {
    let palette = if rng.chance(0.5) { Palette::shared(rng) } else { Palette::any(rng) };
    let base = palette.paint(rng, 0.0);
    let ink = palette.paint_unlike(rng, 0.0, &base).base;
    let seed = rng.bits();
    let texture = match rng.below(6) {
        0 => Texture::Tiles { seed, side_m: rng.range(0.05..0.2) },
        1 => Texture::Stripes { period_m: rng.range(0.02..0.2), upright: rng.chance(0.5) },
        2 => Texture::Checks { period_m: rng.range(0.02..0.12) },
        3 => Texture::Clouds { seed, cell_m: rng.range(0.03..0.15) },
        4 => Texture::Stains { seed, side_m: rng.range(0.12..0.3) },
        _ => Texture::Print { seed },
    };
    Paint { base: base.base, ink, texture, gloss: if rng.chance(0.4) { rng.range(0.1..0.6) } else { 0.0 } }
}

/// A rug, runner or table cloth of this paint, and the place over it.
fn cloth(rng: &mut Rng, layout: &mut Layout, paint: Paint) -> Spot {
    let half_m = [rng.range(0.2..0.4), rng.range(0.14..0.3)];
    let [x, y] = half_m.map(|half| 2.0 * half);
    let cloth = thing::block("cloth", Role::Furniture, [x, y, CLOTH_M], paint);
    let on = layout.furnish(cloth.at(Pose::at([0.0, 0.0, TABLE_M])));
    spot(on, half_m, TABLE_M + CLOTH_M)
}

/// A small lamp that throws sharp shadows, or none to speak of.
fn sharp(rng: &mut Rng) -> Lighting {
    let lighting = views::mixed_lighting(rng);
    let height = LAMP_M + rng.range(0.0..0.6);
    let lamp_m = DVec3 { z: TABLE_M + height, ..lighting.lamp_m };
    let gain = height * height / (lighting.lamp_m.z - TABLE_M).powi(2);
    Lighting {
        lamp_m,
        lamp_radius_m: rng.range(0.01..0.06),
        lamp: lighting.lamp.map(|c| c * gain),
        ..lighting
    }
}

/// One to three things between lamp and table, higher than the camera, which looks down and does not see them.
fn shade(rng: &mut Rng, layout: &mut Layout, lighting: &Lighting, viewpoint: &Viewpoint) {
    for _ in 0..1 + rng.below(3) {
        let on_table = DVec3::new(rng.range(-0.3..0.3), rng.range(-0.25..0.25), TABLE_M);
        let height = viewpoint.pose.origin.z + rng.range(0.05..0.15);
        let way = (height - TABLE_M) / (lighting.lamp_m.z - TABLE_M);
        let place = on_table.lerp(lighting.lamp_m, way);
        let shadow = [rng.range(0.03..0.35), rng.range(0.03..0.2)];
        let [x, y] = shadow.map(|side| side * (1.0 - way));
        let pose = Pose::at(place.into()).turned(2, rng.range(0.0..180.0));
        let black = Paint::plain([0.05; 3]);
        let screen = if rng.chance(0.6) {
            thing::block("screen", Role::Room, [x, y, 0.004], black)
        } else {
            thing::disc("screen", Role::Room, x / 2.0, 0.004, black)
        };
        layout.furnish(screen.at(pose));
    }
}
