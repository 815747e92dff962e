//! The forms that physics knows, made from ours.
//!
//! Cuboids, balls, cylinders and bars are exact; other bodies are their convex hull; walls of round vessels are cut into
//! wedges whose inner faces touch the true inside from without, so that what lies in a vessel has as much room as it should.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3, Quat, Vec3};
use rapier3d::prelude as physics;
use rapier3d::prelude::SharedShape;

use crate::pose::Pose;
use crate::shape::{Revolved, Shape, Simple};
use crate::solid::{Part, Solid};

/// Pieces that a round body or a wall is cut into, around and along its profile.
const SECTORS: usize = 20;
const STEP_DEG: f64 = 15.0;
/// Pieces of a handle.
const HANDLE_PIECES: usize = 4;

/// The form of a solid in its own frame; `None` when a part of it has no volume.
pub(super) fn shape_of(solid: &Solid) -> Option<SharedShape> {
    let mut pieces = Vec::new();
    for part in &solid.parts {
        let hollow = solid.form.cavity.is_some();
        pieces.extend(pieces_of(part, hollow)?.into_iter().map(|(pose, shape)| (to_physics(&pose), shape)));
    }
    match pieces.as_slice() {
        [(pose, shape)] if *pose == physics::Pose::identity() => Some(shape.clone()),
        [] => None,
        _ => Some(SharedShape::compound(pieces)),
    }
}

fn pieces_of(part: &Part, hollow: bool) -> Option<Vec<(Pose, SharedShape)>> {
    let own = part.pose;
    Some(match &part.shape {
        Shape::Cuboid(cuboid) => {
            let half = cuboid.half_m.as_vec3();
            vec![(own, SharedShape::cuboid(half.x, half.y, half.z))]
        }
        Shape::TorusArc(arc) => {
            let (spine, radius) = arc.spine(HANDLE_PIECES);
            let bar = |ends: &[DVec3]| {
                (own, SharedShape::capsule(ends[0].as_vec3(), ends[1].as_vec3(), radius as f32))
            };
            spine.windows(2).map(bar).collect()
        }
        Shape::Revolved(shape) => match shape.as_simple() {
            Some(Simple::Ball { center_z, radius }) => {
                vec![(own.after(&Pose::at([0.0, 0.0, center_z])), SharedShape::ball(radius as f32))]
            }
            Some(Simple::Cylinder { low_z, high_z, radius }) => {
                // Its axis is the y axis there.
                let pose = own.after(&Pose::at([0.0, 0.0, (low_z + high_z) / 2.0]).turned(0, 90.0));
                vec![(pose, SharedShape::cylinder(((high_z - low_z) / 2.0) as f32, radius as f32))]
            }
            Some(Simple::Bar { high_z, radius }) => {
                vec![(own, SharedShape::capsule(Vec3::ZERO, Vec3::Z * high_z as f32, radius as f32))]
            }
            None if hollow => walls(shape)?.into_iter().map(|wedge| (own, wedge)).collect(),
            None => vec![(own, hull(&rings(&shape.profile(STEP_DEG)))?)],
        },
    })
}

fn rings(profile: &[[f64; 2]]) -> Vec<Vec3> {
    let around = |&[r, z]: &[f64; 2]| (0..SECTORS).map(move |k| at(r, z, k));
    profile.iter().flat_map(around).collect()
}

fn at(r: f64, z: f64, sector: usize) -> Vec3 {
    let (sin, cos) = libm::sincos(TAU * sector as f64 / SECTORS as f64);
    DVec3::new(r * cos, r * sin, z).as_vec3()
}

fn hull(points: &[Vec3]) -> Option<SharedShape> {
    SharedShape::convex_hull(points)
}

/// The wall and the floor of a vessel as wedges.
fn walls(shape: &Revolved) -> Option<Vec<SharedShape>> {
    let profile = shape.profile(STEP_DEG);
    let top = profile.iter().map(|corner| corner[1]).fold(f64::NEG_INFINITY, f64::max);
    let first = profile.iter().position(|corner| corner[1] == top)?;
    let last = profile.iter().rposition(|corner| corner[1] == top)?;
    let (outer, inner) = (&profile[..=first], &profile[last..]);
    // The inner faces of the wedges are to touch the inside, which is round, from without.
    let widen = 1.0 / libm::cos(TAU / (2.0 * SECTORS as f64));
    let mut wedges = Vec::new();
    for pair in inner.windows(2) {
        let [high, low] = [pair[0], pair[1]];
        for sector in 0..SECTORS {
            let mut points = Vec::new();
            for [r, z] in [high, low] {
                let inside = (r * widen).min(radius_at(outer, z).max(r));
                for side in [sector, sector + 1] {
                    points.push(at(inside, z, side));
                    points.push(at(radius_at(outer, z), z, side));
                    points.push(at(inside, below(outer, inside, z), side));
                }
            }
            wedges.push(hull(&points)?);
        }
    }
    Some(wedges)
}

/// Radius of the outside at a height.
fn radius_at(outer: &[[f64; 2]], z: f64) -> f64 {
    let piece = outer.windows(2).find(|pair| pair[0][1] <= z && z <= pair[1][1] && pair[0][1] < pair[1][1]);
    piece.map_or(0.0, |pair| {
        let [from, to] = [pair[0], pair[1]];
        from[0] + (to[0] - from[0]) * (z - from[1]) / (to[1] - from[1])
    })
}

/// Height of the outside below a point of the inside.
fn below(outer: &[[f64; 2]], r: f64, z: f64) -> f64 {
    let piece = outer.windows(2).find(|pair| pair[0][0] <= r && r <= pair[1][0] && pair[0][0] < pair[1][0]);
    let height = piece.map_or(z, |pair| {
        let [from, to] = [pair[0], pair[1]];
        from[1] + (to[1] - from[1]) * (r - from[0]) / (to[0] - from[0])
    });
    height.min(z)
}

/// A pose in the numbers of physics.
pub(super) fn to_physics(pose: &Pose) -> physics::Pose {
    let [x, y, z, w] = DQuat::from_mat3(&pose.rotation).to_array().map(|c| c as f32);
    physics::Pose::from_parts(pose.origin.as_vec3(), Quat::from_xyzw(x, y, z, w).normalize())
}

/// A pose of physics in ours.
pub(super) fn from_physics(pose: &physics::Pose) -> Pose {
    let rotation = pose.rotation.as_dquat().normalize();
    Pose { rotation: glam::DMat3::from_quat(rotation), origin: pose.translation.as_dvec3() }
}
