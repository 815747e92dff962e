//! What the parameters say about the camera's attitude.

use crate::params::Gravity;

impl Gravity {
    /// The camera's own up, from `tilt_deg` and `roll_deg`: a unit vector in the camera frame, -y when the camera is held horizontally.
    pub fn camera_up(&self) -> [f32; 3] {
        let (sin_tilt, cos_tilt) = libm::sincos(self.tilt_deg.to_radians());
        let (sin_roll, cos_roll) = libm::sincos(self.roll_deg.to_radians());
        // Adding 0 turns a negative zero into zero.
        [-sin_roll * cos_tilt, -cos_roll * cos_tilt, -sin_tilt].map(|x| (x + 0.0) as f32)
    }

    /// Whether the user said how the camera is held.
    pub(crate) fn is_attitude_given(&self) -> bool {
        self.tilt_deg != 0.0 || self.roll_deg != 0.0
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn the_camera_may_look_down_and_be_rolled() {
        let half = 0.5_f32.sqrt();
        for (tilt_deg, roll_deg, expected) in [
            (0.0, 0.0, [0.0, -1.0, 0.0]),
            (45.0, 0.0, [0.0, -half, -half]),
            (90.0, 30.0, [0.0, 0.0, -1.0]),
            (0.0, 180.0, [0.0, 1.0, 0.0]),
            // The camera's right points down.
            (0.0, 90.0, [-1.0, 0.0, 0.0]),
            (45.0, -90.0, [half, 0.0, -half]),
        ] {
            let up = Gravity { tilt_deg, roll_deg, ..Default::default() }.camera_up();
            let error = Vec3::from(up).distance(Vec3::from(expected));
            assert!(error < 1e-6, "{tilt_deg} {roll_deg}: {up:?}");
        }
        let level = Gravity::default().camera_up();
        assert_eq!(level.map(f32::to_bits), [0.0_f32, -1.0, 0.0].map(f32::to_bits));
    }
}
