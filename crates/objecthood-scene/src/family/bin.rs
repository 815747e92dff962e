//! A bin on a table, seen from above, with things in it.

use super::furniture::board;
use super::setting::{self, TABLE_M};
use super::tables;
use super::views::Around;
use crate::place::{Layout, Spot};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;
use crate::thing;
use crate::world::Viewpoint;

/// Thickness of its walls and floor, and how far its rim stands out (m).
const WALL_M: f64 = 0.004;
const RIM_M: f64 = 0.014;

/// A bin with five to seventeen things, partly on each other.
pub(super) fn filled(rng: &mut Rng) -> (Layout, Viewpoint) {
    let around = Around {
        target_m: [0.0, 0.0, TABLE_M + 0.05],
        distance_m: 0.8..1.05,
        elevation_deg: 60.0..89.0,
        azimuth_deg: -40.0..40.0,
    };
    let viewpoint = around.viewpoint(rng);
    let mut layout = setting::with_table(rng, false);
    let inner = [rng.range(0.36..0.52), rng.range(0.28..0.38), rng.range(0.12..0.20)];
    let colors = [[0.10, 0.18, 0.42], [0.35, 0.35, 0.36], [0.45, 0.08, 0.06], [0.55, 0.55, 0.52]];
    let tote = tote(inner, Paint::plain(rng.pick(&colors)));
    let on = layout.furnish(tote.at(Pose::at([0.0, 0.0, TABLE_M])));
    let [x, y] = [inner[0] / 2.0, inner[1] / 2.0];
    let floor = TABLE_M + WALL_M;
    let spot = Spot { on, low_m: [-x, -y, floor], high_m: [x, y, floor + inner[2] + 0.05] };
    for _ in 0..9 + rng.below(9) {
        let thing = small(rng);
        layout.drop_in(rng, &thing, &spot);
    }
    (layout, viewpoint)
}

/// A floor, four walls, and a rim that runs around them outside.
fn tote([x, y, z]: [f64; 3], paint: Paint) -> Solid {
    let (wide, deep) = (x + 2.0 * WALL_M, y + 2.0 * WALL_M);
    let mut tote = thing::block("bin", Role::Furniture, [wide, deep, WALL_M], paint);
    let (middle, rim) = (z / 2.0 + WALL_M, z + WALL_M - RIM_M / 2.0);
    for side in [-1.0, 1.0] {
        let [at_x, at_y] = [side * (x + WALL_M) / 2.0, side * (y + WALL_M) / 2.0];
        tote.parts.push(board([WALL_M, deep, z], [at_x, 0.0, middle], paint));
        tote.parts.push(board([x, WALL_M, z], [0.0, at_y, middle], paint));
        let out = side * (WALL_M + RIM_M) / 2.0;
        tote.parts.push(board([RIM_M, deep + 2.0 * RIM_M, RIM_M], [at_x + out, 0.0, rim], paint));
        tote.parts.push(board([wide, RIM_M, RIM_M], [0.0, at_y + out, rim], paint));
    }
    tote
}

/// A thing that is small enough for a bin.
fn small(rng: &mut Rng) -> Solid {
    match rng.below(6) {
        0 | 1 => thing::package(rng),
        2 => thing::brick(rng),
        3 => thing::can(rng).laid(),
        4 => thing::bottle(rng).laid(),
        _ => tables::any(rng),
    }
}
