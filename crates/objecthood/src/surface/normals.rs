//! Surface normals from integral images.
//!
//! The tangents ∂X/∂u and ∂X/∂v are averaged over a window that does not reach across a depth change; their
//! cross product is the normal (Holzer et al., IROS 2012: average 3-D gradient; paper, III-A; METHOD 2.2).
//!
//! 1. mark depth changes, 2. distance to the nearest one, 3. window half size from it, 4. sums along rows and columns,
//!    5. cross product, turned towards the camera.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::params;
use crate::raster::Raster;
use crate::surface::depth_change::squared_distance;
use crate::workspace::Workspace;

/// Rows whose sums are held together, so that they fit a cache.
const BAND_ROWS: usize = 32;

/// The unit normal of every pixel, towards the camera (n · X < 0); zero where there is none: no depth, or a
/// depth change so near that no window fits.
///
/// No window holds a depth change, so its tangents form chains of neighbours and their sums telescope: what is left of those
/// along a row are its last and first point. The points are summed along rows and columns, in f64, and four sums give
/// the average of a direction.
///
/// `points_m`: camera frame, `NaN` = none. O(pixels · window) for the distances, else O(pixels).
pub fn normals(
    points_m: &Raster<[f32; 3]>,
    params: &params::Normals,
    workspace: &mut Workspace,
) -> Raster<[f32; 3]> {
    let (width, height) = points_m.size();
    let half_limit = (params.window_px / 2.0) as usize;
    // A square of half size h reaches sqrt(2) h at its corners.
    let reach = half_limit * 3 / 2 + 1;
    let z = points_m.with_data(workspace.collected(points_m.as_slice().iter().map(|p| p[2])));
    let distance = squared_distance(&z, params.depth_change_per_m, reach, workspace);
    let half: Vec<u16> = (0..=reach * reach + 1).map(|d| half_window(d, half_limit) as u16).collect();

    let mut normals = workspace.filled(points_m.len(), [0.0; 3]);
    normals.par_chunks_mut(BAND_ROWS * width).enumerate().for_each_init(
        Sums::default,
        |sums, (band, normals)| {
            let rows = band * BAND_ROWS..height.min((band + 1) * BAND_ROWS);
            let around = rows.start.saturating_sub(half_limit)..height.min(rows.end + half_limit + 1);
            sums.take(points_m, around);
            for (normal, i) in normals.iter_mut().zip(rows.start * width..) {
                let (u, v, half) = (i % width, i / width, usize::from(half[distance[i] as usize]));
                let point = Vec3::from(points_m[i]);
                if half == 0 || point.z.is_nan() {
                    continue;
                }
                let (us, ue) = (u.saturating_sub(half), (u + half + 1).min(width));
                let (vs, ve) = (v.saturating_sub(half), (v + half + 1).min(height));
                // The tangents end one pixel farther, but for those that would leave the image.
                let (last_u, last_v) = (ue.min(width - 1), ve.min(height - 1));
                let along_u = sums.of_column(last_u, vs..ve) - sums.of_column(us, vs..ve);
                let along_v = sums.of_row(last_v, us..ue) - sums.of_row(vs, us..ue);
                let cross = along_u.cross(along_v);
                let towards_camera = -cross.dot(point.as_dvec3()).signum();
                *normal = (cross.normalize_or_zero() * towards_camera).as_vec3().to_array();
            }
        },
    );
    workspace.keep(z);
    workspace.keep(distance);
    points_m.with_data(normals)
}

/// The points of some rows summed up along rows and along columns.
#[derive(Default)]
struct Sums {
    first_row: usize,
    width: usize,
    /// Of each pixel, and of the place behind every row: the sum over its row before it.
    before: Vec<DVec3>,
    /// Of each pixel, and of the row below the last: the sum over its column above it.
    above: Vec<DVec3>,
}

impl Sums {
    /// Sums up `rows` of `points_m`; missing points count as zero.
    fn take(&mut self, points_m: &Raster<[f32; 3]>, rows: Range<usize>) {
        let width = points_m.width();
        (self.first_row, self.width) = (rows.start, width);
        self.before.clear();
        self.above.clear();
        self.above.resize(width, DVec3::ZERO);
        let points = &points_m.as_slice()[rows.start * width..rows.end * width];
        for (v, row) in points.chunks_exact(width).enumerate() {
            let mut before = DVec3::ZERO;
            for (u, &point) in row.iter().enumerate() {
                let point = if point[2].is_nan() { DVec3::ZERO } else { Vec3::from(point).as_dvec3() };
                self.before.push(before);
                before += point;
                self.above.push(self.above[v * width + u] + point);
            }
            self.before.push(before);
        }
    }

    /// The sum over column `u` within the rows `vs`.
    #[inline]
    fn of_column(&self, u: usize, vs: Range<usize>) -> DVec3 {
        let at = |v: usize| self.above[(v - self.first_row) * self.width + u];
        at(vs.end) - at(vs.start)
    }

    /// The sum over row `v` within the columns `us`.
    #[inline]
    fn of_row(&self, v: usize, us: Range<usize>) -> DVec3 {
        let row = &self.before[(v - self.first_row) * (self.width + 1)..][..=self.width];
        row[us.end] - row[us.start]
    }
}

/// The greatest h up to `limit` such that a square of half size h stays nearer than the depth change.
#[inline]
fn half_window(squared_distance: usize, limit: usize) -> usize {
    let mut half = 0;
    while half < limit && 2 * ((half + 1) * (half + 1)) < squared_distance {
        half += 1;
    }
    half
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::camera::Camera;
    use crate::frame::Frame;

    /// What a camera of 60 x 40 pixels sees of z = `depth(u, v)`.
    fn points(depth: impl Fn(usize, usize) -> f32) -> Raster<[f32; 3]> {
        let z = (0..60 * 40).map(|i| depth(i % 60, i / 60)).collect();
        let camera = Camera::new(60.0, 60.0, 29.5, 19.5).unwrap();
        Frame::new(Raster::from_vec(60, 40, z).unwrap(), None, camera).unwrap().points_m()
    }

    #[test]
    fn the_normals_of_a_plane_are_its_normal() {
        // The plane n · X = -1 with n = (0.3, -0.5, -0.8) made unit, seen exactly.
        let n = Vec3::new(0.3, -0.5, -0.8).normalize();
        let camera = Camera::new(60.0, 60.0, 29.5, 19.5).unwrap();
        let points = points(|u, v| {
            let ray = glam::DVec3::from(camera.ray(u as f64, v as f64)).as_vec3();
            -1.0 / n.dot(ray)
        });
        let params = params::Normals { depth_change_per_m: 1.0, ..Default::default() };
        let normals = normals(&points, &params, &mut Workspace::default());
        for (i, &got) in normals.as_slice().iter().enumerate() {
            assert!(Vec3::from(got).dot(n) > 0.99999, "at {} {}: {got:?}", i % 60, i / 60);
        }
    }

    #[test]
    fn no_window_reaches_across_a_depth_change() {
        // Two walls that face the camera, 0.5 m apart: no normal may be bent by the step.
        let points = points(|u, _| if u < 30 { 1.0 } else { 1.5 });
        let normals = normals(&points, &params::Normals::default(), &mut Workspace::default());
        for (i, &got) in normals.as_slice().iter().enumerate() {
            let near_step = (28..32).contains(&(i % 60));
            assert!(
                if near_step { got == [0.0; 3] || got[2] < -0.9999 } else { got[2] < -0.9999 },
                "{i}: {got:?}"
            );
        }
        assert_eq!(normals[20 * 60 + 29], [0.0; 3], "beside the step there is no normal");
    }

    #[test]
    fn the_window_stays_strictly_nearer_than_the_change() {
        // The square of half size h touches a change at its corner when the distance is sqrt(2) h.
        assert_eq!(
            [1, 2, 3, 8, 9, 18, 19, 50, 51, 99].map(|d| half_window(d, 5)),
            [0, 0, 1, 1, 2, 2, 3, 4, 5, 5]
        );
    }

    /// The normal of pixel `i` from the words of the documentation: window by search, tangents by loops.
    fn naive(points: &Raster<[f32; 3]>, i: usize, params: &params::Normals) -> Vec3 {
        let (width, height) = points.size();
        let at = |u: usize, v: usize| (u < width && v < height).then(|| Vec3::from(points[v * width + u]));
        let differ = |p: Vec3, q: Vec3| {
            let z = p.z.max(q.z);
            p.z.is_nan() != q.z.is_nan() || (p.z - q.z).abs() > params.depth_change_per_m * z * z
        };
        let (u, v) = (i % width, i / width);
        let mut nearest = usize::MAX;
        for (q, p) in (0..height).flat_map(|q| (0..width).map(move |p| (q, p))) {
            let here = at(p, q).unwrap();
            let around = [at(p + 1, q), at(p, q + 1), at(p.wrapping_sub(1), q), at(p, q.wrapping_sub(1))];
            if around.into_iter().flatten().any(|n| differ(here, n)) {
                nearest = nearest.min(p.abs_diff(u).pow(2) + q.abs_diff(v).pow(2));
            }
        }
        let limit = (params.window_px / 2.0).floor() as usize;
        let Some(half) = (1..=limit).rev().find(|h| 2 * h * h < nearest) else { return Vec3::ZERO };
        let (mut along_u, mut along_v, mut pairs) = (DVec3::ZERO, DVec3::ZERO, [0, 0]);
        for (q, p) in (0..height).flat_map(|q| (0..width).map(move |p| (q, p))) {
            if p.abs_diff(u) <= half && q.abs_diff(v) <= half {
                let here = at(p, q).unwrap();
                let step = |next: Option<Vec3>| {
                    next.filter(|n| !here.z.is_nan() && !differ(here, *n))
                        .map(|n| n.as_dvec3() - here.as_dvec3())
                };
                let (right, down) = (step(at(p + 1, q)), step(at(p, q + 1)));
                along_u += right.unwrap_or_default();
                along_v += down.unwrap_or_default();
                pairs = [pairs[0] + right.iter().count(), pairs[1] + down.iter().count()];
            }
        }
        let here = at(u, v).unwrap().as_dvec3();
        if here.z.is_nan() || pairs.contains(&0) {
            return Vec3::ZERO;
        }
        let normal = along_u.cross(along_v).normalize();
        (if normal.dot(here) > 0.0 { -normal } else { normal }).as_vec3()
    }

    proptest! {
        #[test]
        fn normals_are_the_naive_ones(
            (width, pixels) in (1_usize..15, 1_usize..15).prop_flat_map(|(w, h)| {
                (Just(w), prop::collection::vec((0.0_f32..0.012, 0_u8..60), w * h))
            }),
            (step_u, step_v) in (0_usize..20, 0_usize..20),
            window_px in 2.0_f64..15.0,
        ) {
            // A rough wall with holes and spikes; what is right of and below the step lies deeper.
            let z = pixels.iter().enumerate().map(|(i, &(rough, kind))| match kind {
                0 => f32::NAN,
                1 => 1.2,
                _ if i % width > step_u && i / width > step_v => 1.1 + rough,
                _ => 1.0 + rough,
            });
            let mut z = Raster::from_vec(width, pixels.len() / width, z.collect()).unwrap();
            z.as_mut_slice()[0] = 1.0;
            let camera = Camera::new(60.0, 60.0, 6.0, 7.0).unwrap();
            let points = Frame::new(z, None, camera).unwrap().points_m();
            let params = params::Normals { window_px, ..Default::default() };
            let got = normals(&points, &params, &mut Workspace::default());
            for i in 0..points.len() {
                let expected = naive(&points, i, &params);
                prop_assert!(Vec3::from(got[i]).distance(expected) < 1e-4, "{}: {:?} {}", i, got[i], expected);
            }
        }
    }
}
