//! A piece of a ring with round ends: handles, cables.

use glam::DVec3;

use crate::ray::{Hit, Ray};

/// All points within `minor_m` of an arc in the plane z = 0 around the origin.
///
/// The arc has radius `major_m` and covers the angles up to `half_angle_deg` on both sides of the x axis. One face.
#[derive(Clone, Debug)]
pub(crate) struct TorusArc {
    major_m: f64,
    minor_m: f64,
    half_angle: f64,
    /// The end of the arc at positive y.
    end: [f64; 2],
}

/// Steps along a ray that skims the surface (m). What dips less deep between two steps is not hit.
const FINEST_STEP_M: f64 = 1e-5;

impl TorusArc {
    pub(crate) const SURFACES: usize = 1;

    pub(crate) fn new(major_m: f64, minor_m: f64, half_angle_deg: f64) -> Self {
        let half_angle = half_angle_deg.to_radians();
        let (sin, cos) = libm::sincos(half_angle);
        Self { major_m, minor_m, half_angle, end: [major_m * cos, major_m * sin] }
    }

    /// Points along the middle of the arc, and how far the shape reaches around it (m).
    pub(crate) fn spine(&self, pieces: usize) -> (Vec<DVec3>, f64) {
        let point = |k: usize| {
            let angle = self.half_angle * (2.0 * k as f64 / pieces as f64 - 1.0);
            let (sin, cos) = libm::sincos(angle);
            DVec3::new(cos, sin, 0.0) * self.major_m
        };
        ((0..=pieces).map(point).collect(), self.minor_m)
    }

    /// The point of the arc nearest to `p`. The arc is its own mirror image at the x axis.
    fn nearest(&self, p: DVec3) -> DVec3 {
        let r = libm::hypot(p.x, p.y);
        let inside = self.half_angle >= std::f64::consts::PI || {
            // p lies between the ends when it is on the x side of the ray to the end nearer to it.
            let [x, y] = self.end;
            let across = x * p.y.abs() - y * p.x;
            if self.half_angle <= std::f64::consts::FRAC_PI_2 {
                across <= 0.0 && p.x >= 0.0
            } else {
                across <= 0.0 || p.x >= 0.0
            }
        };
        if inside && r > 0.0 {
            DVec3::new(p.x / r * self.major_m, p.y / r * self.major_m, 0.0)
        } else {
            DVec3::new(self.end[0], self.end[1].copysign(p.y), 0.0)
        }
    }

    /// Signed distance of `p` from the boundary (m), exact.
    fn distance(&self, p: DVec3) -> f64 {
        (p - self.nearest(p)).length() - self.minor_m
    }

    /// Sphere tracing (Hart 1996) up to a change of sign, then bisection.
    pub(crate) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        let speed = ray.direction.length();
        let reach = self.major_m + self.minor_m + 1e-6;
        let along = -ray.origin.dot(ray.direction) / (speed * speed);
        let beside = ray.at(along).length_squared();
        if beside > reach * reach {
            return None;
        }
        let half_chord = (reach * reach - beside).sqrt() / speed;
        let (mut t, end) = (after.max(along - half_chord), along + half_chord);
        let side = self.distance(ray.at(t)).signum();
        let mut last = t;
        loop {
            let distance = self.distance(ray.at(t)) * side;
            if distance < 0.0 {
                let t = self.crossing(ray, last, t, side);
                let point = ray.at(t);
                let normal = (point - self.nearest(point)).normalize_or(DVec3::Z);
                let uv_m = [libm::atan2(point.y, point.x) * self.major_m, point.z];
                return (t > after).then_some(Hit { t, normal, uv_m, surface: 0 });
            }
            if t >= end {
                return None;
            }
            last = t;
            t = (t + distance.max(FINEST_STEP_M) / speed).min(end);
        }
    }

    fn crossing(&self, ray: Ray, mut before: f64, mut behind: f64, side: f64) -> f64 {
        loop {
            let middle = (before + behind) / 2.0;
            if middle <= before || middle >= behind {
                return behind;
            }
            if self.distance(ray.at(middle)) * side < 0.0 {
                behind = middle;
            } else {
                before = middle;
            }
        }
    }

    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        let flat = DVec3::new(direction.x, direction.y, 0.0);
        self.nearest(flat).dot(direction).max(self.end[0] * direction.x + self.end[1] * direction.y.abs())
            + self.minor_m * direction.length()
    }
}

#[cfg(test)]
impl TorusArc {
    /// By angle instead of by sides of lines.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        let (sin, cos) = libm::sincos(libm::atan2(p.y, p.x).clamp(-self.half_angle, self.half_angle));
        (p - DVec3::new(self.major_m * cos, self.major_m * sin, 0.0)).length() < self.minor_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Shape, testing};

    #[test]
    fn arcs_of_every_length() {
        for half_angle_deg in [30.0, 90.0, 110.0, 170.0, 180.0] {
            let arc = TorusArc::new(0.04, 0.008, half_angle_deg);
            testing::check(&Shape::TorusArc(arc.clone()), |p| arc.contains(p));
        }
    }
}
