//! Someone who walks by.

use glam::DVec3;

use crate::family::bodies;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Role, Solid};

/// A person who walks along a line with a constant speed, swinging legs.
#[derive(Clone, Debug)]
pub(crate) struct Walker {
    body: Solid,
    from: DVec3,
    velocity: DVec3,
    /// Parts that swing about the hips: index, and which way first.
    legs: Vec<(usize, f64)>,
}

/// Length of a double step (m) and how far legs swing to both sides.
const STRIDE_M: f64 = 1.3;
const SWING_DEG: f64 = 20.0;

impl Walker {
    /// Walks on the floor from `from` with a horizontal velocity (m/s).
    pub(crate) fn new(rng: &mut Rng, from: DVec3, velocity: DVec3) -> Self {
        let body = Solid { role: Role::Agent, ..bodies::person(rng) };
        Self { body, from, velocity, legs: bodies::LEG_PARTS.to_vec() }
    }

    /// The person at a time.
    pub(crate) fn solid(&self, time_s: f64) -> Solid {
        let mut body = self.body.clone();
        let walked = self.velocity * time_s;
        let phase = std::f64::consts::TAU * walked.length() / STRIDE_M;
        let swing = SWING_DEG * libm::sin(phase);
        for &(part, side) in &self.legs {
            let part = &mut body.parts[part];
            let hips = Pose::at([0.0, 0.0, bodies::HIPS_M]).turned(0, side * swing);
            let down = Pose::at([0.0, 0.0, -bodies::HIPS_M]);
            part.pose = hips.after(&down).after(&part.pose);
        }
        body.at(self.pose(time_s))
    }

    /// Where the person stands at a time.
    pub(crate) fn pose(&self, time_s: f64) -> Pose {
        let heading = libm::atan2(self.velocity.y, self.velocity.x).to_degrees();
        // The body faces its own +y.
        Pose::at((self.from + self.velocity * time_s).into()).turned(2, heading - 90.0)
    }
}
