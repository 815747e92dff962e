//! A straight piece of a profile, turned: disc, ring, cylinder or cone.

use glam::DVec3;

use super::{place, roots};
use crate::ray::{Hit, Ray};

#[derive(Clone, Debug)]
pub(super) struct Frustum {
    /// (r, z) of its ends.
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    /// Length of the profile before it (m).
    pub(super) along: f64,
}

impl Frustum {
    pub(super) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        let ([r0, z0], [r1, z1]) = (self.from, self.to);
        let candidates = if z0 == z1 {
            [(ray.direction.z != 0.0).then(|| (z0 - ray.origin.z) / ray.direction.z), None]
        } else {
            // r = r0 + slope (z - z0), squared.
            let slope = (r1 - r0) / (z1 - z0);
            let (o, d) = (ray.origin, ray.direction);
            let (radius, growth) = (r0 + slope * (o.z - z0), slope * d.z);
            roots(
                d.x * d.x + d.y * d.y - growth * growth,
                o.x * d.x + o.y * d.y - radius * growth,
                o.x * o.x + o.y * o.y - radius * radius,
            )
        };
        let t = candidates.into_iter().flatten().find(|&t| t > after && self.reaches(ray.at(t)))?;
        let point = ray.at(t);
        let (dr, dz) = (r1 - r0, z1 - z0);
        let r = libm::hypot(point.x, point.y);
        let outward = if r > 0.0 {
            DVec3::new(point.x / r * dz, point.y / r * dz, -dr)
        } else {
            DVec3::new(0.0, 0.0, -dr)
        };
        let uv_m = if dz == 0.0 {
            [point.x, point.y]
        } else {
            place(point, r0.max(r1), self.along + libm::hypot(r - r0, point.z - z0))
        };
        Some(Hit { t, normal: outward.normalize_or(DVec3::Z), uv_m, surface: 0 })
    }

    /// Whether a point of the endless disc or cone is on this piece of it.
    fn reaches(&self, point: DVec3) -> bool {
        let ([r0, z0], [r1, z1]) = (self.from, self.to);
        if z0 == z1 {
            let square = point.x * point.x + point.y * point.y;
            let (low, high) = (r0.min(r1), r0.max(r1));
            low * low <= square && square <= high * high
        } else {
            z0.min(z1) <= point.z && point.z <= z0.max(z1)
        }
    }

    pub(super) fn support(&self, sideways: f64, up: f64) -> f64 {
        let reach = |[r, z]: [f64; 2]| r * sideways + z * up;
        reach(self.from).max(reach(self.to))
    }
}
