//! Boxes, packages and books.

use glam::DVec3;

use super::{color, paint, part};
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Cuboid, Shape};
use crate::solid::{Form, Outline, Part, Role, Solid};
use crate::texture::{Paint, Texture};

/// A cuboid of the given sides.
pub(crate) fn block(kind: &'static str, role: Role, [x, y, z]: [f64; 3], paint: Paint) -> Solid {
    let cuboid = Shape::Cuboid(Cuboid { half_m: DVec3::new(x, y, z) / 2.0 });
    Solid {
        kind,
        role,
        parts: vec![part(cuboid, [0.0, 0.0, z / 2.0], paint)],
        form: form([x / 2.0, y / 2.0], z),
        pose: Pose::at([0.0; 3]),
    }
}

fn form(half_m: [f64; 2], height_m: f64) -> Form {
    Form {
        outline: Outline::Rectangle { half_m },
        height_m,
        has_straight_sides: true,
        has_flat_top: true,
        has_flat_base: true,
        cavity: None,
    }
}

/// A package of any proportion, with a paint of its own on some faces.
pub(crate) fn package(rng: &mut Rng) -> Solid {
    let mut sides = [rng.range(0.05..0.10), rng.range(0.07..0.16), rng.range(0.10..0.23)];
    let turn = rng.below(3);
    sides.rotate_left(turn);
    let mut package = block("box", Role::Object, sides, paint(rng, 0.55, 0.1));
    let main = package.parts[0].paints[0];
    // Top and bottom of a package rarely bear what its sides bear.
    let lid = Paint { texture: if rng.chance(0.5) { Texture::Plain } else { main.texture }, ..main };
    package.parts[0].paints = vec![main, main, main, main, lid, lid];
    package
}

/// A box that stands on floors.
pub(crate) fn parcel(rng: &mut Rng) -> Solid {
    let sides = [rng.range(0.18..0.36), rng.range(0.15..0.28), rng.range(0.10..0.30)];
    let card = [rng.range(0.45..0.6), rng.range(0.32..0.42), rng.range(0.18..0.26)];
    let ink = color(rng);
    block(
        "box",
        Role::Object,
        sides,
        Paint { ink, texture: Texture::Print { seed: rng.bits() }, ..Paint::plain(card) },
    )
}

/// A thin upright box: what leans.
pub(crate) fn slab(rng: &mut Rng) -> Solid {
    let sides = [rng.range(0.08..0.14), rng.range(0.014..0.028), rng.range(0.09..0.14)];
    block("box", Role::Object, sides, paint(rng, 0.6, 0.1))
}

/// A small box of any proportion.
pub(crate) fn brick(rng: &mut Rng) -> Solid {
    let sides = [0, 1, 2].map(|_| rng.range(0.03..0.06));
    block("box", Role::Object, sides, paint(rng, 0.3, 0.2))
}

/// A book that lies: two covers, a spine, and pages that stand back from the covers.
pub(crate) fn book(rng: &mut Rng) -> Solid {
    let (width, depth, height) = (rng.range(0.12..0.17), rng.range(0.18..0.24), rng.range(0.018..0.045));
    let cover = Paint { texture: Texture::Print { seed: rng.bits() }, ..paint(rng, 1.0, 0.0) };
    let spine = Paint::plain(color(rng));
    let pages = Paint {
        ink: [0.55, 0.53, 0.47],
        texture: Texture::Stripes { period_m: 0.0022, upright: false },
        ..Paint::plain([0.78, 0.76, 0.68])
    };
    let (board, back) = (0.0025, 0.004);
    let cuboid = |x: f64, y: f64, z: f64| Shape::Cuboid(Cuboid { half_m: DVec3::new(x, y, z) / 2.0 });
    let parts: Vec<Part> = vec![
        part(cuboid(width, depth, board), [0.0, 0.0, board / 2.0], cover),
        part(cuboid(width, depth, board), [0.0, 0.0, height - board / 2.0], cover),
        part(cuboid(back, depth, height - 2.0 * board), [(back - width) / 2.0, 0.0, height / 2.0], spine),
        part(
            cuboid(width - back - 0.004, depth - 0.008, height - 2.0 * board),
            [(back - 0.004) / 2.0, 0.0, height / 2.0],
            pages,
        ),
    ];
    Solid {
        kind: "book",
        role: Role::Object,
        parts,
        form: form([width / 2.0, depth / 2.0], height),
        pose: Pose::at([0.0; 3]),
    }
}
