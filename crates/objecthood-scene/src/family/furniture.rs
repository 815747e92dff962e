//! Furniture of rooms. Each piece stands on z = 0.

use glam::DVec3;

use crate::pose::Pose;
use crate::shape::{Cuboid, Revolved, Shape};
use crate::solid::{Part, Role, Solid};
use crate::texture::Paint;
use crate::thing;

/// A seat on four legs with a backrest of two posts and a board; it faces -y.
pub(super) fn chair() -> Solid {
    let metal = Paint::plain([0.25, 0.25, 0.27]);
    let seat = Paint::plain([0.16, 0.20, 0.30]);
    let mut chair = thing::block("chair", Role::Furniture, [0.42, 0.42, 0.03], seat);
    chair.parts[0].pose.origin.z += 0.42;
    for (x, y, height) in [(-1.0, -1.0, 0.42), (1.0, -1.0, 0.42), (-1.0, 1.0, 0.95), (1.0, 1.0, 0.95)] {
        let shape = Shape::Revolved(Revolved::cylinder(0.011, height));
        let reach = if height > 0.5 { 0.225 } else { 0.19 };
        chair.parts.push(Part { shape, pose: Pose::at([x * 0.19, y * reach, 0.0]), paints: vec![metal] });
    }
    let mut rest = thing::block("", Role::Furniture, [0.40, 0.015, 0.14], seat).parts.remove(0);
    rest.pose.origin += DVec3::new(0.0, 0.245, 0.80);
    chair.parts.push(rest);
    chair
}

/// A seat that is a box.
pub(super) fn stool(side_m: f64, height_m: f64, paint: Paint) -> Solid {
    thing::block("stool", Role::Furniture, [side_m, side_m, height_m], paint)
}

/// A cupboard with two doors and their handles on the side of -y.
pub(super) fn cupboard([width, depth, height]: [f64; 3], paint: Paint) -> Solid {
    const DOOR_M: f64 = 0.018;
    let mut cupboard = thing::block("cupboard", Role::Furniture, [width, depth, height], paint);
    for side in [-1.0, 1.0] {
        let door = [width / 2.0 - 0.006, DOOR_M, height - 0.06];
        let front = -(depth + DOOR_M) / 2.0;
        cupboard.parts.push(board(door, [side * width / 4.0, front, height / 2.0], paint));
        let handle = [0.012, 0.025, 0.12];
        let place = [side * 0.04, front - DOOR_M / 2.0 - 0.0125, height / 2.0];
        cupboard.parts.push(board(handle, place, Paint::plain([0.5; 3])));
    }
    cupboard
}

/// A cuboid of these sides around a place.
pub(crate) fn board([x, y, z]: [f64; 3], middle_m: [f64; 3], paint: Paint) -> Part {
    let shape = Shape::Cuboid(Cuboid { half_m: DVec3::new(x, y, z) / 2.0 });
    Part { shape, pose: Pose::at(middle_m), paints: vec![paint] }
}

/// A round bar with round ends from one place to another.
pub(crate) fn bar(radius_m: f64, from_m: [f64; 3], to_m: [f64; 3], paint: Paint) -> Part {
    let along = DVec3::from(to_m) - DVec3::from(from_m);
    let shape = Shape::Revolved(Revolved::capsule(radius_m, along.length()));
    Part { shape, pose: Pose::along(from_m, along.into()), paints: vec![paint] }
}
