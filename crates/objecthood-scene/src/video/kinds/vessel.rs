//! Clips with vessels and what lies in them.

use glam::DVec3;

use crate::place::Region;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Cavity, Outline, Solid};
use crate::thing;
use crate::video::draft::{Draft, FINGER_ROOM_M, Grasp, REACH};
use crate::video::hand::{self, FINGER_M};
use crate::video::script::Script;

const AFTER_S: f64 = 0.5;

/// How the rim of a bowl is taken: the thumb inside, the fingers outside, on the side of the hand.
fn rim_grasp(draft: &mut Draft, hand: usize, bowl: usize) -> Option<Grasp> {
    let shoulder = draft.hand(hand).shoulder;
    let solid = &draft.layout.solids[bowl];
    let Outline::Disc { radius_m } = solid.form.outline else { return None };
    let toward = shoulder - solid.pose.origin;
    let toward = DVec3::new(toward.x, toward.y, 0.0).normalize_or(DVec3::X);
    let width_m = 0.010;
    // Tips reach a little below the rim.
    let origin =
        solid.pose.origin + toward * (radius_m - width_m / 2.0) + DVec3::Z * (solid.form.height_m + FINGER_M);
    Some(Grasp { pose: hand::from_above(origin, toward), width_m })
}

/// A bowl with one or two balls in it is carried to another place.
pub(super) fn bowl(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let outer = rng.range(0.075..0.10);
    let bowl = thing::bowl_of(rng, outer);
    let index = draft.stand(rng, &bowl, REACH)?;
    let radius = rng.range(0.022..0.032);
    let ball = thing::ball(rng, radius);
    draft.layout.fill(rng, &ball, index)?;
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, index);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    let place = draft.layout.free_place(rng, &bowl, REACH, FINGER_ROOM_M)?;
    let from = draft.layout.solids[index].pose;
    let to = Pose { rotation: from.rotation, ..place };
    if (to.origin - from.origin).length() < 0.15 {
        return None;
    }
    let grasp = rim_grasp(&mut draft, hand, index)?;
    draft.pace = draft.pace.max(0.9);
    draft.take(hand, index, grasp);
    let lift_m = rng.range(0.05..0.12);
    draft.bring(hand, grasp, &from, &to, lift_m);
    draft.let_go(hand);
    draft.withdraw(hand);
    Some(draft.script(AFTER_S))
}

/// A ball is let fall into a bowl from its rim, or something is set down on a plate and sometimes taken away again.
pub(super) fn put_in(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    draft.pace *= 0.8;
    if rng.chance(0.5) {
        into_bowl(rng, &mut draft)?;
    } else {
        onto_plate(rng, &mut draft)?;
    }
    Some(draft.script(AFTER_S))
}

fn into_bowl(rng: &mut Rng, draft: &mut Draft) -> Option<()> {
    let outer = rng.range(0.085..0.105);
    let bowl = thing::bowl_of(rng, outer);
    let vessel = draft.stand(rng, &bowl, REACH)?;
    let radius = rng.range(0.022..0.030);
    let ball = thing::ball(rng, radius);
    let ball = draft.stand(rng, &ball, REACH)?;
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, ball);
    let hand = draft.add_hand(rng, side, 0.1..0.5);
    let from = draft.layout.solids[ball].pose;
    // Fingers stay above the rim.
    let origin = draft.layout.solids[vessel].pose.point(DVec3::Z * (bowl.form.height_m + 0.004));
    let grasp = draft.grasp(ball);
    draft.take(hand, ball, grasp);
    draft.bring(hand, grasp, &from, &Pose { origin, ..from }, rng.range(0.06..0.12));
    draft.let_go(hand);
    draft.withdraw(hand);
    Some(())
}

fn onto_plate(rng: &mut Rng, draft: &mut Draft) -> Option<()> {
    let plate = thing::plate(rng);
    let vessel = draft.stand(rng, &plate, REACH)?;
    let solid = super::carry::low_block(rng);
    let thing = draft.stand(rng, &solid, REACH)?;
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, thing);
    let hand = draft.add_hand(rng, side, 0.1..0.5);
    let Cavity::Flat { floor_z, .. } = plate.form.cavity? else { return None };
    let from = draft.layout.solids[thing].pose;
    let inside = Pose { origin: draft.layout.solids[vessel].pose.point(DVec3::Z * floor_z), ..from };
    let grasp = draft.grasp(thing);
    draft.take(hand, thing, grasp);
    draft.bring(hand, grasp, &from, &inside, rng.range(0.06..0.12));
    draft.let_go(hand);
    if rng.chance(0.5) {
        let (pace, place) = (draft.pace, draft.layout.free_place(rng, &solid, REACH, FINGER_ROOM_M)?);
        let path = draft.path(hand);
        path.wait(0.6 * pace);
        path.grip(0.15 * pace, grasp.width_m);
        let from_s = path.end_s();
        draft.hold(hand, thing, from_s);
        let to = Pose { rotation: from.rotation, ..place };
        let held = Grasp { pose: inside.after(&from.inverse().after(&grasp.pose)), ..grasp };
        draft.bring(hand, held, &inside, &to, rng.range(0.06..0.12));
        draft.let_go(hand);
    }
    draft.withdraw(hand);
    Some(())
}

/// A cup with two or three balls is lifted and tilted until they have rolled out.
pub(super) fn pour(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    draft.pace = draft.pace.clamp(0.8, 1.1);
    let region = Region { half_m: [0.12, 0.10], ..REACH };
    let cup = thing::cup(rng);
    let index = draft.stand(rng, &cup, region)?;
    fill_with_balls(rng, &mut draft, index)?;
    let side = draft.near_side(rng, index);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    let shoulder = draft.hand(hand).shoulder;
    let place = draft.layout.solids[index].pose.origin;
    let out = DVec3::new(shoulder.x - place.x, shoulder.y - place.y, 0.0).normalize_or(DVec3::X);
    // The cup is taken from the side, thumb and fingers around it.
    let across = DVec3::Z.cross(out);
    let (sin, cos) = libm::sincos(f64::to_radians(20.0));
    let z = out * cos + DVec3::Z * sin;
    let Outline::Disc { radius_m } = cup.form.outline else { return None };
    let origin = place + DVec3::Z * cup.form.height_m * 0.55 + z * 0.002;
    let pose = Pose { rotation: glam::DMat3::from_cols(across, z.cross(across), z), origin };
    let pace = draft.pace;
    let path = draft.path(hand);
    path.grip(0.05, 2.0 * radius_m + 0.03);
    path.go(0.8 * pace, Pose { origin: pose.origin + z * 0.13, ..pose });
    path.go(0.35 * pace, pose);
    path.grip(0.18 * pace, 2.0 * radius_m);
    let from_s = path.end_s();
    path.shift(0.6 * pace, DVec3::Z * rng.range(0.05..0.09));
    // Across the arm, so that nothing rolls towards the hand.
    let axis = out * rng.pick(&[-1.0, 1.0]);
    let pivot = path.end().pose.origin;
    let angle_deg = rng.range(115.0..135.0);
    path.swing(0.9 * pace, pivot, axis, angle_deg);
    path.wait(0.4);
    path.swing(0.7 * pace, pivot, axis, -angle_deg);
    let down = place - draft.layout.solids[index].pose.origin;
    let path = draft.path(hand);
    path.shift(0.5 * pace, down + DVec3::Z * (pose.origin.z - path.end().pose.origin.z));
    draft.hold(hand, index, from_s);
    draft.let_go(hand);
    let path = draft.path(hand);
    path.shift(0.3 * pace, z * 0.12);
    let home = path.at(0.0).pose;
    path.go(0.7 * pace, home);
    Some(draft.script(AFTER_S))
}

/// Balls on each other in a cup, each leaning on its wall.
fn fill_with_balls(rng: &mut Rng, draft: &mut Draft, cup: usize) -> Option<()> {
    let vessel: Solid = draft.layout.solids[cup].clone();
    let Cavity::Flat { floor_z, radius_m } = vessel.form.cavity? else { return None };
    // Two to a layer do not fit: each lies on the last one, in the opposite corner.
    let radius = radius_m * rng.range(0.62..0.72);
    let aside = radius_m - radius - 0.0008;
    let rise = 2.0 * (radius * radius - aside * aside).sqrt() + 0.0003;
    for k in 0..2 {
        let z = floor_z + rise * f64::from(k);
        if z + 1.2 * radius > vessel.form.height_m {
            break;
        }
        let side = [-1.0, 1.0][k as usize % 2];
        let ball = thing::ball(rng, radius);
        let origin = vessel.pose.point(DVec3::new(side * aside, 0.0, z));
        draft.layout.insert(ball.at(Pose { origin, ..vessel.pose }), cup);
    }
    Some(())
}
