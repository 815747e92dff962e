//! A box with its middle at the origin.

use glam::DVec3;

use crate::ray::{Hit, Ray};

/// Faces are numbered -x, +x, -y, +y, -z, +z.
#[derive(Clone, Debug)]
pub(crate) struct Cuboid {
    pub(crate) half_m: DVec3,
}

impl Cuboid {
    pub(crate) const SURFACES: usize = 6;

    /// Slabs (Kay and Kajiya 1986): the ray is inside between the last entry and the first exit.
    pub(crate) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        let (mut enter_axis, mut leave_axis) = (0, 0);
        for k in 0..3 {
            let (origin, direction, half) = (ray.origin[k], ray.direction[k], self.half_m[k]);
            if direction == 0.0 {
                if origin.abs() > half {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-half - origin) / direction, (half - origin) / direction);
            if a.min(b) > enter {
                (enter, enter_axis) = (a.min(b), k);
            }
            if a.max(b) < leave {
                (leave, leave_axis) = (a.max(b), k);
            }
        }
        if enter > leave {
            return None;
        }
        let (t, axis, outward) = if enter > after {
            (enter, enter_axis, -ray.direction[enter_axis])
        } else {
            (leave, leave_axis, ray.direction[leave_axis])
        };
        (t > after && t.is_finite()).then(|| {
            let point = ray.at(t);
            // The upright axis of a side is v, so that print stands upright.
            let uv_m = match axis {
                0 => [point.y, point.z],
                1 => [point.x, point.z],
                _ => [point.x, point.y],
            };
            let normal = DVec3::AXES[axis] * outward.signum();
            Hit { t, normal, uv_m, surface: 2 * axis + usize::from(outward > 0.0) }
        })
    }

    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        direction.abs().dot(self.half_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Shape, testing};

    #[test]
    fn agrees_with_its_implicit_function() {
        let half_m = DVec3::new(0.05, 0.1, 0.02);
        let inside = |p: DVec3| p.abs().cmplt(half_m).all();
        testing::check(&Shape::Cuboid(Cuboid { half_m }), inside);
    }

    #[test]
    fn faces_have_their_numbers() {
        let cuboid = Cuboid { half_m: DVec3::ONE };
        for surface in 0..6 {
            let axis = DVec3::AXES[surface / 2] * [-1.0, 1.0][surface % 2];
            let hit = cuboid.hit(Ray { origin: axis * 3.0, direction: -axis }, 0.0).unwrap();
            assert_eq!((hit.t, hit.normal, hit.surface), (2.0, axis, surface));
        }
    }
}
