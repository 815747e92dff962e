//! Solids of revolution: cylinders, cones, balls, bowls, plates, bottles.

mod frustum;
mod zone;

use frustum::Frustum;
use glam::DVec3;
use zone::Zone;

use crate::ray::{Hit, Ray};

/// A profile turned about the z axis.
///
/// The profile runs in the half plane (r, z), r >= 0, from the axis back to the axis with the solid on its left: along
/// the underside outwards, up, along the top inwards. Each piece is a face with its own number.
#[derive(Clone, Debug)]
pub(crate) struct Revolved {
    faces: Vec<Face>,
}

/// A piece of a profile that ends where the next one begins.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Piece {
    /// Straight to (r, z).
    Line([f64; 2]),
    /// To (r, z), which lies on the circle around (0, `center_z`) that passes through where the piece begins.
    Arc { to: [f64; 2], center_z: f64 },
}

#[derive(Clone, Debug)]
enum Face {
    Frustum(Frustum),
    Zone(Zone),
}

impl Revolved {
    /// The profile that begins at (0, `start_z`).
    pub(crate) fn new(start_z: f64, pieces: &[Piece]) -> Self {
        let mut from = [0.0, start_z];
        let mut along = 0.0;
        let faces = pieces
            .iter()
            .map(|&piece| {
                let (face, to) = match piece {
                    Piece::Line(to) => (Face::Frustum(Frustum { from, to, along }), to),
                    Piece::Arc { to, center_z } => (Face::Zone(Zone::new(from, to, center_z, along)), to),
                };
                along += libm::hypot(to[0] - from[0], to[1] - from[1]);
                from = to;
                face
            })
            .collect();
        Self { faces }
    }

    /// An upright cylinder that stands on z = 0. Faces: underside, side, top.
    pub(crate) fn cylinder(radius_m: f64, height_m: f64) -> Self {
        Self::new(
            0.0,
            &[Piece::Line([radius_m, 0.0]), Piece::Line([radius_m, height_m]), Piece::Line([0.0, height_m])],
        )
    }

    /// A ball that touches z = 0. Faces: lower and upper half.
    pub(crate) fn ball(radius_m: f64) -> Self {
        let center_z = radius_m;
        Self::new(
            0.0,
            &[
                Piece::Arc { to: [radius_m, radius_m], center_z },
                Piece::Arc { to: [0.0, 2.0 * radius_m], center_z },
            ],
        )
    }

    /// All points within `radius_m` of the z axis from 0 to `length_m`. Faces: lower end, side, upper end.
    pub(crate) fn capsule(radius_m: f64, length_m: f64) -> Self {
        Self::new(
            -radius_m,
            &[
                Piece::Arc { to: [radius_m, 0.0], center_z: 0.0 },
                Piece::Line([radius_m, length_m]),
                Piece::Arc { to: [0.0, length_m + radius_m], center_z: length_m },
            ],
        )
    }

    pub(crate) fn hit(&self, ray: Ray, after: f64) -> Option<Hit> {
        let hits = self.faces.iter().enumerate().map(|(surface, face)| {
            let hit = match face {
                Face::Frustum(face) => face.hit(ray, after),
                Face::Zone(face) => face.hit(ray, after),
            };
            hit.map(|hit| Hit { surface, ..hit })
        });
        hits.fold(None, Hit::nearer)
    }

    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        let sideways = libm::hypot(direction.x, direction.y);
        let reach = |face: &Face| match face {
            Face::Frustum(face) => face.support(sideways, direction.z),
            Face::Zone(face) => face.support(sideways, direction.z),
        };
        self.faces.iter().map(reach).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Radius of the flat underside on which it stands; 0 when there is none.
    pub(crate) fn foot_m(&self) -> f64 {
        match self.faces.first() {
            Some(Face::Frustum(face)) if face.from[1] == face.to[1] => face.to[0],
            _ => 0.0,
        }
    }

    /// The profile as corners (r, z), from the axis to the axis; arcs are cut into pieces of at most `step_deg`.
    pub(crate) fn profile(&self, step_deg: f64) -> Vec<[f64; 2]> {
        let mut corners = Vec::new();
        for face in &self.faces {
            match face {
                Face::Frustum(face) => corners.push(face.from),
                Face::Zone(face) => face.corners(step_deg, &mut corners),
            }
        }
        corners.extend(self.faces.last().map(|face| match face {
            Face::Frustum(face) => face.to,
            Face::Zone(face) => face.to,
        }));
        corners
    }

    /// What it is, if it is a ball, a cylinder or a bar with round ends.
    pub(crate) fn as_simple(&self) -> Option<Simple> {
        match self.faces.as_slice() {
            [Face::Zone(low), Face::Zone(high)] if low.is_ball_with(high) => {
                let (center_z, radius) = low.sphere();
                Some(Simple::Ball { center_z, radius })
            }
            [Face::Frustum(low), Face::Frustum(side), Face::Frustum(high)]
                if low.from[1] == low.to[1] && high.from[1] == high.to[1] && side.from[0] == side.to[0] =>
            {
                Some(Simple::Cylinder { low_z: low.to[1], high_z: high.to[1], radius: side.to[0] })
            }
            [Face::Zone(low), Face::Frustum(side), Face::Zone(high)]
                if side.from[0] == side.to[0] && low.sphere() == (0.0, side.from[0]) =>
            {
                Some(Simple::Bar { high_z: high.sphere().0, radius: side.from[0] })
            }
            _ => None,
        }
    }

    pub(crate) fn surfaces(&self) -> usize {
        self.faces.len()
    }
}

/// Solids of revolution that have a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Simple {
    Ball {
        center_z: f64,
        radius: f64,
    },
    Cylinder {
        low_z: f64,
        high_z: f64,
        radius: f64,
    },
    /// All points within `radius` of the axis from z = 0 on.
    Bar {
        high_z: f64,
        radius: f64,
    },
}

/// The roots of a t² + 2 b t + c = 0, ascending; none when they are not real.
///
/// The one with cancellation is taken from the product of the roots.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    if a == 0.0 {
        return [(b != 0.0).then(|| -c / (2.0 * b)), None];
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return [None, None];
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    let (x, y) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    [Some(x.min(y)), Some(x.max(y))]
}

/// Place on a surface of revolution: arc length around the axis at radius `scale_m`, and `along` the profile.
fn place(point: DVec3, scale_m: f64, along: f64) -> [f64; 2] {
    [libm::atan2(point.y, point.x) * scale_m, along]
}

#[cfg(test)]
impl Revolved {
    /// Even-odd rule in the half plane of the profile, whose arcs become chords of 1/500 of their length.
    pub(super) fn contains(&self, r: f64, z: f64) -> bool {
        let chords = |face: &Face| match face {
            Face::Frustum(face) => vec![[face.from, face.to]],
            Face::Zone(face) => face.chords(500),
        };
        let crosses = |[[r0, z0], [r1, z1]]: [[f64; 2]; 2]| {
            (z0 > z) != (z1 > z) && r < r0 + (z - z0) / (z1 - z0) * (r1 - r0)
        };
        self.faces.iter().flat_map(chords).filter(|&chord| crosses(chord)).count() % 2 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Shape, testing};

    #[test]
    fn the_even_odd_rule_agrees_too() {
        let shape = Revolved::ball(0.05);
        for i in 0..2000 {
            let (r, z) = (f64::from(i % 40) * 0.002 + 1e-4, f64::from(i / 40) * 0.003 - 0.02);
            let from_center = libm::hypot(r, z - 0.05);
            if (from_center - 0.05).abs() > 1e-6 {
                assert_eq!(shape.contains(r, z), from_center < 0.05, "{r} {z}");
            }
        }
    }

    fn r(p: DVec3) -> f64 {
        libm::hypot(p.x, p.y)
    }

    #[test]
    fn a_cylinder() {
        let shape = Shape::Revolved(Revolved::cylinder(0.04, 0.1));
        testing::check(&shape, |p| r(p) < 0.04 && 0.0 < p.z && p.z < 0.1);
    }

    #[test]
    fn a_ball() {
        let shape = Shape::Revolved(Revolved::ball(0.05));
        testing::check(&shape, |p| (p - DVec3::Z * 0.05).length() < 0.05);
    }

    #[test]
    fn a_capsule() {
        let shape = Shape::Revolved(Revolved::capsule(0.04, 0.2));
        testing::check(&shape, |p| (p - DVec3::Z * p.z.clamp(0.0, 0.2)).length() < 0.04);
    }

    #[test]
    fn a_cone() {
        let shape =
            Shape::Revolved(Revolved::new(0.0, &[Piece::Line([0.05, 0.0]), Piece::Line([0.0, 0.12])]));
        testing::check(&shape, |p| 0.0 < p.z && r(p) < 0.05 * (1.0 - p.z / 0.12));
    }

    #[test]
    fn a_hollow_bowl() {
        let (outer, inner, center_z): (f64, f64, f64) = (0.08, 0.076, 0.0775);
        let foot = (outer * outer - center_z * center_z).sqrt();
        let shape = Shape::Revolved(Revolved::new(
            0.0,
            &[
                Piece::Line([foot, 0.0]),
                Piece::Arc { to: [outer, center_z], center_z },
                Piece::Line([inner, center_z]),
                Piece::Arc { to: [0.0, center_z - inner], center_z },
            ],
        ));
        testing::check(&shape, |p| {
            let from_center = (p - DVec3::Z * center_z).length();
            0.0 < p.z && p.z < center_z && inner < from_center && from_center < outer
        });
    }

    #[test]
    fn a_cup_with_slanted_walls() {
        let shape = Shape::Revolved(Revolved::new(
            0.0,
            &[[0.03, 0.0], [0.04, 0.09], [0.037, 0.09], [0.027, 0.004], [0.0, 0.004]].map(Piece::Line),
        ));
        testing::check(&shape, |p| {
            let outer = 0.03 + 0.01 * p.z / 0.09;
            let inner = 0.027 + 0.01 * (p.z - 0.004) / 0.086;
            0.0 < p.z && p.z < 0.09 && r(p) < outer && !(p.z > 0.004 && r(p) < inner)
        });
    }

    #[test]
    fn roots_do_not_cancel() {
        assert_eq!(roots(1.0, -1.5, 2.0), [Some(1.0), Some(2.0)]);
        assert_eq!(roots(1.0, 0.0, 1.0), [None, None]);
        assert_eq!(roots(0.0, 1.0, -4.0), [Some(2.0), None]);
        let [small, _] = roots(1.0, -1e8, 1.0);
        assert!((small.unwrap() - 5e-9).abs() < 1e-23);
    }
}
