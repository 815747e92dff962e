//! Bodies of several convex parts with a neck or a fold between them.

use super::{Palette, part};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Piece, Revolved, Shape, TorusArc};
use crate::solid::{Form, Outline, Part, Role, Solid};
use crate::texture::{Paint, Texture};

fn body(kind: &'static str, parts: Vec<Part>, half_m: [f64; 2], height_m: f64) -> Solid {
    let form = Form {
        outline: Outline::Rectangle { half_m },
        height_m,
        has_straight_sides: false,
        has_flat_top: false,
        has_flat_base: true,
        cavity: None,
    };
    Solid { kind, role: Role::Object, parts, form, pose: Pose::at([0.0; 3]) }
}

fn turned(profile: &[Piece], paints: Vec<Paint>) -> Part {
    Part { paints, ..part(Shape::Revolved(Revolved::new(0.0, profile)), [0.0; 3], Paint::plain([0.0; 3])) }
}

/// A ball of this radius with its middle there.
fn ball_at([x, y, z]: [f64; 3], radius_m: f64, paint: Paint) -> Part {
    part(Shape::Revolved(Revolved::ball(radius_m)), [x, y, z - radius_m], paint)
}

/// Paint of the body and of the other part, which often goes on in it.
fn two_paints(rng: &mut Rng) -> [Paint; 2] {
    let palette = Palette::any(rng);
    let body = palette.paint(rng, 0.25);
    let body = match rng.below(4) {
        0 => Paint { texture: Texture::Stripes { period_m: rng.range(0.012..0.04), upright: false }, ..body },
        1 => Paint { texture: Texture::Clouds { seed: rng.bits(), cell_m: 0.006 }, ..body },
        _ => body,
    };
    [body, if rng.chance(0.6) { body } else { palette.paint(rng, 0.1) }]
}

/// A soft toy of two balls, one on the other, with ears.
pub(crate) fn doll(rng: &mut Rng) -> Solid {
    let [main, other] = two_paints(rng);
    let (belly, head) = (rng.range(0.035..0.06), rng.range(0.025..0.042));
    let (belly_z, neck) = (belly * 0.93, head * rng.range(0.5..0.8));
    let foot = (belly * belly - belly_z * belly_z).sqrt();
    let neck_z = belly_z + (belly * belly - neck * neck).sqrt();
    let head_z = neck_z + (head * head - neck * neck).sqrt();
    let profile = [
        Piece::Line([foot, 0.0]),
        Piece::Arc { to: [neck, neck_z], center_z: belly_z },
        Piece::Arc { to: [0.0, head_z + head], center_z: head_z },
    ];
    let mut parts = vec![turned(&profile, vec![main, main, other])];
    if rng.chance(0.7) {
        let ear = head * rng.range(0.3..0.5);
        for side in [-1.0, 1.0] {
            parts.push(ball_at([side * head * 0.75, 0.0, head_z + head * 0.7], ear, other));
        }
    }
    body("doll", parts, [belly; 2], head_z + head * 1.2)
}

/// An animal on four legs.
pub(crate) fn animal(rng: &mut Rng) -> Solid {
    let [main, other] = two_paints(rng);
    let (trunk, length) = (rng.range(0.022..0.036), rng.range(0.05..0.09));
    let leg = rng.range(0.02..0.05);
    let trunk_z = leg + 0.8 * trunk;
    let shape = Shape::Revolved(Revolved::capsule(trunk, length));
    let pose = Pose::along([-length / 2.0, 0.0, trunk_z], [1.0, 0.0, 0.0]);
    let mut parts = vec![Part { shape, pose, paints: vec![main] }];
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let shape = Shape::Revolved(Revolved::cylinder(trunk * 0.3, trunk_z));
        parts.push(part(shape, [x * length / 2.0, y * trunk * 0.5, 0.0], other));
    }
    let (head, up) = (trunk * rng.range(0.6..0.85), trunk * rng.range(0.5..1.1));
    let head_x = length / 2.0 + trunk * 0.7 + head * 0.6;
    parts.push(ball_at([head_x, 0.0, trunk_z + up], head, other));
    body("animal", parts, [head_x + head, trunk], trunk_z + up + head)
}

/// A piece of a board game: foot, waist, head.
pub(crate) fn pawn(rng: &mut Rng) -> Solid {
    let [main, other] = two_paints(rng);
    let (foot, head) = (rng.range(0.025..0.04), rng.range(0.018..0.032));
    let (waist, waist_z) = (head * rng.range(0.4..0.6), rng.range(0.05..0.11));
    let head_z = waist_z + (head * head - waist * waist).sqrt();
    let profile = [
        Piece::Line([foot, 0.0]),
        Piece::Line([foot, 0.01]),
        Piece::Line([waist, waist_z * 0.6]),
        Piece::Line([waist, waist_z]),
        Piece::Arc { to: [0.0, head_z + head], center_z: head_z },
    ];
    let paints = vec![main, main, main, main, other];
    body("pawn", vec![turned(&profile, paints)], [foot; 2], head_z + head)
}

/// A pot with a lid, a knob on that, and two handles.
pub(crate) fn pot(rng: &mut Rng) -> Solid {
    let [main, other] = two_paints(rng);
    let (radius, height) = (rng.range(0.06..0.10), rng.range(0.06..0.11));
    let (knob, neck, lid) = (rng.range(0.012..0.02), 0.007, height + rng.range(0.012..0.022));
    let profile = [
        [radius, 0.0],
        [radius, height],
        [radius + 0.003, height],
        [radius + 0.003, height + 0.005],
        [neck, lid],
        [neck, lid + 0.008],
        [knob, lid + 0.012],
        [knob, lid + 0.022],
        [0.0, lid + 0.022],
    ];
    let paints = [vec![main; 2], vec![other; 7]].concat();
    let mut parts = vec![turned(&profile.map(Piece::Line), paints)];
    for turn_deg in [0.0, 180.0] {
        let arc = Shape::TorusArc(TorusArc::new(0.026, 0.005, 90.0));
        let turned = Pose::at([0.0; 3]).turned(2, turn_deg);
        let pose = turned.after(&Pose::at([radius - 0.002, 0.0, height * 0.75]));
        parts.push(Part { shape: arc, pose, paints: vec![Paint::plain(other.base)] });
    }
    body("pot", parts, [radius + 0.03, radius], lid + 0.022)
}
