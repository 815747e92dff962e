//! Where something stands and how it is turned.

use glam::{DMat3, DQuat, DVec3};

use crate::ray::Ray;

/// A rigid motion: takes points of a thing's own frame to the frame that it stands in.
///
/// Sines come from `libm`, so that a pose is the same on every machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub(crate) rotation: DMat3,
    pub(crate) origin: DVec3,
}

impl Pose {
    /// Not turned, its origin at `origin_m`.
    pub fn at(origin_m: [f64; 3]) -> Self {
        Self { rotation: DMat3::IDENTITY, origin: origin_m.into() }
    }

    /// That of a camera (x right, y down, z forward) at `eye_m` which looks at `target_m` and is held level; straight
    /// down its right is the world's x.
    pub fn looking_at(eye_m: [f64; 3], target_m: [f64; 3]) -> Self {
        let origin = DVec3::from(eye_m);
        let forward = (DVec3::from(target_m) - origin).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(DVec3::Z).normalize_or(DVec3::X);
        Self { rotation: DMat3::from_cols(right, forward.cross(right), forward), origin }
    }

    /// At `origin_m`, its z axis along a direction; how it is turned about that is of no matter.
    pub(crate) fn along(origin_m: [f64; 3], direction: [f64; 3]) -> Self {
        let z = DVec3::from(direction).normalize_or(DVec3::Z);
        let (x, y) = z.any_orthonormal_pair();
        Self { rotation: DMat3::from_cols(x, y, z), origin: origin_m.into() }
    }

    /// Turned by the angle about axis 0, 1 or 2 of its own frame (counterclockwise seen against the axis).
    #[must_use]
    pub fn turned(self, axis: usize, angle_deg: f64) -> Self {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let mut columns = [[0.0; 3]; 3];
        let (a, b, c) = (axis % 3, (axis + 1) % 3, (axis + 2) % 3);
        columns[a][a] = 1.0;
        (columns[b][b], columns[b][c]) = (cos, sin);
        (columns[c][b], columns[c][c]) = (-sin, cos);
        Self { rotation: self.rotation * DMat3::from_cols_array_2d(&columns), ..self }
    }

    /// Where its origin lies (m).
    pub fn origin_m(&self) -> [f64; 3] {
        self.origin.into()
    }

    /// How it is turned, as a unit quaternion x, y, z, w.
    pub fn rotation_xyzw(&self) -> [f64; 4] {
        DQuat::from_mat3(&self.rotation).to_array()
    }

    /// From its own frame to the outer one.
    pub(crate) fn point(&self, own: DVec3) -> DVec3 {
        self.rotation * own + self.origin
    }

    /// The motion back.
    pub(crate) fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, origin: -(rotation * self.origin) }
    }

    /// From the outer frame to its own.
    pub(crate) fn inverse_point(&self, outer: DVec3) -> DVec3 {
        self.rotation.transpose() * (outer - self.origin)
    }

    /// A direction of the outer frame in its own.
    pub(crate) fn own_direction(&self, outer: DVec3) -> DVec3 {
        self.rotation.transpose() * outer
    }

    /// A ray of the outer frame in its own; lengths along it stay the same.
    pub(crate) fn own_ray(&self, ray: Ray) -> Ray {
        let back = self.rotation.transpose();
        Ray { origin: back * (ray.origin - self.origin), direction: back * ray.direction }
    }

    /// First `inner`, then this.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        Self { rotation: self.rotation * inner.rotation, origin: self.point(inner.origin) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_is_counterclockwise() {
        let near = |a: DVec3, b: [f64; 3]| assert!((a - DVec3::from(b)).length() < 1e-15, "{a} {b:?}");
        for (axis, from, to) in
            [(2, DVec3::X, [1.0, 3.0, 3.0]), (0, DVec3::Y, [1.0, 2.0, 4.0]), (1, DVec3::Z, [2.0, 2.0, 3.0])]
        {
            near(Pose::at([1.0, 2.0, 3.0]).turned(axis, 90.0).point(from), to);
        }
    }

    #[test]
    fn a_camera_looks_at_its_target_and_is_level() {
        for eye in [[1.0, -2.0, 0.5], [0.3, 0.4, 2.0], [0.3, 0.4, -1.0], [-1.0, 0.4, 0.5]] {
            let target = DVec3::new(0.3, 0.4, 0.5);
            let pose = Pose::looking_at(eye, target.into());
            let [right, down, forward] = [0, 1, 2].map(|k| pose.rotation.col(k));
            let way = target - DVec3::from(eye);
            assert!((forward * way.length() - way).length() < 1e-15);
            assert!(right.z.abs() < 1e-15 && down.z <= 0.0 && (right.cross(down) - forward).length() < 1e-15);
            assert!((pose.rotation.determinant() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_pose_along_a_direction_is_a_rotation() {
        for direction in [[0.0, 0.0, 2.0], [0.0, 0.0, -1.0], [0.3, -0.4, 0.1]] {
            let pose = Pose::along([1.0, 2.0, 3.0], direction);
            let tip = pose.point(DVec3::Z) - DVec3::new(1.0, 2.0, 3.0);
            assert!((tip - DVec3::from(direction).normalize()).length() < 1e-12);
            assert!((pose.rotation.determinant() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_ray_keeps_its_length() {
        let pose = Pose::at([1.0, -2.0, 0.5]).turned(0, 30.0).turned(2, 50.0);
        let ray = Ray { origin: DVec3::new(0.1, 0.2, 0.3), direction: DVec3::new(1.0, 2.0, -1.0) };
        let own = pose.own_ray(ray);
        assert!((pose.point(own.at(0.7)) - ray.at(0.7)).length() < 1e-14);
    }
}
