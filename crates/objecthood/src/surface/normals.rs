//! Surface normals from sums along rows and columns.
//!
//! The tangents ∂X/∂u and ∂X/∂v are averaged over a window that does not reach across a depth change; their
//! cross product is the normal (Holzer et al., IROS 2012: average 3-D gradient; paper, III-A; PARITY.md 1).
//!
//! 1. mark depth changes, 2. distance to the nearest one, 3. window half size from it, 4. sums along rows and columns,
//!    5. cross product, turned towards the camera.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;
use crate::surface::depth_change::measure_squared_distances;

/// Rows whose sums along columns begin together. Fixed, so that rounding does not depend on the number of threads.
const BAND_ROWS: usize = 32;

/// Measures the unit normal of every pixel, towards the camera (n · X < 0). It is zero without depth, or where a depth change is
/// so near that no window fits.
///
/// No window holds a depth change, so its tangents form chains of neighbours, and the sum of a chain is its last point less its
/// first (a telescoping sum). The end points are summed along rows and columns in f64; four sums give the average tangent of a
/// direction. Where the window stays the same from pixel to pixel, the sums of a whole stretch lie side by side in memory.
///
/// `points_m`: camera frame (m), `NaN` = none. O(pixels · window) for the distances, else O(pixels); parallel over bands of rows.
pub fn measure_normals(points_m: &Raster<[f32; 3]>, params: &params::Normals) -> Raster<[f32; 3]> {
    let windows = Windows::choose(points_m, params);
    let width = points_m.width();
    let mut normals = Buffer::stale(points_m.len(), [0.0; 3]);
    normals.par_chunks_mut(BAND_ROWS * width).enumerate().for_each_init(
        || (LineSums::default(), Tangents::of_width(width)),
        |(sums, tangents), (band, normals)| {
            vectorized(
                #[inline(always)]
                || windows.measure_band(band, sums, tangents, normals),
            );
        },
    );
    points_m.with_data(normals)
}

/// The window of every pixel: as large as the nearest depth change allows.
struct Windows<'a> {
    points_m: &'a Raster<[f32; 3]>,
    /// Largest half size (px).
    half_limit: usize,
    /// Squared distance (px^2) of every pixel from a depth change.
    squared_distance: Raster<i16>,
    /// The half size (px) that each squared distance allows.
    half: Vec<u16>,
}

impl<'a> Windows<'a> {
    fn choose(points_m: &'a Raster<[f32; 3]>, params: &params::Normals) -> Self {
        let half_limit = (params.window_px / 2.0) as usize;
        // A square of half size h reaches sqrt(2) h at its corners.
        let reach = half_limit * 3 / 2 + 1;
        let z = points_m.with_data(points_m.as_slice().iter().map(|p| p[2]).collect());
        let squared_distance = measure_squared_distances(&z, params.depth_change_per_m, reach);
        let half = (0..=reach * reach + 1).map(|d| half_window(d, half_limit) as u16).collect();
        Self { points_m, half_limit, squared_distance, half }
    }

    /// Measures the normals of a band of rows.
    #[inline(always)]
    fn measure_band(
        &self,
        band: usize,
        sums: &mut LineSums,
        tangents: &mut Tangents,
        normals: &mut [[f32; 3]],
    ) {
        let (width, height) = self.points_m.size();
        let rows = band * BAND_ROWS..height.min((band + 1) * BAND_ROWS);
        let first = rows.start.saturating_sub(self.half_limit);
        sums.clear(width, self.half_limit, first);
        let mut next = first;
        for (v, normals) in rows.zip(normals.chunks_exact_mut(width)) {
            // The tangents of the largest window end in row v + `half_limit` + 1.
            while next < height.min(v + self.half_limit + 2) {
                sums.add(next, &self.points_m.as_slice()[next * width..][..width]);
                next += 1;
            }
            let row = v * width..(v + 1) * width;
            let points = &self.points_m.as_slice()[row.clone()];
            let distances = &self.squared_distance.as_slice()[row];
            for (half, (point, distance)) in tangents.half.iter_mut().zip(points.iter().zip(distances)) {
                *half = if point[2].is_nan() { 0 } else { self.half[*distance as usize] };
            }
            tangents.take(sums, v, height);
            tangents.normals(points, normals);
        }
    }
}

/// Sums of points along rows and along columns, for the rows that the windows of one row need. x, y and z have separate lists.
#[derive(Default)]
struct LineSums {
    width: usize,
    /// Number of rows held; row v is at place v % `held`.
    held: usize,
    /// The points of one row; zero without depth.
    row: [Vec<f64>; 3],
    /// The sum over the pixels before each pixel in its row; one entry more holds the sum over the whole row.
    before: [Vec<f64>; 3],
    /// The sum over the pixels above each pixel in its column, from the first row added on; one row more than was added.
    above: [Vec<f64>; 3],
}

impl LineSums {
    /// Starts again at row `first`, for windows of half size up to `half_limit`.
    #[inline(always)]
    fn clear(&mut self, width: usize, half_limit: usize, first: usize) {
        (self.width, self.held) = (width, 2 * half_limit + 3);
        for k in 0..3 {
            self.row[k].resize(width, 0.0);
            self.before[k].resize(self.held * (width + 1), 0.0);
            self.above[k].resize(self.held * width, 0.0);
            self.above[k][first % self.held * width..][..width].fill(0.0);
        }
    }

    /// Adds row `v`, the next one below.
    #[inline(always)]
    fn add(&mut self, v: usize, points_m: &[[f32; 3]]) {
        let (width, own, next) = (self.width, v % self.held, (v + 1) % self.held);
        let points_m = &points_m[..width];
        let [x, y, z] = self.row.each_mut().map(|axis| &mut axis[..width]);
        for u in 0..width {
            let point = points_m[u].map(f64::from);
            [x[u], y[u], z[u]] = if point[2].is_nan() { [0.0; 3] } else { point };
        }
        for (above, row) in self.above.iter_mut().zip([&*x, &*y, &*z]) {
            above.copy_within(own * width..(own + 1) * width, next * width);
            above[next * width..].iter_mut().zip(row).for_each(|(above, x)| *above += x);
        }
        // One pixel after the other, but the three axes side by side.
        let before = self.before.each_mut().map(|before| &mut before[own * (width + 1)..][..=width]);
        let mut sum = DVec3::ZERO;
        for u in 0..width {
            (0..3).for_each(|k| before[k][u] = sum[k]);
            sum += DVec3::new(x[u], y[u], z[u]);
        }
        (0..3).for_each(|k| before[k][width] = sum[k]);
    }

    /// The sums above `count` pixels of row `v` from column `u` on, along one axis.
    #[inline(always)]
    fn above(&self, axis: usize, u: usize, v: usize, count: usize) -> &[f64] {
        &self.above[axis][v % self.held * self.width + u..][..count]
    }

    /// The sums before `count` pixels of row `v` from column `u` on, along one axis.
    #[inline(always)]
    fn before(&self, axis: usize, u: usize, v: usize, count: usize) -> &[f64] {
        &self.before[axis][v % self.held * (self.width + 1) + u..][..count]
    }
}

/// The tangents of the pixels of a row; x, y and z have separate lists.
struct Tangents {
    /// Half size of each pixel's window; 0 where there is none.
    half: Vec<u16>,
    along_u: [Vec<f64>; 3],
    along_v: [Vec<f64>; 3],
}

impl Tangents {
    fn of_width(width: usize) -> Self {
        let empty = || [0; 3].map(|_| vec![0.0; width]);
        Self { half: vec![0; width], along_u: empty(), along_v: empty() }
    }

    /// Computes the tangents from the sums. Stretches of pixels with windows of one size are computed together.
    #[inline(always)]
    fn take(&mut self, sums: &LineSums, v: usize, height: usize) {
        let width = sums.width;
        let mut next = 0;
        while let Some(&half) = self.half.get(next) {
            let (u, h) = (next, usize::from(half));
            // The windows and tangents of a stretch must lie in the image; near the image border a stretch is one pixel.
            let inner = h..width.saturating_sub(h + 1);
            let end = if inner.contains(&u) { inner.end } else { u + 1 };
            let pixels = self.half[u..end].iter().take_while(|other| **other == half).count();
            next += pixels;
            if half == 0 {
                continue;
            }
            let (us, ue) = (u.saturating_sub(h), (u + h + 1).min(width));
            let (vs, ve) = (v.saturating_sub(h), (v + h + 1).min(height));
            // Tangents end one pixel farther, unless that lies outside the image.
            let (last_u, last_v) = (ue.min(width - 1), ve.min(height - 1));
            for k in 0..3 {
                let above = |u: usize, v: usize| sums.above(k, u, v, pixels);
                let ends = [[above(last_u, ve), above(last_u, vs)], [above(us, ve), above(us, vs)]];
                telescope(&mut self.along_u[k][u..u + pixels], ends);
                let before = |u: usize, v: usize| sums.before(k, u, v, pixels);
                let ends = [[before(ue, last_v), before(us, last_v)], [before(ue, vs), before(us, vs)]];
                telescope(&mut self.along_v[k][u..u + pixels], ends);
            }
        }
    }

    /// The unit normals of the pixels, towards the camera; zero where there is no window.
    #[inline(always)]
    fn normals(&self, points_m: &[[f32; 3]], normals: &mut [[f32; 3]]) {
        let Self { half, along_u: [ux, uy, uz], along_v: [vx, vy, vz] } = self;
        let along_u = ux.iter().zip(uy).zip(uz).map(|((x, y), z)| DVec3::new(*x, *y, *z));
        let along_v = vx.iter().zip(vy).zip(vz).map(|((x, y), z)| DVec3::new(*x, *y, *z));
        let pixels = normals.iter_mut().zip(points_m).zip(half);
        for (((normal, point), half), (along_u, along_v)) in pixels.zip(along_u.zip(along_v)) {
            let cross = along_u.cross(along_v);
            let towards_camera = -cross.dot(Vec3::from(*point).as_dvec3()).signum();
            let unit = (cross.normalize_or_zero() * towards_camera).as_vec3();
            *normal = if *half == 0 { [0.0; 3] } else { unit.to_array() };
        }
    }
}

/// The sums over the last points of the windows minus the sums over their first points. Each is the difference of two line sums.
#[inline(always)]
fn telescope(along: &mut [f64], [[last, before_last], [first, before_first]]: [[&[f64]; 2]; 2]) {
    let ends = last.iter().zip(before_last).zip(first.iter().zip(before_first));
    for (along, ((last, before_last), (first, before_first))) in along.iter_mut().zip(ends) {
        *along = (last - before_last) - (first - before_first);
    }
}

/// The largest half size h up to `limit` (px) whose window does not reach the depth change, not even with its corners.
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

    /// The points of a camera of 60 x 40 pixels with z = `depth(u, v)`.
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
        let normals = measure_normals(&points, &params);
        for (i, &got) in normals.as_slice().iter().enumerate() {
            assert!(Vec3::from(got).dot(n) > 0.99999, "at {} {}: {got:?}", i % 60, i / 60);
        }
    }

    #[test]
    fn no_window_reaches_across_a_depth_change() {
        // Two walls that face the camera, 0.5 m apart: the step must not bend any normal.
        let points = points(|u, _| if u < 30 { 1.0 } else { 1.5 });
        let normals = measure_normals(&points, &params::Normals::default());
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

    /// The normal of pixel `i` as documented: window by search, tangents by loops.
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
            // Small images, and images higher than a band.
            (width, pixels) in prop_oneof![
                3 => (1_usize..15, 1_usize..15),
                1 => (1_usize..9, BAND_ROWS - 2..2 * BAND_ROWS),
            ]
            .prop_flat_map(|(w, h)| (Just(w), prop::collection::vec((0.0_f32..0.012, 0_u8..60), w * h))),
            (step_u, step_v) in (0_usize..20, 0_usize..20),
            window_px in 2.0_f64..15.0,
        ) {
            // A rough wall with holes and spikes; right of and below the step it lies deeper.
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
            let got = measure_normals(&points, &params);
            for i in 0..points.len() {
                let expected = naive(&points, i, &params);
                prop_assert!(Vec3::from(got[i]).distance(expected) < 1e-4, "{}: {:?} {}", i, got[i], expected);
            }
        }
    }
}
