//! Where one frame of reference lies in another.

use glam::{DQuat, DVec3};

/// A rotation and a translation: p of the one frame is at rotation · p + translation in the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rigid {
    pub(super) rotation: DQuat,
    /// Metres.
    pub(super) translation: DVec3,
}

impl Rigid {
    pub(super) const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// `None` when the numbers are no rigid motion; a quaternion may miss the unit by rounding.
    pub(super) fn new(translation_m: [f64; 3], rotation_xyzw: [f64; 4]) -> Option<Self> {
        /// How far the length of a quaternion that was written with six digits may be from 1, generously.
        const ROUNDING: f64 = 1e-2;
        let (rotation, translation) = (DQuat::from_array(rotation_xyzw), DVec3::from(translation_m));
        let is_unit = (rotation.length() - 1.0).abs() <= ROUNDING;
        (is_unit && translation.is_finite()).then(|| Self { rotation: rotation.normalize(), translation })
    }

    /// First `other`, then this.
    pub(super) fn after(self, other: Self) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.rotation * other.translation + self.translation,
        }
    }

    pub(super) fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    pub(super) fn apply(self, point_m: DVec3) -> DVec3 {
        self.rotation * point_m + self.translation
    }

    /// Whether it moves nothing that a camera would see: by a tenth of a millimetre and 0.006 degrees at most.
    pub(super) fn is_none(self) -> bool {
        const STILL: f64 = 1e-4;
        self.translation.length() <= STILL && self.rotation.angle_between(DQuat::IDENTITY) <= STILL
    }
}
