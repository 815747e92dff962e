//! Elongated things with a handle of another colour, as they lie.

use glam::DVec3;

use super::{Palette, block, part};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Cuboid, Piece, Revolved, Shape};
use crate::solid::{Form, Outline, Role, Solid};
use crate::texture::Paint;

fn metal(rng: &mut Rng) -> Paint {
    let tone = rng.range(0.3..0.6);
    Paint { gloss: 0.5, ..Paint::plain([tone, tone, tone * 1.03]) }
}

fn handle(rng: &mut Rng) -> Paint {
    let palette = if rng.chance(0.3) { Palette::WOOD } else { Palette::any(rng) };
    palette.paint(rng, 0.0)
}

/// A turned thing that stands on its end: outline (r, z) of its faces behind the first, and their paints.
fn turned(kind: &'static str, profile: &[[f64; 2]], paints: Vec<Paint>) -> Solid {
    let pieces: Vec<Piece> = profile.iter().copied().map(Piece::Line).collect();
    let mut body = part(Shape::Revolved(Revolved::new(0.0, &pieces)), [0.0; 3], paints[0]);
    body.paints = paints;
    let form = Form {
        outline: Outline::Disc { radius_m: 0.0 },
        height_m: 0.0,
        has_straight_sides: false,
        has_flat_top: false,
        has_flat_base: false,
        cavity: None,
    };
    Solid { kind, role: Role::Object, parts: vec![body], form, pose: Pose::at([0.0; 3]) }
}

/// A screwdriver: it lies on its handle and its tip.
pub(crate) fn screwdriver(rng: &mut Rng) -> Solid {
    let (grip, shaft) = (rng.range(0.011..0.017), rng.range(0.003..0.0045));
    let (middle, end) = (rng.range(0.08..0.11), rng.range(0.07..0.14));
    let profile = [
        [grip * 0.7, 0.0],
        [grip, 0.012],
        [grip, middle],
        [shaft, middle + 0.008],
        [shaft, middle + end],
        [0.0, middle + end],
    ];
    let (handle, metal) = (handle(rng), metal(rng));
    let paints = vec![handle, handle, handle, handle, metal, metal];
    let dip_deg = libm::atan2(grip - shaft, end).to_degrees();
    turned("screwdriver", &profile, paints).laid_dipped(dip_deg)
}

/// A brush: it lies on its bristles and the end of its handle.
pub(crate) fn brush(rng: &mut Rng) -> Solid {
    let (stick, end) = (rng.range(0.004..0.006), rng.range(0.10..0.17));
    let tuft = rng.range(0.010..0.02);
    let profile = [
        [stick, 0.0],
        [stick * 1.4, end],
        [tuft, end + 0.025],
        [tuft, end + 0.045],
        [tuft * 0.9, end + rng.range(0.07..0.09)],
    ];
    let tip = [0.0, profile[4][1]];
    let (handle, metal, hair) = (handle(rng), metal(rng), handle(rng));
    let paints = vec![handle, handle, handle, metal, hair, hair];
    let dip_deg = -libm::atan2(tuft - stick, end + 0.025).to_degrees();
    turned("brush", &[profile.as_slice(), &[tip]].concat(), paints).laid_dipped(dip_deg)
}

/// A thing that lies flat: a thick handle along -x, and a second block along +x.
fn flat(kind: &'static str, handle_m: [f64; 3], other_m: [f64; 3], [handle, other]: [Paint; 2]) -> Solid {
    let mut tool = block(kind, Role::Object, handle_m, handle);
    tool.parts[0].pose.origin.x = -handle_m[0] / 2.0;
    let shape = Shape::Cuboid(Cuboid { half_m: DVec3::from(other_m) / 2.0 });
    tool.parts.push(part(shape, [other_m[0] / 2.0, 0.0, other_m[2] / 2.0], other));
    let half_m = [handle_m[0].max(other_m[0]), handle_m[1].max(other_m[1]) / 2.0];
    tool.form.outline = Outline::Rectangle { half_m };
    tool.form.has_straight_sides = false;
    tool.form.has_flat_top = false;
    tool
}

/// A knife or spatula.
pub(crate) fn knife(rng: &mut Rng) -> Solid {
    let grip = [rng.range(0.09..0.12), rng.range(0.018..0.026), rng.range(0.010..0.016)];
    let blade = [rng.range(0.09..0.18), rng.range(0.018..0.05), rng.range(0.0012..0.0025)];
    flat("knife", grip, blade, [handle(rng), metal(rng)])
}

/// A hammer: its head lies across.
pub(crate) fn hammer(rng: &mut Rng) -> Solid {
    let thick = rng.range(0.020..0.030);
    let grip = [rng.range(0.16..0.24), rng.range(0.018..0.026), thick * rng.range(0.6..0.9)];
    flat("hammer", grip, [thick, rng.range(0.08..0.11), thick], [handle(rng), metal(rng)])
}
