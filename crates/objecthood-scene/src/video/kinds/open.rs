//! Clips in which something is opened.

use glam::DVec3;

use crate::family::furniture::board;
use crate::place::Region;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;
use crate::thing::{self, Palette};
use crate::video::draft::{Draft, Side};
use crate::video::hand;
use crate::video::script::{Group, Joint, Script};

const AFTER_S: f64 = 0.5;
const WALL_M: f64 = 0.006;
/// Between parts that slide along each other.
const PLAY_M: f64 = 0.001;

/// A pose on the table whose -y axis points to the camera, about.
fn facing_camera(rng: &mut Rng, draft: &mut Draft, solid: &Solid) -> Option<usize> {
    let across = draft.seen_direction([1.0, 0.0]);
    let yaw_deg = libm::atan2(across.y, across.x).to_degrees() + rng.range(-20.0..20.0);
    let place = draft.seen_direction([rng.range(-0.10..0.10), rng.range(-0.10..0.0)]);
    draft.layout.stand_at(solid, [place.x, place.y], yaw_deg)
}

/// A box with a lid on a hinge at its back, which a hand turns up.
pub(super) fn lid(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let (wide, deep, high) = (rng.range(0.12..0.18), rng.range(0.09..0.13), rng.range(0.06..0.10));
    let paint = Palette::any(rng).paint(rng, 0.1);
    let inner = [wide - 2.0 * WALL_M, deep - 2.0 * WALL_M, high - WALL_M];
    let open = thing::open_box("open-box", inner, WALL_M, paint);
    let body = facing_camera(rng, &mut draft, &open)?;
    let lid = thing::block("lid", Role::Object, [wide, deep, 0.012], paint);
    let lid = draft.layout.stack_flush(&lid, body)?;
    draft.bystanders(rng, 2);
    draft.groups.push(Group { members: vec![body, lid], joint: Joint::Closed });

    let pose = draft.layout.solids[lid].pose;
    let front = pose.point(DVec3::new(0.0, -deep / 2.0, 0.006));
    let hinge = pose.point(DVec3::new(0.0, deep / 2.0, 0.0));
    let side = rng.pick(&[Side::FrontLeft, Side::FrontRight]);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    // Thumb and fingers close on the front edge, from the camera's side.
    let out = -pose.rotation.col(1);
    let z = (out + DVec3::Z * 0.5).normalize();
    let y = pose.rotation.col(0);
    let grip = Pose { rotation: glam::DMat3::from_cols(y.cross(z), y, z), origin: front + z * 0.012 };
    let pace = draft.pace;
    let path = draft.path(hand);
    path.grip(0.05, 0.04);
    path.go(0.8 * pace, Pose { origin: grip.origin + z * 0.08, ..grip });
    path.go(0.3 * pace, grip);
    path.grip(0.15, 0.012);
    let from_s = path.end_s();
    path.swing(1.2 * pace, hinge, -pose.rotation.col(0), rng.range(50.0..86.0));
    path.wait(0.1);
    let to_s = path.end_s();
    path.grip(0.15, 0.05);
    let back = path.end().pose.rotation.col(2) * 0.08;
    path.shift(0.3 * pace, back);
    let home = path.at(0.0).pose;
    path.go(0.8 * pace, home);
    draft.hold(hand, lid, from_s);
    let hold = draft.last_hold(hand)?;
    (hold.to_s, hold.stays) = (to_s, true);
    Some(draft.script(AFTER_S))
}

/// A small chest whose drawer a hand pulls out by its knob.
pub(super) fn drawer(rng: &mut Rng) -> Option<Script> {
    let mut draft = Draft::new(rng);
    let sides = [rng.range(0.12..0.17), rng.range(0.11..0.15), rng.range(0.07..0.10)];
    let paint = Palette::any(rng).paint(rng, 0.0);
    let chest = chest(sides, paint);
    let body = facing_camera(rng, &mut draft, &chest)?;
    let drawer = drawer_of(sides, Paint::plain(paint.base.map(|c| (c * 1.1).min(0.85))));
    let pose = draft.layout.solids[body].pose;
    let origin = pose.point(DVec3::Z * WALL_M);
    let drawer = draft.layout.insert(drawer.at(Pose { origin, ..pose }), body);
    let region = Region { center_m: [0.0, 0.16], half_m: [0.30, 0.08] };
    for _ in 0..rng.below(3) {
        let thing = crate::family::tables::any(rng);
        draft.stand(rng, &thing, region);
    }
    draft.groups.push(Group { members: vec![body, drawer], joint: Joint::Closed });

    let out = -pose.rotation.col(1);
    let knob = pose.point(DVec3::new(0.0, -sides[1] / 2.0 - 0.014, sides[2] / 2.0));
    let side = rng.pick(&[Side::FrontLeft, Side::FrontRight]);
    let hand = draft.add_hand(rng, side, 0.2..0.6);
    // Thumb and fingers close on the knob from both sides, the wrist towards the camera.
    let (sin, cos) = libm::sincos(f64::to_radians(35.0));
    let z = out * cos + DVec3::Z * sin;
    let x = pose.rotation.col(0);
    let grip = Pose { rotation: glam::DMat3::from_cols(x, z.cross(x), z), origin: knob + z * hand::FINGER_M };
    let pace = draft.pace;
    let path = draft.path(hand);
    path.grip(0.05, 0.05);
    path.go(0.8 * pace, Pose { origin: grip.origin + z * 0.07, ..grip });
    path.go(0.3 * pace, grip);
    path.grip(0.15, 0.016);
    let from_s = path.end_s();
    path.shift(0.9 * pace, out * rng.range(0.045..0.08));
    path.wait(0.1);
    let to_s = path.end_s();
    path.grip(0.15, 0.05);
    path.shift(0.3 * pace, z * 0.07);
    let home = path.at(0.0).pose;
    path.go(0.8 * pace, home);
    draft.hold(hand, drawer, from_s);
    let hold = draft.last_hold(hand)?;
    (hold.to_s, hold.stays) = (to_s, true);
    Some(draft.script(AFTER_S))
}

/// Bottom, top, sides and back; open towards -y.
fn chest([wide, deep, high]: [f64; 3], paint: Paint) -> Solid {
    let mut chest = thing::block("chest", Role::Object, [wide, deep, high], paint);
    chest.parts = vec![
        board([wide, deep, WALL_M], [0.0, 0.0, WALL_M / 2.0], paint),
        board([wide, deep, WALL_M], [0.0, 0.0, high - WALL_M / 2.0], paint),
        board([wide, WALL_M, high], [0.0, (deep - WALL_M) / 2.0, high / 2.0], paint),
    ];
    for side in [-1.0, 1.0] {
        let middle = [side * (wide - WALL_M) / 2.0, 0.0, high / 2.0];
        chest.parts.push(board([WALL_M, deep, high], middle, paint));
    }
    chest
}

/// What fits into the chest, its front in the plane of that one's; the origin is below its middle.
fn drawer_of([wide, deep, high]: [f64; 3], paint: Paint) -> Solid {
    let inset = 2.0 * (WALL_M + PLAY_M);
    let (wide, tall, long) = (wide - inset, high - inset, deep - WALL_M - PLAY_M);
    let mut drawer = thing::block("drawer", Role::Object, [wide, long, tall], paint);
    let middle_y = -(WALL_M + PLAY_M) / 2.0;
    let (front_y, back_y) = (middle_y - long / 2.0 + WALL_M / 2.0, middle_y + long / 2.0 - WALL_M / 2.0);
    let low = tall * 0.7;
    drawer.parts = vec![
        board([wide, long, WALL_M], [0.0, middle_y, WALL_M / 2.0], paint),
        board([wide, WALL_M, tall], [0.0, front_y, tall / 2.0], paint),
        board([wide, WALL_M, low], [0.0, back_y, low / 2.0], paint),
        board(
            [0.012, 0.022, 0.012],
            [0.0, front_y - WALL_M / 2.0 - 0.011, tall / 2.0],
            Paint::plain([0.4; 3]),
        ),
    ];
    for side in [-1.0, 1.0] {
        let middle = [side * (wide - WALL_M) / 2.0, middle_y, low / 2.0];
        drawer.parts.push(board([WALL_M, long, low], middle, paint));
    }
    drawer
}
