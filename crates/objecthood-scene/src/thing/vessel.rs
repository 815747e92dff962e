//! Hollow things: bowls, cups, mugs, plates.

use std::ops::Range;

use super::{color, paint, part};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Piece, Revolved, Shape, TorusArc};
use crate::solid::{Cavity, Form, Outline, Part, Role, Solid};
use crate::texture::Paint;

fn vessel(
    kind: &'static str,
    shape: Revolved,
    paints: Vec<Paint>,
    radius_m: f64,
    height_m: f64,
    cavity: Cavity,
) -> Solid {
    let mut body = part(Shape::Revolved(shape), [0.0; 3], paints[0]);
    body.paints = paints;
    let form = Form {
        outline: Outline::Disc { radius_m },
        height_m,
        has_straight_sides: false,
        has_flat_top: false,
        has_flat_base: true,
        cavity: Some(cavity),
    };
    Solid { kind, role: Role::Object, parts: vec![body], form, pose: Pose::at([0.0; 3]) }
}

/// A bowl with a round inside and a flat foot.
pub(crate) fn bowl(rng: &mut Rng) -> Solid {
    let outer = rng.range(0.065..0.10);
    bowl_of(rng, outer)
}

/// The same, part of a ball of this radius.
pub(crate) fn bowl_of(rng: &mut Rng, outer: f64) -> Solid {
    let inner = outer - rng.range(0.003..0.005);
    let center_z = inner + 0.001;
    let foot = (outer * outer - center_z * center_z).sqrt();
    // A shallow bowl ends below the middle of its ball.
    let rim_z = center_z * rng.range(0.65..1.0);
    let at_rim = |radius: f64| (radius * radius - (center_z - rim_z) * (center_z - rim_z)).sqrt();
    let shape = Revolved::new(
        0.0,
        &[
            Piece::Line([foot, 0.0]),
            Piece::Arc { to: [at_rim(outer), rim_z], center_z },
            Piece::Line([at_rim(inner), rim_z]),
            Piece::Arc { to: [0.0, center_z - inner], center_z },
        ],
    );
    let outside = paint(rng, 0.0, 0.3);
    let inside = if rng.chance(0.5) { Paint::plain(outside.base) } else { Paint::plain(color(rng)) };
    let cavity = Cavity::Round { floor_z: center_z - inner, radius_m: inner };
    vessel("bowl", shape, vec![outside, outside, inside, inside], at_rim(outer), rim_z, cavity)
}

/// Profile of an open vessel with straight walls that lean outwards or not at all.
fn beaker(base: f64, rim: f64, height: f64, wall: f64, floor: f64) -> Revolved {
    // The inner wall is parallel to the outer one.
    let inner_floor = base + (rim - base) * floor / height - wall;
    Revolved::new(
        0.0,
        &[[base, 0.0], [rim, height], [rim - wall, height], [inner_floor, floor], [0.0, floor]]
            .map(Piece::Line),
    )
}

fn beaker_paints(rng: &mut Rng) -> Vec<Paint> {
    let outside = paint(rng, 0.25, 0.2);
    let inside = Paint::plain(if rng.chance(0.5) { outside.base } else { [0.7, 0.7, 0.68] });
    vec![inside, outside, inside, inside, inside]
}

/// A cup without a handle.
pub(crate) fn cup(rng: &mut Rng) -> Solid {
    let (base, height) = (rng.range(0.026..0.036), rng.range(0.08..0.12));
    let rim = base + rng.range(0.004..0.014);
    let shape = beaker(base, rim, height, 0.0025, 0.003);
    let paints = beaker_paints(rng);
    vessel("cup", shape, paints, rim, height, Cavity::Flat { floor_z: 0.003, radius_m: base - 0.0025 })
}

/// A mug: a straight cup with a handle whose ends are sunk in its wall.
pub(crate) fn mug(rng: &mut Rng) -> Solid {
    mug_with(rng, 0.0045..0.006, 0.25..0.32)
}

/// The same with a thick handle that stands far out.
pub(crate) fn big_mug(rng: &mut Rng) -> Solid {
    mug_with(rng, 0.006..0.009, 0.34..0.40)
}

/// The handle is this thick (m, half), and its bow this wide (share of the height, half).
fn mug_with(rng: &mut Rng, thick_m: Range<f64>, bow: Range<f64>) -> Solid {
    let (radius, height) = (rng.range(0.036..0.045), rng.range(0.08..0.105));
    let (wall, minor) = (0.004, rng.range(thick_m));
    let paints = beaker_paints(rng);
    let outside = paints[1];
    let shape = beaker(radius, radius, height, wall, 0.005);
    let cavity = Cavity::Flat { floor_z: 0.005, radius_m: radius - wall };
    let mut mug = vessel("mug", shape, paints, radius, height, cavity);

    let major = height * rng.range(bow);
    let half_angle_deg = 100.0;
    // The round tips of the handle are sunk in the wall but do not come out of it inside.
    let tip_x = radius - wall + minor + 0.0005;
    let center_x = tip_x - major * libm::cos(f64::to_radians(half_angle_deg));
    let handle = Part {
        shape: Shape::TorusArc(TorusArc::new(major, minor, half_angle_deg)),
        pose: Pose::at([center_x, 0.0, height * 0.5]).turned(0, 90.0),
        paints: vec![Paint::plain(outside.base)],
    };
    mug.parts.push(handle);
    mug.form.outline = Outline::Disc { radius_m: center_x + major + minor };
    mug
}

/// A plate: a flat middle and a rim that rises.
pub(crate) fn plate(rng: &mut Rng) -> Solid {
    let rim = rng.range(0.085..0.12);
    let (middle, height, thick) = (rim * 0.62, rng.range(0.014..0.024), 0.004);
    let shape = Revolved::new(
        0.0,
        &[[middle, 0.0], [rim, height - thick], [rim, height], [middle, thick], [0.0, thick]]
            .map(Piece::Line),
    );
    let (main, inner) = (Paint::plain(color(rng)), paint(rng, 0.1, 0.0));
    let paints = vec![main, main, main, inner, main];
    vessel("plate", shape, paints, rim, height, Cavity::Flat { floor_z: thick, radius_m: middle })
}
