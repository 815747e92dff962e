//! Rays, and where they meet a surface.

use glam::DVec3;

/// The points origin + t direction, t > 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    /// Of any length but zero; t counts in its length.
    pub(crate) direction: DVec3,
}

impl Ray {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Whether it comes within `radius` of `center`, and not only behind its origin.
    pub(crate) fn passes(&self, center: DVec3, radius: f64) -> bool {
        let to_center = center - self.origin;
        let along = to_center.dot(self.direction);
        let square = self.direction.length_squared();
        let beside = to_center.length_squared() * square - along * along;
        let square_radius = radius * radius;
        beside <= square_radius * square && (along > 0.0 || to_center.length_squared() <= square_radius)
    }
}

/// Where a ray meets the boundary of a shape, in the shape's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) t: f64,
    /// Unit, out of the solid.
    pub(crate) normal: DVec3,
    /// Place on the surface (m), for textures.
    pub(crate) uv_m: [f64; 2],
    /// Which face of the shape.
    pub(crate) surface: usize,
}

impl Hit {
    /// The nearer of two.
    pub(crate) fn nearer(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        match (a, b) {
            (Some(a), Some(b)) => Some(if b.t < a.t { b } else { a }),
            (a, b) => a.or(b),
        }
    }
}
