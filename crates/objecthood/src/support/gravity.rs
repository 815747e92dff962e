//! Gravity: the direction up, from measured gravity, a plane, earlier frames or the camera (PARITY.md 5,
//! docs/CONTEXT.md 5.1).

use glam::{DVec3, Vec3};

use crate::attitude::{Attitude, Knowledge};
use crate::buffers::Buffer;
use crate::discovery::up::{Up, UpSource};
use crate::params::{self, UpFrom};
use crate::planes::{Plane, StructurePlane};
use crate::random::Lcg;
use crate::raster::Raster;

/// Number of least-squares fits after the best trial, each to the points near the previous plane.
const REFITS: usize = 3;
/// Where the random numbers of the trial planes begin: fixed, so the same cloud gives the same plane.
const SEED: u32 = 12345;

/// Finds the plane that holds most points, if its share of the points is at least `min_inlier_share`.
///
/// RANSAC (Fischler and Bolles 1981): draws `trials` planes, each through three random points of an evenly spaced sample of `samples`
/// points. The plane with most of the sample within `inlier_distance_m` is fitted to all points near it by total least squares,
/// three times. The random numbers are fixed. O(trials · samples + points).
pub fn find_dominant_plane(points_m: &Raster<[f32; 3]>, params: &params::Gravity) -> Option<StructurePlane> {
    let measured = points_m.as_slice().iter().copied().filter(|p| !p[2].is_nan());
    fit_plane_of_most(&measured.collect::<Buffer<_>>(), params)
}

/// As [`find_dominant_plane`], for points that are all measured.
fn fit_plane_of_most(points: &[[f32; 3]], params: &params::Gravity) -> Option<StructurePlane> {
    let point = |p: &[f32; 3]| Vec3::from(*p).as_dvec3();
    let sampled = params.samples.min(points.len());
    let sample: Vec<DVec3> = (0..sampled).map(|k| point(&points[k * points.len() / sampled])).collect();
    let near = |plane: &Plane, p: &DVec3| plane.distance_m(*p) < params.inlier_distance_m;

    let mut random = Lcg::new(SEED);
    let mut best: Option<(usize, Plane)> = None;
    for _ in 0..params.trials {
        let corners: [DVec3; 3] = std::array::from_fn(|_| sample[random.below(sample.len())]);
        let Some(plane) = Plane::through(corners) else { continue };
        let inliers = sample.iter().filter(|p| near(&plane, p)).count();
        if best.as_ref().is_none_or(|(most, _)| inliers > *most) {
            best = Some((inliers, plane));
        }
    }
    let (_, mut plane) = best?;
    for _ in 0..REFITS {
        plane = Plane::fit(points.iter().map(point).filter(|p| near(&plane, p)))?;
    }
    let share = points.iter().map(point).filter(|p| near(&plane, p)).count() as f64 / points.len() as f64;
    (share >= params.min_inlier_share).then(|| StructurePlane {
        normal: plane.normal.as_vec3().to_array(),
        offset_m: plane.offset_m as f32,
        inlier_share: share as f32,
    })
}

/// Marks the points of the plane that belong to no object: 1 on the plane, 0 elsewhere. O(pixels).
pub(crate) fn mark_plane(
    plane: Option<&StructurePlane>,
    labels: &Raster<u16>,
    points_m: &Raster<[f32; 3]>,
    params: &params::Gravity,
) -> Raster<u16> {
    let Some(plane) = plane else { return labels.map(|_| 0) };
    let distance_m = |p: &[f32; 3]| plane.height_m(Vec3::from(*p).as_dvec3()).abs();
    // False for NaN, that is without depth.
    let is_near = |p: &[f32; 3]| distance_m(p) < params.inlier_distance_m;
    let pixels = points_m.as_slice().iter().zip(labels.as_slice());
    labels.with_data(pixels.map(|(p, &object)| u16::from(object == 0 && is_near(p))).collect())
}

/// Finds the direction up: measured gravity, else the normal of `plane`, else what earlier frames told, else the camera's own up. With
/// `up_from = camera` it is the camera's own up unless gravity was measured.
///
/// *Differs from the paper:* there the camera is held horizontally (`up_from = camera`, and neither tilt nor roll).
pub fn find_up(plane: Option<&StructurePlane>, attitude: &Attitude, up_from: UpFrom) -> Up {
    let of = |up: DVec3, source| Up { direction: up.as_vec3().to_array(), source };
    if attitude.knowledge == Knowledge::Measured {
        return of(attitude.up, UpSource::Measured);
    }
    match (up_from, plane, attitude.earlier_up) {
        (UpFrom::Plane, Some(plane), _) => Up { direction: plane.normal, source: UpSource::Plane },
        (UpFrom::Plane, None, Some(up)) => of(up, UpSource::Earlier),
        _ => of(attitude.up, UpSource::Camera),
    }
}

/// The ground of `paper`, and the direction up.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Ground {
    /// The dominant plane, if one holds enough points.
    pub plane: Option<StructurePlane>,
    /// The direction against gravity.
    pub up: Up,
}

/// Finds the dominant plane and the direction up. See [`find_dominant_plane`].
pub fn find_ground(points_m: &Raster<[f32; 3]>, attitude: &Attitude, params: &params::Gravity) -> Ground {
    let plane = find_dominant_plane(points_m, params);
    Ground { up: find_up(plane.as_ref(), attitude, params.up_from), plane }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `on` points of the plane n · X = -1, and `off` points strewn around it.
    fn cloud(n: DVec3, on: usize, off: usize) -> Raster<[f32; 3]> {
        let mut random = Lcg::new(7);
        let mut draw = || random.below(2001) as f64 / 1000.0 - 1.0;
        let (s, t) = n.any_orthonormal_pair();
        let mut points: Vec<[f32; 3]> =
            (0..on).map(|_| (s * draw() + t * draw() - n).as_vec3().to_array()).collect();
        points.extend((0..off).map(|_| [draw() as f32, draw() as f32, draw() as f32 + 2.0]));
        Raster::from_vec(points.len(), 1, points).unwrap()
    }

    fn level(earlier_up: Option<DVec3>) -> Attitude {
        Attitude { up: DVec3::NEG_Y, knowledge: Knowledge::Assumed, earlier_up }
    }

    #[test]
    fn the_plane_is_found_among_as_many_other_points() {
        let n = DVec3::new(0.1, -0.8, -0.6).normalize();
        let plane = find_dominant_plane(&cloud(n, 5000, 5000), &params::Gravity::default()).unwrap();
        assert!(Vec3::from(plane.normal).as_dvec3().dot(n) > 0.9999, "{plane:?}");
        assert!(
            (plane.offset_m - 1.0).abs() < 2e-3 && (0.5..0.53).contains(&plane.inlier_share),
            "{plane:?}"
        );
    }

    #[test]
    fn refits_better_the_plane_through_three_points() {
        // A plane with noise of 4 mm: the plane through three points has a larger error than the fit to all.
        let mut random = Lcg::new(3);
        let mut draw = || random.below(2001) as f64 / 1000.0 - 1.0;
        let points = (0..4000).map(|_| [draw() as f32, draw() as f32, (2.0 + 0.004 * draw()) as f32]);
        let points = Raster::from_vec(4000, 1, points.collect()).unwrap();
        let plane =
            find_dominant_plane(&points, &params::Gravity { trials: 20, ..Default::default() }).unwrap();
        assert!(plane.normal[2] < -0.999_999 && (plane.offset_m - 2.0).abs() < 2e-4, "{plane:?}");
    }

    #[test]
    fn without_a_plane_up_is_the_cameras() {
        let params = params::Gravity::default();
        assert_eq!(find_dominant_plane(&cloud(DVec3::NEG_Y, 50, 5000), &params), None);
        assert_eq!(find_dominant_plane(&cloud(DVec3::NEG_Y, 1, 0), &params), None);
        let line = Raster::from_vec(3, 1, vec![[0.0, 0.0, 1.0], [0.0, 0.0, 2.0], [0.0, 0.0, 3.0]]).unwrap();
        assert_eq!(find_dominant_plane(&line, &params), None, "points on a line are no plane");
        let up = find_up(None, &level(None), UpFrom::Plane);
        assert_eq!(up, Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera });
    }

    #[test]
    fn the_camera_is_up_when_asked_for() {
        let plane = StructurePlane { normal: [0.0, 0.0, -1.0], offset_m: 1.0, inlier_share: 1.0 };
        assert_eq!(find_up(Some(&plane), &level(None), UpFrom::Camera).source, UpSource::Camera);
        assert_eq!(find_up(Some(&plane), &level(None), UpFrom::Plane).direction, plane.normal);
    }

    #[test]
    fn without_a_plane_up_is_what_earlier_frames_told() {
        let (earlier, plane) = (DVec3::new(0.0, -0.6, -0.8), [0.0, 0.0, -1.0]);
        let up = find_up(None, &level(Some(earlier)), UpFrom::Plane);
        assert_eq!(up, Up { direction: [0.0, -0.6, -0.8], source: UpSource::Earlier });
        let plane = StructurePlane { normal: plane, offset_m: 1.0, inlier_share: 1.0 };
        assert_eq!(find_up(Some(&plane), &level(Some(earlier)), UpFrom::Plane).direction, plane.normal);
    }
}
