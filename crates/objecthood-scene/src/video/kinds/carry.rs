//! Clips in which hands carry things.

use glam::DVec3;

use crate::family::setting::TABLE_M;
use crate::place::Region;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::thing::{self, Palette};
use crate::video::draft::{Draft, FINGER_ROOM_M, REACH, Side};
use crate::video::script::Script;

/// What follows the last deed (s).
const AFTER_S: f64 = 0.4;
const SMALL_M: std::ops::Range<f64> = 0.035..0.075;

/// A thing that a hand can take from above.
pub(super) fn handy(rng: &mut Rng) -> Solid {
    match rng.below(5) {
        0 => thing::can(rng),
        1 => thing::brick(rng),
        2 => {
            let radius = rng.range(0.025..0.04);
            thing::ball(rng, radius)
        }
        3 => thing::pawn(rng),
        _ => block(rng),
    }
}

/// A box that a hand can take, of any paint.
pub(super) fn block(rng: &mut Rng) -> Solid {
    let palette = Palette::any(rng);
    let sides = [rng.range(SMALL_M), rng.range(0.05..0.12), rng.range(0.04..0.13)];
    let paint = palette.paint(rng, 0.4);
    thing::block("box", Role::Object, sides, paint)
}

/// Picks one thing up, carries it and places it elsewhere; sometimes then another one.
pub(super) fn pick(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let thing = handy(rng);
    let first = draft.stand(rng, &thing, REACH)?;
    draft.bystanders(rng, 3);
    let side = draft.near_side(rng, first);
    let hand = draft.add_hand(rng, side, 0.1..0.6);
    carry_elsewhere(rng, &mut draft, hand, first)?;
    Some(draft.script(AFTER_S))
}

/// A hand carries a thing to a free place of the table and goes.
fn carry_elsewhere(rng: &mut Rng, draft: &mut Draft, hand: usize, thing: usize) -> Option<()> {
    const FAR_M: f64 = 0.12;
    let solid = draft.layout.solids[thing].clone();
    let place = draft.layout.free_place(rng, &solid, REACH, FINGER_ROOM_M)?;
    // Hands turn as far as wrists do.
    let to = Pose { rotation: solid.pose.turned(2, rng.range(-50.0..50.0)).rotation, ..place };
    if (to.origin - solid.pose.origin).length() < FAR_M {
        return None;
    }
    let lift_m = rng.range(0.08..0.22);
    draft.carry(hand, thing, &to, lift_m);
    Some(())
}

/// Two things that look alike are carried past each other.
pub(super) fn twins(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let twin = if rng.chance(0.5) { block(rng) } else { thing::can(rng) };
    let (aside, back, front) = (rng.range(0.14..0.22), rng.range(0.09..0.14), rng.range(0.07..0.12));
    let place = |draft: &Draft, right: f64, near: f64| {
        Pose::at((DVec3::Z * TABLE_M + draft.seen_direction([right, near])).into())
    };
    let corners = [[-aside, -back], [aside, front]];
    for (k, side) in [Side::Left, Side::Right].into_iter().enumerate() {
        let [right, near] = corners[k];
        let pose = place(&draft, right, near);
        let index = draft.layout.stand_at(&twin, [pose.origin.x, pose.origin.y], 0.0)?;
        let hand = draft.add_hand(rng, side, 0.1..0.4);
        let to = place(&draft, -right, near);
        let lift_m = rng.range(0.04..0.10);
        draft.carry(hand, index, &to, lift_m);
    }
    Some(draft.script(AFTER_S))
}

/// Puts one or two boxes on another one.
pub(super) fn stack(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    draft.pace *= 0.7;
    let base = broad(rng);
    let base = draft.stand(rng, &base, REACH)?;
    let count = 1 + rng.below(2);
    let upper: Option<Vec<usize>> = (0..count)
        .map(|_| {
            let solid = low_block(rng);
            draft.stand(rng, &solid, REACH)
        })
        .collect();
    draft.bystanders(rng, 2);
    let upper = upper?;
    let side = draft.near_side(rng, upper[0]);
    let hand = draft.add_hand(rng, side, 0.1..0.5);
    let mut lid = top_of(&draft.layout.solids[base]);
    for &thing in &upper {
        let solid = &draft.layout.solids[thing];
        let to = Pose { rotation: solid.pose.rotation, ..lid };
        let to = to.turned(2, rng.range(-15.0..15.0));
        draft.carry(hand, thing, &to, rng.range(0.06..0.12));
        lid = Pose { origin: to.origin + DVec3::Z * draft.layout.solids[thing].form.height_m, ..lid };
    }
    Some(draft.script(AFTER_S))
}

/// The middle of the lid of a box.
fn top_of(solid: &Solid) -> Pose {
    Pose { origin: solid.pose.point(DVec3::Z * solid.form.height_m), ..solid.pose }
}

/// A box that others can stand on.
fn broad(rng: &mut Rng) -> Solid {
    let sides = [rng.range(0.09..0.15), rng.range(0.09..0.15), rng.range(0.04..0.09)];
    let paint = Palette::any(rng).paint(rng, 0.4);
    thing::block("box", Role::Object, sides, paint)
}

/// A box that stands on others well.
pub(super) fn low_block(rng: &mut Rng) -> Solid {
    let sides = [rng.range(0.05..0.075), rng.range(0.05..0.09), rng.range(0.035..0.06)];
    let paint = Palette::any(rng).paint(rng, 0.4);
    thing::block("box", Role::Object, sides, paint)
}

/// Takes one or two boxes from a stack, the upper one first.
pub(super) fn unstack(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    draft.pace *= 0.7;
    let base = broad(rng);
    let mut top = draft.stand(rng, &base, REACH)?;
    let mut upper = Vec::new();
    for _ in 0..1 + rng.below(2) {
        let solid = low_block(rng);
        top = draft.layout.stack(rng, &solid, top)?;
        upper.push(top);
    }
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, top);
    let hand = draft.add_hand(rng, side, 0.1..0.5);
    let mut taken: Vec<Pose> = Vec::new();
    for &thing in upper.iter().rev() {
        let solid = draft.layout.solids[thing].clone();
        let place = draft.layout.free_place(rng, &solid, REACH, FINGER_ROOM_M)?;
        if taken.iter().any(|other| (other.origin - place.origin).length() < 0.20) {
            return None;
        }
        taken.push(place);
        let to = Pose { rotation: solid.pose.rotation, ..place };
        draft.carry(hand, thing, &to, rng.range(0.06..0.12));
    }
    Some(draft.script(AFTER_S))
}

/// Two hands carry different things at the same time, each on its half of the table.
pub(super) fn two_agents(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    for (right, side) in [(-1.0, Side::Left), (1.0, Side::Right)] {
        let middle = draft.seen_direction([0.19 * right, 0.0]);
        let half = Region { center_m: [middle.x, middle.y], half_m: [0.09, 0.15] };
        let solid = handy(rng);
        let thing = draft.stand(rng, &solid, half)?;
        let hand = draft.add_hand(rng, side, 0.1..1.0);
        let place = draft.layout.free_place(rng, &solid, half, FINGER_ROOM_M)?;
        let to = Pose { rotation: draft.layout.solids[thing].pose.rotation, ..place };
        draft.carry(hand, thing, &to, rng.range(0.08..0.18));
    }
    Some(draft.script(AFTER_S))
}

/// A soft toy of two balls is carried to another place.
pub(super) fn soft_toy(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let doll = thing::doll(rng);
    let doll = draft.stand(rng, &doll, REACH)?;
    draft.bystanders(rng, 2);
    let side = draft.near_side(rng, doll);
    let hand = draft.add_hand(rng, side, 0.1..0.6);
    carry_elsewhere(rng, &mut draft, hand, doll)?;
    Some(draft.script(AFTER_S))
}

/// A narrow box before the middle of a long one is taken away.
pub(super) fn occluder(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let palette = Palette::any(rng);
    let long = [rng.range(0.22..0.30), rng.range(0.04..0.06), rng.range(0.05..0.08)];
    let paint = palette.paint(rng, 0.2);
    let long = thing::block("box", Role::Object, long, paint);
    let narrow = [rng.range(0.04..0.055), rng.range(0.04..0.055), rng.range(0.17..0.22)];
    let paint = palette.paint_unlike(rng, 0.3, &paint);
    let narrow = thing::block("box", Role::Object, narrow, paint);

    let across = draft.seen_direction([1.0, 0.0]);
    let yaw_deg = libm::atan2(across.y, across.x).to_degrees();
    let behind = draft.seen_direction([rng.range(-0.08..0.08), -rng.range(0.08..0.13)]);
    draft.layout.stand_at(&long, [behind.x, behind.y], yaw_deg + rng.range(-8.0..8.0))?;
    let before = behind + draft.seen_direction([rng.range(-0.03..0.03), rng.range(0.11..0.15)]);
    let occluder = draft.layout.stand_at(&narrow, [before.x, before.y], yaw_deg)?;
    draft.bystanders(rng, 1);

    let right = rng.pick(&[-1.0, 1.0]);
    let side = if right > 0.0 { Side::Right } else { Side::Left };
    let hand = draft.add_hand(rng, side, 0.5..1.0);
    let away = draft.seen_direction([right * rng.range(0.22..0.28), rng.range(-0.02..0.06)]);
    let from = draft.layout.solids[occluder].pose;
    let to = Pose { origin: from.origin + away, ..from };
    draft.carry(hand, occluder, &to, rng.range(0.03..0.07));
    Some(draft.script(AFTER_S))
}
