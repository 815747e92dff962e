//! People beside a table.

use glam::DVec3;

use super::furniture::{bar, board};
use super::setting::{self, TABLE_M};
use super::tables;
use super::views::Around;
use crate::place::Layout;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;
use crate::thing;
use crate::world::Viewpoint;

/// How far from the table's edge the middle of a body stands (m).
const AWAY_M: f64 = 0.20;

/// One or two people who hold their hands over a table with three to seven things.
pub(super) fn beside_table(rng: &mut Rng) -> (Layout, Viewpoint) {
    let around = Around {
        target_m: [0.0, 0.1, TABLE_M + 0.12],
        distance_m: 1.35..1.75,
        elevation_deg: 20.0..38.0,
        azimuth_deg: -25.0..25.0,
    };
    let viewpoint = around.viewpoint(rng);
    let mut layout = setting::with_table(rng, false);
    let table = &layout.solids[layout.table()];
    let [half_x, half_y] = [table.support(DVec3::X), table.support(DVec3::Y)];
    // At the right, behind, at the left; each faces the table.
    let places = [
        ([half_x + AWAY_M, rng.range(-0.1..0.25)], 90.0),
        ([rng.range(-0.3..0.3), half_y + AWAY_M], 180.0),
        ([-half_x - AWAY_M, rng.range(-0.1..0.25)], -90.0),
    ];
    let first = rng.below(3);
    for k in 0..1 + rng.below(2) {
        let ([x, y], yaw) = places[(first + k) % 3];
        let pose = Pose::at([x, y, 0.0]).turned(2, yaw + rng.range(-10.0..10.0));
        layout.furnish(person(rng).at(pose));
    }
    let count = 3 + rng.below(5);
    tables::tabletop(rng, &mut layout, count, tables::MIDDLE);
    (layout, viewpoint)
}

/// Height of the hips of someone of 1.72 m (m).
pub(crate) const HIPS_M: f64 = 0.90;
/// Which parts of a person are shoes and legs, and whether they are those of the left (-1) or the right.
pub(crate) const LEG_PARTS: [(usize, f64); 4] = [(0, -1.0), (1, -1.0), (5, 1.0), (6, 1.0)];

/// Someone who stands on z = 0 and faces +y: bars with round ends, and a ball for a head.
pub(crate) fn person(rng: &mut Rng) -> Solid {
    let tall = rng.range(0.92..1.06);
    let shirt =
        Paint::plain(rng.pick(&[[0.5, 0.1, 0.1], [0.1, 0.2, 0.45], [0.6, 0.6, 0.58], [0.15, 0.3, 0.15]]));
    let trousers = Paint::plain(rng.pick(&[[0.06, 0.08, 0.14], [0.2, 0.17, 0.13], [0.1; 3]]));
    let skin = Paint::plain(rng.pick(&[[0.55, 0.36, 0.27], [0.28, 0.16, 0.10], [0.62, 0.45, 0.36]]));
    let mut person = thing::block("person", Role::Furniture, [0.5, 0.3, 1.7 * tall], shirt);
    person.parts.clear();
    let parts = &mut person.parts;
    // Hips, shoulders and head (m), of someone of 1.72 m.
    let [hips, shoulders, head] = [HIPS_M, 1.38, 1.61].map(|z| z * tall);
    for side in [-1.0, 1.0] {
        parts.push(board([0.09, 0.26, 0.08], [side * 0.10, 0.05, 0.04], Paint::plain([0.04; 3])));
        parts.push(bar(0.07, [side * 0.10, 0.0, 0.08], [side * 0.10, 0.0, hips], trousers));
        parts.push(bar(0.115, [side * 0.09, 0.0, hips], [side * 0.09, 0.0, shoulders - 0.10], shirt));
        let elbow = [side * 0.27, rng.range(0.0..0.08), shoulders - 0.30];
        parts.push(bar(0.05, [side * 0.21, 0.0, shoulders - 0.03], elbow, shirt));
        let hand = [side * rng.range(0.08..0.22), rng.range(0.30..0.40), rng.range(0.88..1.05)];
        parts.push(bar(0.038, elbow, hand, skin));
    }
    parts.push(bar(0.115, [0.0, 0.0, hips], [0.0, 0.0, shoulders - 0.08], shirt));
    parts.push(bar(0.055, [0.0, 0.0, shoulders], [0.0, 0.0, head], skin));
    parts.push(bar(0.10, [0.0, 0.01, head - 0.02], [0.0, 0.01, head + 0.03], skin));
    person
}
