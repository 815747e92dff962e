//! Rooms seen from one end: floor, two or three walls, a table, a cupboard, seats.

use super::setting::{TABLE_M, slab, table, wall_paint, wood};
use super::views::Around;
use super::{furniture, tables};
use crate::place::{Layout, Region, Spot};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::Solid;
use crate::texture::Paint;
use crate::thing;
use crate::world::Viewpoint;

/// A room with furniture and, unless it is to be empty, things on the table, the floor and a low cupboard.
pub(super) fn furnished(rng: &mut Rng, with_things: bool) -> (Layout, Viewpoint) {
    let around = Around {
        target_m: [0.0, 0.0, 0.42],
        distance_m: 2.0..2.6,
        elevation_deg: 20.0..34.0,
        azimuth_deg: -20.0..20.0,
    };
    let viewpoint = around.viewpoint(rng);
    let side = rng.pick(&[-1.0, 1.0]);
    let (width, depth) = (rng.range(0.9..1.2), rng.range(0.55..0.75));
    let table_m = [side * rng.range(0.1..0.3), rng.range(0.15..0.35)];
    let back = table_m[1] + depth / 2.0 + rng.range(0.5..0.9);

    let mut solids = vec![slab("floor", [6.0, 6.0, 0.1], [0.0, 0.0, -0.1], wood(rng, 0.12))];
    let wall = wall_paint(rng);
    solids.push(slab("wall", [6.0, 0.1, 2.8], [0.0, back + 0.05, 0.0], wall));
    let walls = if rng.chance(0.5) { vec![side, -side] } else { vec![side] };
    for of in walls {
        let inner = rng.range(1.35..1.8);
        solids.push(slab("wall", [0.1, 6.0, 2.8], [of * (inner + 0.05), 0.0, 0.0], wall));
    }
    let cupboard = solids.len();
    let size = [rng.range(0.5..0.8), rng.range(0.32..0.42), rng.range(0.6..1.5)];
    let place = [-side * rng.range(0.5..0.8), back - size[1] / 2.0, 0.0];
    solids.push(furniture::cupboard(size, wood(rng, 0.3)).at(Pose::at(place)));
    for of in [-1.0, 1.0] {
        let beside = [table_m[0] + of * (width / 2.0 + 0.32), table_m[1] + rng.range(-0.1..0.1), 0.0];
        solids.push(seat(rng).at(Pose::at(beside).turned(2, -of * rng.range(60.0..120.0))));
    }
    let mut table = table([width, depth], wood(rng, 0.19));
    (table.pose.origin.x, table.pose.origin.y) = (table_m[0], table_m[1]);
    solids.push(table);

    let on = solids.len() - 1;
    let mut layout = Layout::new(solids, on);
    if with_things {
        let middle = Region { center_m: table_m, half_m: [width / 2.0 - 0.12, depth / 2.0 - 0.12] };
        let count = 3 + rng.below(4);
        tables::tabletop(rng, &mut layout, count, middle);
        on_floor(rng, &mut layout);
        let [x, y, _] = place;
        let low_m = [x - size[0] / 2.0, y - size[1] / 2.0, size[2]];
        let high_m = [x + size[0] / 2.0, y + size[1] / 2.0, size[2] + 0.4];
        on_cupboard(rng, &mut layout, &Spot { on: cupboard, low_m, high_m });
    }
    (layout, viewpoint)
}

fn seat(rng: &mut Rng) -> Solid {
    if rng.chance(0.5) {
        return furniture::chair();
    }
    let (side, height) = (rng.range(0.36..0.44), rng.range(0.40..0.48));
    furniture::stool(side, height, Paint::plain(rng.pick(&[[0.45, 0.12, 0.10], [0.2, 0.25, 0.3], [0.5; 3]])))
}

/// Parcels, balls and the like before the table.
fn on_floor(rng: &mut Rng, layout: &mut Layout) {
    let spot = Spot { on: 0, low_m: [-0.75, -0.85, 0.0], high_m: [0.75, -0.35, TABLE_M] };
    for _ in 0..2 + rng.below(3) {
        let thing = match rng.below(4) {
            0 | 1 => thing::parcel(rng),
            2 => {
                let radius_m = rng.range(0.07..0.12);
                thing::ball(rng, radius_m)
            }
            _ => tables::any(rng),
        };
        layout.stand_in(rng, &thing, &spot);
    }
}

fn on_cupboard(rng: &mut Rng, layout: &mut Layout, spot: &Spot) {
    // On a higher one they would not be seen from here.
    const SEEN_M: f64 = 1.1;
    if spot.low_m[2] < SEEN_M {
        for _ in 0..1 + rng.below(3) {
            let thing = tables::any(rng);
            layout.stand_in(rng, &thing, spot);
        }
    }
}
