//! What is in vessels: rice, soup, sand; and boxes without a lid.

use glam::DVec3;

use super::{block, disc, part, round};
use crate::random::Rng;
use crate::shape::{Cuboid, Piece, Revolved, Shape};
use crate::solid::{Cavity, Form, Role, Solid};
use crate::texture::{Paint, Texture};

/// Contents stay this far from the wall that they follow (m).
const CLEARANCE_M: f64 = 0.0004;

/// Something loose or liquid that fills this share of the depth of a vessel, up to its walls.
pub(crate) fn filling(rng: &mut Rng, vessel: &Form, share: f64) -> Option<Solid> {
    let colors =
        [[0.75, 0.73, 0.66], [0.10, 0.05, 0.03], [0.60, 0.25, 0.05], [0.35, 0.45, 0.12], [0.6, 0.5, 0.3]];
    let (base, ink) = (rng.pick(&colors), rng.pick(&colors));
    let texture = Texture::Clouds { seed: rng.bits(), cell_m: rng.range(0.003..0.02) };
    let paint = match rng.below(2) {
        0 => Paint { gloss: 0.5, ..Paint::plain(base) },
        _ => Paint { ink, texture, ..Paint::plain(base) },
    };
    match vessel.cavity? {
        Cavity::Flat { floor_z, radius_m } => {
            let height = share * (vessel.height_m - floor_z);
            Some(disc("contents", Role::Object, radius_m - CLEARANCE_M, height, paint))
        }
        Cavity::Round { floor_z, radius_m } => {
            let (radius, height) = (radius_m - CLEARANCE_M, share * (vessel.height_m - floor_z));
            let rim = (radius * radius - (radius - height) * (radius - height)).sqrt();
            let profile = [Piece::Arc { to: [rim, height], center_z: radius }, Piece::Line([0.0, height])];
            Some(round::heap("contents", Revolved::new(0.0, &profile), rim, height, paint))
        }
    }
}

/// A box without a lid, or a tray, of these inner sides.
pub(crate) fn open_box(kind: &'static str, [x, y, z]: [f64; 3], wall_m: f64, paint: Paint) -> Solid {
    let (wide, deep, high) = (x + 2.0 * wall_m, y + 2.0 * wall_m, z + wall_m);
    let mut open = block(kind, Role::Object, [wide, deep, wall_m], paint);
    for side in [-1.0, 1.0] {
        let walls = [
            ([wall_m, deep, z], [side * (x + wall_m) / 2.0, 0.0]),
            ([x, wall_m, z], [0.0, side * (y + wall_m) / 2.0]),
        ];
        for (sides, [at_x, at_y]) in walls {
            let shape = Shape::Cuboid(Cuboid { half_m: DVec3::from(sides) / 2.0 });
            open.parts.push(part(shape, [at_x, at_y, wall_m + z / 2.0], paint));
        }
    }
    open.form.height_m = high;
    open.form.has_flat_top = false;
    open.form.cavity = Some(Cavity::Flat { floor_z: wall_m, radius_m: x.min(y) / 2.0 });
    open
}
