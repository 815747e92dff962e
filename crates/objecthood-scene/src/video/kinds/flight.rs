//! Clips in which things fly, fall and roll.

use glam::DVec3;

use super::carry::handy;
use super::push::push;
use crate::family::setting::TABLE_M;
use crate::place::Region;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::Role;
use crate::thing;
use crate::video::camera::CameraPath;
use crate::video::draft::{Draft, REACH};
use crate::video::dynamics::GRAVITY;
use crate::video::script::{Launch, Script};

/// Where balls wait that are thrown or rolled in, out of sight (m from the middle of the table).
const OUTSIDE_M: f64 = 0.80;

/// A ball that comes flying from the side, bounces on the table and goes on.
pub(super) fn throw(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let region = Region { center_m: [0.0, 0.12], half_m: [0.30, 0.12] };
    for _ in 0..rng.below(3) {
        let thing = crate::family::tables::any(rng);
        draft.stand(rng, &thing, region);
    }
    let right = rng.pick(&[-1.0, 1.0]);
    let radius = rng.range(0.028..0.045);
    let height = rng.range(0.10..0.32);
    let start =
        DVec3::Z * (TABLE_M + height) + draft.seen_direction([right * OUTSIDE_M, rng.range(0.0..0.10)]);
    let ball = thing::ball(rng, radius).at(Pose::at(start.into()).turned(2, rng.range(0.0..360.0)));
    let ball = draft.layout.hang(ball);
    // It meets the table at a place of its near half.
    let target = DVec3::Z * (TABLE_M + radius)
        + draft.seen_direction([right * rng.range(0.05..0.30), rng.range(-0.02..0.12)]);
    let speed = rng.range(1.1..2.2);
    let level = DVec3::new(target.x - start.x, target.y - start.y, 0.0);
    let during_s = level.length() / speed;
    let rise = (target.z - start.z - radius) / during_s + GRAVITY * during_s / 2.0;
    let velocity = level / during_s + DVec3::Z * rise;
    let at_s = rng.range(0.3..0.8);
    let spin = DVec3::new(rng.range(-8.0..8.0), rng.range(-8.0..8.0), rng.range(-8.0..8.0));
    draft.launches.push(Launch { solid: ball, at_s, velocity, spin });
    Some(draft.script(2.6))
}

/// A hand lifts a thing and lets it fall onto the table.
pub(super) fn drop(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let region = Region { half_m: [0.18, 0.14], ..REACH };
    let solid = handy(rng);
    let index = draft.stand(rng, &solid, region)?;
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, index);
    let hand = draft.add_hand(rng, side, 0.1..0.6);
    let grasp = draft.grasp(index);
    draft.take(hand, index, grasp);
    let (pace, lift_m) = (draft.pace, rng.range(0.18..0.32));
    let aside = draft.seen_direction([rng.range(-0.06..0.06), rng.range(-0.05..0.05)]);
    let path = draft.path(hand);
    path.shift(0.7 * pace, DVec3::Z * lift_m + aside);
    path.wait(rng.range(0.15..0.5));
    let to_s = path.end_s();
    // Fingers must be out of the way before the thing has fallen by their length.
    let opening_m = path.end().opening_m + 0.03;
    path.grip(0.09, opening_m);
    path.wait(0.3);
    draft.release_at(hand, to_s);
    draft.withdraw(hand);
    Some(draft.script(0.6))
}

/// A ball or a can that rolls over the table: in from the side, or pushed off by a hand.
pub(super) fn roll(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let radius = rng.range(0.028..0.045);
    let ball = thing::ball(rng, radius);
    if rng.chance(0.5) {
        rolled_in(rng, draft, ball, radius)
    } else {
        flicked(rng, &mut draft, &ball).map(|()| draft.script(1.6))
    }
}

fn rolled_in(rng: &mut Rng, mut draft: Draft, ball: crate::solid::Solid, radius: f64) -> Option<Script> {
    let region = Region { center_m: [0.0, 0.14], half_m: [0.30, 0.08] };
    for _ in 0..rng.below(3) {
        let thing = crate::family::tables::any(rng);
        draft.stand(rng, &thing, region);
    }
    let right = rng.pick(&[-1.0, 1.0]);
    // Within the table's edge.
    let table = &draft.layout.solids[draft.layout.table()];
    let out = (table.support(DVec3::X) - 0.01).min(OUTSIDE_M);
    let near = rng.range(0.02..0.14);
    let x = right * out;
    let start = DVec3::new(x, -near, TABLE_M);
    let along = DVec3::new(-right, rng.range(-0.12..0.12), 0.0).normalize_or(DVec3::X);
    let speed = rng.range(0.45..1.0);
    let ball = draft.layout.hang(ball.at(Pose::at(start.into()).turned(2, rng.range(0.0..360.0))));
    // Rolling without slipping.
    let spin = DVec3::Z.cross(along) * (speed / radius);
    let launch = Launch { solid: ball, at_s: rng.range(0.1..0.5), velocity: along * speed, spin };
    draft.launches.push(launch);
    let camera = CameraPath::Still(draft.viewpoint.pose);
    Some(draft.lasting(rng.range(3.0..4.0), camera))
}

/// A hand pushes a ball, which rolls on from there.
fn flicked(rng: &mut Rng, draft: &mut Draft, ball: &crate::solid::Solid) -> Option<()> {
    let radius = ball.form.height_m / 2.0;
    debug_assert!(ball.role == Role::Object);
    let region = Region { half_m: [0.14, 0.10], ..REACH };
    let index = draft.stand(rng, ball, region)?;
    draft.bystanders(rng, 1);
    let side = draft.near_side(rng, index);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    let place = draft.layout.solids[index].pose.origin;
    let shoulder = draft.hand(hand).shoulder;
    let along = DVec3::new(place.x - shoulder.x, place.y - shoulder.y, 0.0).normalize_or(DVec3::X);
    let point = place + DVec3::Z * radius - along * radius;
    let from_s = push(draft, hand, index, point, along * rng.range(0.10..0.16));
    // Let go at the greatest speed, half way.
    let hold = draft.last_hold(hand)?;
    hold.to_s = from_s + (hold.to_s - 0.08 - from_s) / 2.0;
    Some(())
}
