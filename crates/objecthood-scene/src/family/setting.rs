//! The room, its table, and what stands about.

use super::furniture;
use crate::place::Layout;
use crate::pose::Pose;
use crate::random::Rng;
use crate::shape::{Revolved, Shape, TorusArc};
use crate::solid::{Form, Outline, Part, Role, Solid};
use crate::texture::{Albedo, Paint, Texture};
use crate::thing;

/// Height of the table's top over the floor (m).
pub(crate) const TABLE_M: f64 = 0.74;

const WOODS: [(Albedo, Albedo); 4] = [
    ([0.62, 0.47, 0.33], [0.50, 0.35, 0.22]),
    ([0.55, 0.42, 0.30], [0.40, 0.27, 0.17]),
    ([0.66, 0.58, 0.48], [0.56, 0.47, 0.37]),
    ([0.36, 0.22, 0.13], [0.24, 0.13, 0.07]),
];

/// A table in a room; with `full` also a shelf, a chair, a cable and sheets of paper.
pub(crate) fn with_table(rng: &mut Rng, full: bool) -> Layout {
    let board = wood(rng, 0.19);
    let boards = wood(rng, 0.12);
    let wall = wall_paint(rng);

    let (width, depth) = (rng.range(1.3..1.6), rng.range(0.95..1.1));
    let back = depth / 2.0 + if full { 1.0 } else { rng.range(0.5..1.0) };
    let mut solids = vec![
        slab("floor", [6.0, 6.0, 0.1], [0.0, 0.0, -0.1], boards),
        slab("wall", [6.0, 0.1, 2.8], [0.0, back + 0.05, 0.0], wall),
        slab("wall", [0.1, 6.0, 2.8], [-2.05, 0.0, 0.0], wall),
        slab("wall", [0.1, 6.0, 2.8], [2.05, 0.0, 0.0], wall),
        table([width, depth], board),
    ];
    let table = solids.len() - 1;
    if full {
        solids
            .push(shelf(back, Paint { texture: Texture::Wood { seed: rng.bits(), board_m: 0.19 }, ..board }));
        let place = [rng.range(-0.5..0.5), depth / 2.0 + 0.3, 0.0];
        solids.push(furniture::chair().at(Pose::at(place).turned(2, rng.range(-12.0..12.0))));
        solids.push(cable(rng, depth));
        for side in [-1.0, 1.0] {
            solids.push(sheet(rng, side * width));
        }
    }
    Layout::new(solids, table)
}

/// Any wood, in boards of this width.
pub(super) fn wood(rng: &mut Rng, board_m: f64) -> Paint {
    let (base, ink) = rng.pick(&WOODS);
    Paint { ink, texture: Texture::Wood { seed: rng.bits(), board_m }, ..Paint::plain(base) }
}

/// Paints the top of the table.
pub(super) fn cover(layout: &mut Layout, paint: Paint) {
    let table = layout.table();
    layout.solids[table].parts[0].paints = vec![paint];
}

/// What a wall may be painted with.
pub(super) fn wall_paint(rng: &mut Rng) -> Paint {
    Paint::plain(rng.pick(&[[0.72, 0.70, 0.66], [0.60, 0.64, 0.66], [0.68, 0.62, 0.52]]))
}

/// A table of this width and depth on four legs, in the middle of the room.
pub(super) fn table([width, depth]: [f64; 2], paint: Paint) -> Solid {
    let thick = 0.03;
    let mut table = thing::block("table", Role::Furniture, [width, depth, thick], paint);
    table.pose = Pose::at([0.0, 0.0, TABLE_M - thick]);
    let leg = Shape::Revolved(Revolved::cylinder(0.025, TABLE_M - thick));
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let place = [x * (width / 2.0 - 0.08), y * (depth / 2.0 - 0.08), thick - TABLE_M];
        table.parts.push(Part {
            shape: leg.clone(),
            pose: Pose::at(place),
            paints: vec![Paint::plain([0.15; 3])],
        });
    }
    table
}

/// A block that belongs to the room: floor or wall.
pub(super) fn slab(kind: &'static str, size_m: [f64; 3], origin_m: [f64; 3], paint: Paint) -> Solid {
    thing::block(kind, Role::Room, size_m, paint).at(Pose::at(origin_m))
}

/// A board behind the table: two sides and four shelves, against the wall.
fn shelf(back: f64, paint: Paint) -> Solid {
    let (width, depth, height, board) = (1.0, 0.26, 1.7, 0.02);
    let mut shelf = thing::block("shelf", Role::Furniture, [board, depth, height], paint);
    let boards = shelf.parts.remove(0);
    for side in [-1.0, 1.0] {
        let mut part = boards.clone();
        part.pose.origin.x = side * width / 2.0;
        shelf.parts.push(part);
    }
    for k in 0..4 {
        let mut part =
            thing::block("", Role::Furniture, [width - board, depth, board], paint).parts.remove(0);
        part.pose.origin.z = 0.30 + 0.45 * f64::from(k);
        shelf.parts.push(part);
    }
    shelf.at(Pose::at([0.1, back - depth / 2.0, 0.0]))
}

/// A cable that lies in bows along the back of the table.
fn cable(rng: &mut Rng, table_depth: f64) -> Solid {
    let (major, minor) = (rng.range(0.05..0.08), 0.0028);
    let paint = Paint::plain([0.05, 0.05, 0.055]);
    let half_angle_deg = 90.0;
    let parts = (0..4).map(|k| {
        let shape = Shape::TorusArc(TorusArc::new(major, minor, half_angle_deg));
        let turn = if k % 2 == 0 { 90.0 } else { -90.0 };
        let pose = Pose::at([f64::from(k) * 2.0 * major, 0.0, minor]).turned(2, turn);
        Part { shape, pose, paints: vec![paint] }
    });
    let form = Form {
        outline: Outline::Rectangle { half_m: [4.0 * major, major] },
        height_m: 2.0 * minor,
        has_straight_sides: false,
        has_flat_top: false,
        has_flat_base: false,
        cavity: None,
    };
    let pose = Pose::at([rng.range(-0.55..-0.2), table_depth / 2.0 - major - 0.03, TABLE_M]);
    Solid { kind: "cable", role: Role::Furniture, parts: parts.collect(), form, pose }
}

/// A sheet of paper near an edge of the table, which is `side` wide and the sheet on its positive or negative side.
fn sheet(rng: &mut Rng, side: f64) -> Solid {
    let paint = Paint {
        ink: [0.3, 0.3, 0.4],
        texture: Texture::Print { seed: rng.bits() },
        ..Paint::plain([0.8, 0.8, 0.79])
    };
    let place = [side * 0.5 - 0.18_f64.copysign(side), rng.range(-0.3..0.3), TABLE_M];
    thing::block("sheet", Role::Furniture, [0.21, 0.297, 0.0003], paint)
        .at(Pose::at(place).turned(2, rng.range(-25.0..25.0)))
}
