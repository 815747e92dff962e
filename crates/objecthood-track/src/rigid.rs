//! Rigid motions.

use glam::{DMat3, DQuat, DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// A rotation, then a translation (m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rigid {
    rotation: DQuat,
    translation: DVec3,
}

impl Rigid {
    /// The motion that leaves everything where it is.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// From a quaternion x, y, z, w of any length except 0, and a translation (m). `None` if they are not
    /// finite.
    pub fn new(rotation_xyzw: [f64; 4], translation_m: [f64; 3]) -> Option<Self> {
        let (quaternion, translation) = (DQuat::from_array(rotation_xyzw), DVec3::from(translation_m));
        let length = quaternion.length();
        let is_sound = length.is_finite() && length > 0.0 && translation.is_finite();
        is_sound.then(|| Self { rotation: quaternion.normalize(), translation })
    }

    /// The rotation as a unit quaternion x, y, z, w.
    pub fn rotation_xyzw(&self) -> [f64; 4] {
        self.rotation.to_array()
    }

    /// The translation (m).
    pub fn translation_m(&self) -> [f64; 3] {
        self.translation.to_array()
    }

    /// The angle of the rotation (rad).
    pub fn angle_rad(&self) -> f64 {
        let DQuat { x, y, z, w } = self.rotation;
        2.0 * libm::atan2((x * x + y * y + z * z).sqrt(), w.abs())
    }

    /// Where it maps a point (m).
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    pub(crate) fn direction(&self, d: DVec3) -> DVec3 {
        self.rotation * d
    }

    /// The composition: first the other, then this one.
    pub(crate) fn after(&self, first: &Self) -> Self {
        let rotation = (self.rotation * first.rotation).normalize();
        Self { rotation, translation: self.rotation * first.translation + self.translation }
    }

    /// The inverse.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// The same motion in the frame of coordinates to which another motion maps: its rotation only.
    pub(crate) fn turn_seen_from(&self, world: &Self) -> DQuat {
        (world.rotation * self.rotation * world.rotation.inverse()).normalize()
    }

    /// From a rotation and a translation (m).
    pub(crate) fn of(rotation: DQuat, translation: DVec3) -> Self {
        Self { rotation, translation }
    }

    /// A small step: turns about `center` by `turn` (rad, along the axis), then moves by `shift` (m).
    pub(crate) fn step(turn: DVec3, shift: DVec3, center: DVec3) -> Self {
        let half = 0.5 * turn;
        let rotation = DQuat::from_xyzw(half.x, half.y, half.z, 1.0).normalize();
        Self { rotation, translation: center + shift - rotation * center }
    }

    pub(crate) fn matrix(&self) -> DMat3 {
        DMat3::from_quat(self.rotation)
    }

    /// How far it moves a point (m).
    pub(crate) fn displacement_m(&self, p: DVec3) -> f64 {
        (self.point(p) - p).length()
    }
}

/// A point or direction in double precision.
pub(crate) fn wide(p: [f32; 3]) -> DVec3 {
    Vec3::from(p).as_dvec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_and_its_inverse_cancel() {
        let a = Rigid::new([0.1, -0.2, 0.3, 0.9], [0.5, 1.0, -2.0]).unwrap();
        let p = DVec3::new(0.3, -0.7, 1.9);
        assert!((a.inverse().point(a.point(p)) - p).length() < 1e-12);
        assert!((a.after(&a.inverse()).point(p) - p).length() < 1e-12);
        assert!(Rigid::new([0.0; 4], [0.0; 3]).is_none() && Rigid::new([f64::NAN; 4], [0.0; 3]).is_none());
    }

    #[test]
    fn a_step_turns_about_its_center() {
        let center = DVec3::new(1.0, 2.0, 3.0);
        let step = Rigid::step(DVec3::Z * 0.01, DVec3::ZERO, center);
        assert!(step.displacement_m(center) < 1e-15);
        assert!((step.angle_rad() - 0.01).abs() < 1e-6);
    }
}
