//! How the camera moves.

use glam::DVec3;

use super::path::least_jerk;
use crate::pose::Pose;
use crate::random::Rng;

/// Where the camera is, as a function of time.
#[derive(Clone, Debug)]
pub(super) enum CameraPath {
    /// On a tripod.
    Still(Pose),
    /// In a hand: along an arc about the table, with a slow tremor.
    Carried { eye: DVec3, target: DVec3, arc_deg: f64, rise_m: f64, during_s: f64, tremor: [Wave; 6] },
}

/// A sine: amplitude, periods a second, phase.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    amplitude: f64,
    hz: f64,
    phase: f64,
}

impl Wave {
    fn at(self, time_s: f64) -> f64 {
        self.amplitude * libm::sin(std::f64::consts::TAU * (self.hz * time_s + self.phase))
    }
}

impl CameraPath {
    /// From where the camera is now, around what it looks at.
    pub(super) fn carried(rng: &mut Rng, pose: Pose, target_m: [f64; 3], during_s: f64) -> Self {
        const TREMOR_M: f64 = 0.004;
        let wave = |rng: &mut Rng| Wave {
            amplitude: TREMOR_M * rng.range(0.3..1.0),
            hz: rng.range(0.4..1.6),
            phase: rng.range(0.0..1.0),
        };
        let tremor = [0; 6].map(|_| wave(rng));
        let side = rng.pick(&[-1.0, 1.0]);
        let (arc_deg, rise_m) = (side * rng.range(10.0..35.0), rng.range(-0.08..0.15));
        Self::Carried { eye: pose.origin, target: target_m.into(), arc_deg, rise_m, during_s, tremor }
    }

    /// The pose of the camera at a time.
    pub(super) fn at(&self, time_s: f64) -> Pose {
        match self {
            Self::Still(pose) => *pose,
            Self::Carried { eye, target, arc_deg, rise_m, during_s, tremor } => {
                let share = least_jerk((time_s / during_s).clamp(0.0, 1.0));
                let (sin, cos) = libm::sincos((arc_deg * share).to_radians());
                let out = *eye - *target;
                let out = DVec3::new(out.x * cos - out.y * sin, out.x * sin + out.y * cos, out.z);
                let shake = |k: usize| tremor[k].at(time_s);
                let eye =
                    *target + out + DVec3::Z * rise_m * share + DVec3::new(shake(0), shake(1), shake(2));
                let target = *target + DVec3::new(shake(3), shake(4), shake(5));
                Pose::looking_at(eye.into(), target.into())
            }
        }
    }
}
