//! A piece of a circle around the axis, turned: a zone or cap of a sphere.

use glam::DVec3;

use super::{place, roots};
use crate::ray::{Hit, Ray};

#[derive(Clone, Debug)]
pub(super) struct Zone {
    /// (r, z) of its ends.
    from: [f64; 2],
    pub(super) to: [f64; 2],
    center_z: f64,
    radius: f64,
    /// 1 when the solid is inside the sphere, -1 when it is outside.
    side: f64,
    /// Lowest and highest z; without end where the profile meets the axis, because there the sphere ends by itself.
    low_z: f64,
    high_z: f64,
    along: f64,
}

impl Zone {
    pub(super) fn new(from: [f64; 2], to: [f64; 2], center_z: f64, along: f64) -> Self {
        let radius = libm::hypot(from[0], from[1] - center_z);
        // The solid is on the left of the profile: the right side of the chord points out of it.
        let (dr, dz) = (to[0] - from[0], to[1] - from[1]);
        let middle = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0 - center_z];
        let side = (middle[0] * dz - middle[1] * dr).signum();
        let (low, high) = if from[1] < to[1] { (from, to) } else { (to, from) };
        let low_z = if low[0] == 0.0 { f64::NEG_INFINITY } else { low[1] };
        let high_z = if high[0] == 0.0 { f64::INFINITY } else { high[1] };
        Self { from, to, center_z, radius, side, low_z, high_z, along }
    }

    /// Height of the middle and radius of the sphere that it is a piece of.
    pub(super) fn sphere(&self) -> (f64, f64) {
        (self.center_z, self.radius)
    }

    /// Whether this, from the axis on, and `next`, to the axis, are one whole sphere.
    pub(super) fn is_ball_with(&self, next: &Self) -> bool {
        self.from[0] == 0.0 && next.to[0] == 0.0 && self.to == next.from && self.center_z == next.center_z
    }

    /// Appends where it begins and points (r, z) along it, at most `step_deg` apart, without its end.
    pub(super) fn corners(&self, step_deg: f64, corners: &mut Vec<[f64; 2]>) {
        let angle = |[r, z]: [f64; 2]| libm::atan2(z - self.center_z, r);
        let (first, last) = (angle(self.from), angle(self.to));
        let steps = ((last - first).abs().to_degrees() / step_deg).ceil().max(1.0);
        corners.push(self.from);
        for k in 1..steps as usize {
            let (sin, cos) = libm::sincos(first + (last - first) * k as f64 / steps);
            corners.push([self.radius * cos, self.center_z + self.radius * sin]);
        }
    }

    pub(super) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        let from_center = ray.origin - DVec3::Z * self.center_z;
        let candidates = roots(
            ray.direction.length_squared(),
            from_center.dot(ray.direction),
            from_center.length_squared() - self.radius * self.radius,
        );
        let t = candidates.into_iter().flatten().find(|&t| t > after && self.reaches(ray.at(t).z))?;
        let point = ray.at(t);
        let arm = (point - DVec3::Z * self.center_z) / self.radius;
        let along = self.along + self.radius * libm::acos(arm.z.clamp(-1.0, 1.0));
        let uv_m = place(point, self.from[0].max(self.to[0]), along);
        Some(Hit { t, normal: (arm * self.side).normalize_or(DVec3::Z), uv_m, surface: 0 })
    }

    fn reaches(&self, z: f64) -> bool {
        self.low_z <= z && z <= self.high_z
    }

    pub(super) fn support(&self, sideways: f64, up: f64) -> f64 {
        let reach = |[r, z]: [f64; 2]| r * sideways + z * up;
        let length = libm::hypot(sideways, up);
        let farthest_z = self.center_z + self.radius * up / length;
        let ends = reach(self.from).max(reach(self.to));
        if length > 0.0 && self.reaches(farthest_z) {
            ends.max(self.center_z * up + self.radius * length)
        } else {
            ends
        }
    }
}

#[cfg(test)]
impl Zone {
    /// The arc as `n` chords.
    pub(super) fn chords(&self, n: usize) -> Vec<[[f64; 2]; 2]> {
        let angle = |[r, z]: [f64; 2]| libm::atan2(z - self.center_z, r);
        let (first, last) = (angle(self.from), angle(self.to));
        let point = |k: usize| {
            let (sin, cos) = libm::sincos(first + (last - first) * k as f64 / n as f64);
            [self.radius * cos, self.center_z + self.radius * sin]
        };
        (0..n).map(|k| [point(k), point(k + 1)]).collect()
    }
}
