//! A shelf seen from the front: boards at several heights with things on them.

use super::furniture::board;
use super::setting::{slab, wall_paint, wood};
use super::tables;
use super::views::Around;
use crate::place::{Layout, Spot};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;
use crate::thing;
use crate::world::Viewpoint;

const BOARD_M: f64 = 0.02;
/// Height that the camera looks at, and how far above and below it boards are filled (m).
const LOOK_M: f64 = 1.05;
const FILLED_M: f64 = 0.5;

/// A shelf before a wall, two to four things on each board that is seen.
pub(super) fn filled(rng: &mut Rng) -> (Layout, Viewpoint) {
    let front = 0.35;
    let around = Around {
        target_m: [0.0, front, LOOK_M],
        distance_m: 1.1..1.4,
        elevation_deg: 4.0..24.0,
        azimuth_deg: -25.0..25.0,
    };
    let viewpoint = around.viewpoint(rng);
    let (width, depth) = (rng.range(0.8..1.1), rng.range(0.28..0.40));
    let (lowest, spacing) = (rng.range(0.10..0.30), rng.range(0.28..0.36));
    let boards: Vec<f64> = (0..6).map(|k| lowest + spacing * f64::from(k)).collect();

    let floor = slab("floor", [6.0, 6.0, 0.1], [0.0, 0.0, -0.1], wood(rng, 0.12));
    let wall = wall_paint(rng);
    let wall = slab("wall", [6.0, 0.1, 2.8], [0.0, front + depth + 0.05, 0.0], wall);
    let paint = if rng.chance(0.5) { wood(rng, 0.3) } else { Paint::plain([0.68, 0.68, 0.66]) };
    let rack = rack([width, depth], &boards, paint, rng.chance(0.5));
    let rack = rack.at(Pose::at([0.0, front + depth / 2.0, 0.0]));
    let mut layout = Layout::new(vec![floor, wall, rack], 2);

    for pair in boards.windows(2) {
        let spot = Spot {
            on: 2,
            low_m: [-width / 2.0 + BOARD_M, front, pair[0] + BOARD_M],
            high_m: [width / 2.0 - BOARD_M, front + depth - BOARD_M, pair[1]],
        };
        if (spot.low_m[2] - LOOK_M).abs() < FILLED_M {
            fill(rng, &mut layout, &spot);
        }
    }
    (layout, viewpoint)
}

/// Boards between two sides, with or without a back. Boards lie with their undersides at the heights given.
fn rack([width, depth]: [f64; 2], boards: &[f64], paint: Paint, has_back: bool) -> Solid {
    let height = boards.last().map_or(0.0, |top| top + BOARD_M);
    let mut rack = thing::block("shelf", Role::Furniture, [width, depth, height], paint);
    rack.parts.clear();
    for side in [-1.0, 1.0] {
        let middle = [side * (width - BOARD_M) / 2.0, 0.0, height / 2.0];
        rack.parts.push(board([BOARD_M, depth, height], middle, paint));
    }
    for z in boards {
        rack.parts.push(board([width - 2.0 * BOARD_M, depth, BOARD_M], [0.0, 0.0, z + BOARD_M / 2.0], paint));
    }
    if has_back {
        let back = [width - 2.0 * BOARD_M, BOARD_M / 2.0, height];
        rack.parts.push(board(back, [0.0, (depth - BOARD_M / 2.0) / 2.0, height / 2.0], paint));
    }
    rack
}

fn fill(rng: &mut Rng, layout: &mut Layout, spot: &Spot) {
    for _ in 0..2 + rng.below(3) {
        let thing = tables::any(rng);
        layout.drop_in(rng, &thing, spot);
    }
}
