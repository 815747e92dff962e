//! Clips in which hands push things over the table.

use glam::DVec3;

use crate::family::setting::TABLE_M;
use crate::place::Region;
use crate::random::Rng;
use crate::solid::{Outline, Role};
use crate::thing::{self, Palette};
use crate::video::draft::{Draft, REACH, Side};
use crate::video::hand::{self, FINGER_M};
use crate::video::script::{Group, Joint, Script};

const AFTER_S: f64 = 0.5;
/// Fingers lie on each other.
const CLOSED_M: f64 = 0.004;
/// From where a hand begins to push it is so far behind the thing at first (m).
const BEHIND_M: f64 = 0.09;

/// One of two boxes that stand flush is pushed along the face that they share.
pub(super) fn flush(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let palette = Palette::any(rng);
    let (depth, height) = (rng.range(0.06..0.11), rng.range(0.05..0.12));
    let paint = palette.paint(rng, 0.2);
    let block =
        |rng: &mut Rng| thing::block("box", Role::Object, [rng.range(0.06..0.11), depth, height], paint);
    let (one, other) = (block(rng), block(rng));
    let region = Region { half_m: [0.12, 0.10], ..REACH };
    let one = draft.stand(rng, &one, region)?;
    let other = draft.layout.stand_flush(&other, one, rng.pick(&[-1.0, 1.0]))?;
    draft.bystanders(rng, 2);
    draft.groups.push(Group { members: vec![one, other], joint: Joint::Flush });

    let side = rng.pick(&Side::ALL);
    let hand = draft.add_hand(rng, side, 0.4..1.0);
    let pushed = if rng.chance(0.5) { one } else { other };
    let along = away_from(&mut draft, hand, pushed);
    let solid = &draft.layout.solids[pushed];
    let Outline::Rectangle { half_m } = solid.form.outline else { return None };
    let point = solid.pose.origin - along * half_m[1] + DVec3::Z * rng.range(0.5..0.8) * height;
    let way = along * rng.range(0.06..0.14);
    push(&mut draft, hand, pushed, point, way);
    Some(draft.script(AFTER_S))
}

/// The direction of the y axis of a thing that leads away from where a hand comes from.
fn away_from(draft: &mut Draft, hand: usize, thing: usize) -> DVec3 {
    let along = draft.layout.solids[thing].pose.rotation.col(1);
    let shoulder = draft.hand(hand).shoulder;
    if along.dot(shoulder) > 0.0 { -along } else { along }
}

/// Fingertips touch a thing in a point, push it some way, and go back.
pub(super) fn push(draft: &mut Draft, hand: usize, thing: usize, point: DVec3, way: DVec3) -> f64 {
    let pace = draft.pace;
    let touching = hand::pushing(point, way);
    let path = draft.path(hand);
    path.grip(0.05, CLOSED_M);
    let mut behind = touching;
    behind.origin -= way.normalize_or_zero() * BEHIND_M;
    let mut over = behind;
    over.origin.z += 0.08;
    path.go(0.8 * pace, over);
    path.go(0.25 * pace, behind);
    path.go(0.3 * pace, touching);
    path.wait(0.08);
    let from_s = path.end_s();
    path.shift((0.4 + 3.0 * way.length()) * pace, way);
    path.wait(0.08);
    let to_s = path.end_s();
    path.shift(0.25 * pace, -way.normalize_or_zero() * BEHIND_M + DVec3::Z * 0.05);
    let home = path.at(0.0).pose;
    path.go(0.7 * pace, home);
    draft.hold(hand, thing, from_s);
    draft.release_at(hand, to_s);
    from_s
}

/// A hand sweeps three to five small things together.
pub(super) fn sweep(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    draft.pace = draft.pace.max(0.9);
    let side = rng.pick(&[Side::Left, Side::Right]);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    let shoulder = draft.hand(hand).shoulder;
    let along = -DVec3::new(shoulder.x, shoulder.y, 0.0).normalize_or(DVec3::X);
    let across = DVec3::Z.cross(along);
    let middle = DVec3::new(0.0, 0.0, TABLE_M) + draft.seen_direction([0.0, rng.range(-0.06..0.06)]);
    let count = 3 + rng.below(3);
    for k in 0..count {
        let side_m = rng.range(0.028..0.045);
        let paint = Palette::any(rng).paint(rng, 0.1);
        let dice = thing::block("box", Role::Object, [side_m, side_m, rng.range(0.025..0.04)], paint);
        let place = middle + along * (0.075 * k as f64 - 0.16) + across * rng.range(-0.012..0.012);
        draft.layout.stand_at(&dice, [place.x, place.y], rng.range(0.0..90.0))?;
    }
    draft.bystanders(rng, 1);
    let start = middle - along * 0.26 + DVec3::Z * (FINGER_M + 0.012);
    let pace = draft.pace;
    let way = along * rng.range(0.24..0.32);
    let hand = draft.hand(hand);
    hand.pushes = true;
    let path = &mut hand.path;
    path.grip(0.01, CLOSED_M);
    let low = hand::pushing(start, along);
    let mut over = low;
    over.origin.z += 0.10;
    path.go(0.8 * pace, over);
    path.go(0.3 * pace, low);
    path.shift(1.3 * pace, way);
    path.shift(0.3 * pace, -along * 0.05);
    path.shift(0.3 * pace, DVec3::Z * 0.10);
    let home = path.at(0.0).pose;
    path.go(0.7 * pace, home);
    Some(draft.script(AFTER_S))
}
