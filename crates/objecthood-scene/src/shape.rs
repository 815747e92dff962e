//! The solids that everything is made of, each in its own frame.
//!
//! A shape answers two questions: where a ray first crosses its boundary, and how far it reaches in a direction. From
//! the first come pictures and truth, from the second contacts and the certainty that things do not interpenetrate.

mod cuboid;
mod revolved;
mod torus_arc;

pub(crate) use cuboid::Cuboid;
pub(crate) use revolved::{Piece, Revolved, Simple};
pub(crate) use torus_arc::TorusArc;

use glam::DVec3;

use crate::ray::{Hit, Ray};

#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Cuboid(Cuboid),
    Revolved(Revolved),
    TorusArc(TorusArc),
}

impl Shape {
    /// The first crossing of its boundary at t > `after`.
    pub(crate) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        match self {
            Self::Cuboid(shape) => shape.hit(ray, after),
            Self::Revolved(shape) => shape.hit(ray, after),
            Self::TorusArc(shape) => shape.hit(ray, after),
        }
    }

    /// The greatest `direction` · p of its points p.
    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        match self {
            Self::Cuboid(shape) => shape.support(direction),
            Self::Revolved(shape) => shape.support(direction),
            Self::TorusArc(shape) => shape.support(direction),
        }
    }

    /// Number of its faces.
    pub(crate) fn surfaces(&self) -> usize {
        match self {
            Self::Cuboid(_) => Cuboid::SURFACES,
            Self::Revolved(shape) => shape.surfaces(),
            Self::TorusArc(_) => TorusArc::SURFACES,
        }
    }

    /// Center and radius of a sphere around it.
    pub(crate) fn bounding_sphere(&self) -> (DVec3, f64) {
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for k in 0..3 {
            (high[k], low[k]) = (self.support(DVec3::AXES[k]), -self.support(-DVec3::AXES[k]));
        }
        ((low + high) / 2.0, (high - low).length() / 2.0 + 1e-6)
    }
}

#[cfg(test)]
pub(crate) mod testing;
