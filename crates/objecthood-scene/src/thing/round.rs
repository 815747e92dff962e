//! Cans, balls, cones and bottles.

use super::{color, paint, part};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Piece, Revolved, Shape};
use crate::solid::{Form, Outline, Role, Solid};
use crate::texture::Paint;

fn object(kind: &'static str, shape: Revolved, paints: Vec<Paint>, form: Form) -> Solid {
    let mut body = part(Shape::Revolved(shape), [0.0; 3], paints[0]);
    body.paints = paints;
    Solid { kind, role: Role::Object, parts: vec![body], form, pose: Pose::at([0.0; 3]) }
}

fn form(radius_m: f64, height_m: f64) -> Form {
    Form {
        outline: Outline::Disc { radius_m },
        height_m,
        has_straight_sides: false,
        has_flat_top: false,
        has_flat_base: true,
        cavity: None,
    }
}

/// A can or tin: its lid is of another colour.
pub(crate) fn can(rng: &mut Rng) -> Solid {
    let (radius_m, height_m) = if rng.chance(0.3) {
        (rng.range(0.04..0.07), rng.range(0.04..0.08))
    } else {
        (rng.range(0.03..0.05), rng.range(0.09..0.17))
    };
    let (label, lid) = (paint(rng, 0.55, 0.2), Paint::plain(color(rng)));
    let form = Form { has_straight_sides: true, has_flat_top: true, ..form(radius_m, height_m) };
    object("can", Revolved::cylinder(radius_m, height_m), vec![lid, label, lid], form)
}

/// A low cylinder of one paint.
pub(crate) fn disc(kind: &'static str, role: Role, radius_m: f64, height_m: f64, paint: Paint) -> Solid {
    let form = Form { has_straight_sides: true, has_flat_top: true, ..form(radius_m, height_m) };
    Solid { role, ..object(kind, Revolved::cylinder(radius_m, height_m), vec![paint], form) }
}

/// What lies in a round vessel up to a level: it rests on its lowest point.
pub(super) fn heap(kind: &'static str, shape: Revolved, radius_m: f64, height_m: f64, paint: Paint) -> Solid {
    object(kind, shape, vec![paint], Form { has_flat_base: false, ..form(radius_m, height_m) })
}

/// A ball.
pub(crate) fn ball(rng: &mut Rng, radius_m: f64) -> Solid {
    let form = Form { has_flat_base: false, ..form(radius_m, 2.0 * radius_m) };
    object("ball", Revolved::ball(radius_m), vec![paint(rng, 0.1, 0.35)], form)
}

/// A cone that stands on its base.
pub(crate) fn cone(rng: &mut Rng) -> Solid {
    let (radius_m, height_m) = (rng.range(0.035..0.06), rng.range(0.10..0.18));
    let shape = Revolved::new(0.0, &[Piece::Line([radius_m, 0.0]), Piece::Line([0.0, height_m])]);
    object("cone", shape, vec![paint(rng, 0.0, 0.4)], form(radius_m, height_m))
}

/// A bottle with shoulders and a cap.
pub(crate) fn bottle(rng: &mut Rng) -> Solid {
    let radius = rng.range(0.028..0.042);
    let (body, neck) = (rng.range(0.10..0.16), rng.range(0.010..0.014));
    // The shoulder is a zone of the ball around the middle of the body's upper rim.
    let shoulder_z = body + (radius * radius - neck * neck).sqrt();
    let cap_z = shoulder_z + rng.range(0.02..0.035);
    let shape = Revolved::new(
        0.0,
        &[
            Piece::Line([radius, 0.0]),
            Piece::Line([radius, body]),
            Piece::Arc { to: [neck, shoulder_z], center_z: body },
            Piece::Line([neck, cap_z]),
            Piece::Line([neck + 0.003, cap_z]),
            Piece::Line([neck + 0.003, cap_z + 0.018]),
            Piece::Line([0.0, cap_z + 0.018]),
        ],
    );
    let (glass, label, cap) = (Paint::plain(color(rng)), paint(rng, 0.8, 0.2), Paint::plain(color(rng)));
    let paints = vec![glass, label, glass, glass, cap, cap, cap];
    object("bottle", shape, paints, form(radius, cap_z + 0.018))
}
