//! A camera for points that come without one.
//!
//! 1. Where the sensor was: where the file says (VIEWPOINT), or in the origin. Both are tried, in this order, because files
//!    differ in whose frame the points are stored.
//! 2. Which way it looked. Forward along z, if the points lie there, or backward along z as in computer graphics; else
//!    towards their middle. There, down is y where the middle is near z, and else the cloud has z up.
//! 3. Its pixels. Points that a depth camera saw stand on the lattice of its pixels, in any order
//!    ([`lattice`](super::lattice)). Else the focal length is the greatest that leaves few holes ([`focal`](super::focal)).
//!
//! Points that span more than [`LEAST_COS`] allows are refused: they are seen from no one side.

use glam::{DMat3, DQuat, DVec3};

use super::{GridCamera, focal, is_valid, lattice};
use crate::capture::Pose;
use crate::error::{Error, Result};

/// Most points that are looked at to find direction and lattice: a hundred for each line of an image of 640 columns.
const SAMPLE: usize = 1 << 16;
/// The golden ratio times 2^32: its multiples are spread evenly, and not along the columns of an image.
const GOLDEN: u64 = 2_654_435_769;
/// Share of the points that must lie in the field of view; the others may be stray.
const IN_VIEW_SHARE: f64 = 0.98;
/// Cosine of the greatest angle between a point and the optical axis: 60 degrees, a field of 120 degrees. An image of a
/// greater one shows its border at a quarter of the scale of its middle.
const LEAST_COS: f64 = 0.5;
/// A camera that looks along z sees points at most this far beside its axis, as a share of their depth: 45 degrees, the
/// half field of view of the widest usual depth cameras.
const USUAL_HALF_FIELD: f32 = 1.0;
/// By half about x, between the axes of computer graphics and those of a camera.
pub(super) const HALF_TURN: Pose = Pose { position_m: [0.0; 3], rotation_xyzw: [1.0, 0.0, 0.0, 0.0] };

/// A camera that sees the points, and where it is in their frame. At most `max_pixels` pixels. O(points).
///
/// # Errors
/// [`Error::NoView`] when the points span too much.
pub(super) fn choose(
    points_m: &[[f32; 3]],
    viewpoint: Option<Pose>,
    max_pixels: usize,
) -> Result<(GridCamera, Pose)> {
    let sample = sample(points_m);
    let starts = || viewpoint.into_iter().chain([Pose::ORIGIN]);
    let poses = || starts().map(|start| forward(start, &sample));
    let are_in_front = |pose: &Pose| are_nearly_all(&sample, |point| is_valid(pose.to_camera(point)));
    for pose in poses().filter(are_in_front) {
        if let Some(grid) = lattice::find(points_m, &sample, pose, max_pixels) {
            return Ok((grid, pose));
        }
    }
    let along_z = poses().find(|&pose| is_in_usual_field(&sample, pose));
    let pose = along_z.or_else(|| starts().find_map(|start| towards_the_middle(start, &sample)));
    match pose {
        Some(pose) => Ok((focal::choose(points_m, pose, max_pixels), pose)),
        None => Err(Error::NoView { points: points_m.len() }),
    }
}

/// Up to [`SAMPLE`] finite points, spread evenly over the list.
fn sample(points_m: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let count = points_m.len() as u64;
    let spread = |k: u64| ((k * GOLDEN % (1 << 32)) * count) >> 32;
    let is_finite = |point: &[f32; 3]| point.iter().all(|part| part.is_finite());
    if points_m.len() <= SAMPLE {
        return points_m.iter().copied().filter(is_finite).collect();
    }
    (0..SAMPLE as u64).map(|k| points_m[spread(k) as usize]).filter(is_finite).collect()
}

/// The pose, turned by half about x if most points then lie in front of it.
fn forward(pose: Pose, sample: &[[f32; 3]]) -> Pose {
    let behind = sample.iter().filter(|&&point| pose.to_camera(point)[2] < 0.0).count();
    if 2 * behind > sample.len() { turned(pose, HALF_TURN.rotation()) } else { pose }
}

/// The pose of a camera that is turned within the frame of another.
fn turned(pose: Pose, turn: DQuat) -> Pose {
    let rotation_xyzw = (pose.rotation() * turn).normalize().to_array();
    // The sign of a quaternion means nothing, and this one is expected of a half turn.
    let sign = if rotation_xyzw.iter().copied().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    Pose { rotation_xyzw: rotation_xyzw.map(|part| sign * part + 0.0), ..pose }
}

fn is_in_usual_field(sample: &[[f32; 3]], pose: Pose) -> bool {
    are_nearly_all(sample, |point| {
        let [x, y, z] = pose.to_camera(point);
        is_valid([x, y, z]) && x.abs().max(y.abs()) <= USUAL_HALF_FIELD * z
    })
}

/// Whether something holds of all points but stray ones.
fn are_nearly_all(sample: &[[f32; 3]], holds: impl Fn([f32; 3]) -> bool) -> bool {
    let count = sample.iter().filter(|&&point| holds(point)).count();
    !sample.is_empty() && count as f64 >= IN_VIEW_SHARE * sample.len() as f64
}

/// A camera at the same place that looks towards the middle of the points, if it sees them.
fn towards_the_middle(start: Pose, sample: &[[f32; 3]]) -> Option<Pose> {
    let direction = |&point: &[f32; 3]| DVec3::from(start.to_camera(point).map(f64::from)).try_normalize();
    let directions: Vec<DVec3> = sample.iter().filter_map(direction).collect();
    let median = |axis: usize| {
        let mut parts: Vec<f64> = directions.iter().map(|direction| direction[axis]).collect();
        let middle = parts.len() / 2;
        (middle < parts.len()).then(|| *parts.select_nth_unstable_by(middle, f64::total_cmp).1)
    };
    let forward = DVec3::new(median(0)?, median(1)?, median(2)?).try_normalize()?;
    let inside = directions.iter().filter(|direction| direction.dot(forward) >= LEAST_COS).count();
    let is_seen = inside as f64 >= IN_VIEW_SHARE * directions.len() as f64;
    is_seen.then(|| turned(start, looking(forward)))
}

/// The rotation of a camera that looks `forward`.
fn looking(forward: DVec3) -> DQuat {
    let [x, y, z] = forward.abs().to_array();
    let down = if z >= x.max(y) { DVec3::Y * z.copysign(forward.z).signum() } else { -DVec3::Z };
    let right = down.cross(forward).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, forward.cross(right), forward))
}
