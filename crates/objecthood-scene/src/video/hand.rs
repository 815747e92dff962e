//! A hand with its arm, made of bars with round ends.

use glam::DVec3;

use super::path::{Path, Posture};
use crate::family::furniture::bar;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};
use crate::texture::Paint;
use crate::thing;

/// Radius of a finger (m).
pub(crate) const FINGER_M: f64 = 0.0085;
/// How far the tips of the fingers reach below the middle of the grip (m).
pub(crate) const TIP_M: f64 = 0.022;
/// Free height between the middle of the grip and the palm (m).
pub(crate) const PALM_M: f64 = 0.050;
/// Places of three fingers across the palm (m); the thumb is opposite to the middle one.
const FINGERS_M: [f64; 3] = [-0.022, 0.0, 0.022];
const KNUCKLES_M: f64 = 0.030;
const PALM_RADIUS_M: f64 = 0.014;
const WRIST_M: f64 = 0.085;
/// Wrist, forearm and sleeve are the last parts.
const ARM_PARTS: usize = 3;
/// Length of the bare forearm and of the sleeve behind it (m): long enough to go out of any image.
const FOREARM_M: f64 = 0.17;
const SLEEVE_M: f64 = 0.85;

/// A hand that moves along a path. Its own frame: the origin in the middle between the pads of thumb and fingers, x from
/// thumb to fingers, z to the palm and the wrist.
#[derive(Clone, Debug)]
pub(crate) struct Hand {
    /// Where the arm comes from (m): it always points there.
    pub(crate) shoulder: DVec3,
    pub(crate) path: Path,
    /// Whether things that it meets give way to it.
    pub(crate) pushes: bool,
    skin: Paint,
    sleeve: Paint,
}

impl Hand {
    pub(crate) fn new(rng: &mut Rng, shoulder: DVec3, start: Posture) -> Self {
        let skin = Paint::plain(rng.pick(&[[0.55, 0.36, 0.27], [0.28, 0.16, 0.10], [0.62, 0.45, 0.36]]));
        let cloths = [[0.5, 0.1, 0.1], [0.1, 0.2, 0.45], [0.55, 0.55, 0.53], [0.15, 0.3, 0.15], [0.07; 3]];
        let sleeve = Paint::plain(rng.pick(&cloths));
        Self { shoulder, path: Path::from(start), pushes: false, skin, sleeve }
    }

    /// The hand without its arm, as it is at first: what things give way to.
    pub(crate) fn blunt(&self) -> Solid {
        let mut hand = self.solid(0.0);
        hand.parts.truncate(hand.parts.len() - ARM_PARTS);
        hand
    }

    /// The hand and its arm at a time.
    pub(crate) fn solid(&self, time_s: f64) -> Solid {
        let Posture { pose, opening_m } = self.path.at(time_s);
        let mut hand = thing::block("hand", Role::Agent, [0.09, 0.09, 0.1], self.skin);
        hand.parts.clear();
        let knuckle_z = PALM_M + PALM_RADIUS_M;
        for y in [-0.03, -0.01, 0.01, 0.03] {
            let ends = [-KNUCKLES_M, KNUCKLES_M].map(|x| [x, y, knuckle_z]);
            hand.parts.push(bar(PALM_RADIUS_M, ends[0], ends[1], self.skin));
        }
        let pad = opening_m / 2.0 + FINGER_M;
        let middle = (pad + 0.010).max(KNUCKLES_M);
        for (side, y) in FINGERS_M.map(|y| (1.0, y)).into_iter().chain([(-1.0, 0.0)]) {
            let joints = [[KNUCKLES_M, knuckle_z], [middle, 0.028], [pad, FINGER_M - TIP_M]]
                .map(|[x, z]| [side * x, y, z]);
            hand.parts.push(bar(FINGER_M, joints[0], joints[1], self.skin));
            hand.parts.push(bar(FINGER_M, joints[1], joints[2], self.skin));
        }
        let wrist = DVec3::Z * WRIST_M;
        let to_shoulder = pose.own_direction(self.shoulder - pose.point(wrist)).normalize_or(DVec3::Z);
        let (cuff, end) = (wrist + to_shoulder * FOREARM_M, wrist + to_shoulder * (FOREARM_M + SLEEVE_M));
        hand.parts.push(bar(0.024, [0.0, 0.0, knuckle_z], wrist.into(), self.skin));
        hand.parts.push(bar(0.026, wrist.into(), cuff.into(), self.skin));
        hand.parts.push(bar(0.040, cuff.into(), end.into(), self.sleeve));
        hand.at(pose)
    }
}

/// A pose with the fingers pointing down and closing along a horizontal direction.
pub(crate) fn from_above(origin: DVec3, closing: DVec3) -> Pose {
    let x = DVec3::new(closing.x, closing.y, 0.0).normalize_or(DVec3::X);
    Pose { rotation: glam::DMat3::from_cols(x, DVec3::Z.cross(x), DVec3::Z), origin }
}

/// A pose whose fingertips touch a point and point along a horizontal direction, the wrist raised.
pub(crate) fn pushing(point: DVec3, along: DVec3) -> Pose {
    const RAISED_DEG: f64 = 32.0;
    let (sin, cos) = libm::sincos(f64::to_radians(RAISED_DEG));
    let along = DVec3::new(along.x, along.y, 0.0).normalize_or(DVec3::X);
    let z = DVec3::Z * sin - along * cos;
    // Thumb below, fingers above.
    let y = along.cross(DVec3::Z);
    Pose { rotation: glam::DMat3::from_cols(y.cross(z), y, z), origin: point + z * TIP_M }
}
