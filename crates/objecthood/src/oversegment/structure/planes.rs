//! Planes fitted to all pixels of a surface.

use glam::DVec3;

use super::surface::StructureSurface;
use crate::camera::Camera;
use crate::planes::{PointSums, StructurePlane};
use crate::raster::Raster;
use crate::regions::runs;
use crate::simd::vectorized;

/// The surfaces as planes, each fitted to its own pixels. Their inlier shares are counted later, by `Candidates::count_inliers`.
/// O(pixels).
pub(super) fn fit_planes(
    surfaces: &[StructureSurface],
    labels: &Raster<i32>,
    depth_m: &Raster<f32>,
    camera: &Camera,
) -> Vec<StructurePlane> {
    let width = depth_m.width();
    let rays: Vec<f64> = (0..width).map(|u| camera.ray(u as f64, 0.0)[0]).collect();
    let mut own = vec![LaneSums::default(); surfaces.len()];
    for (run, surface) in runs(labels, 0..depth_m.height()) {
        let (u, v) = (run.start % width, run.start / width);
        let ray_y = camera.ray(0.0, v as f64)[1];
        let rays = &rays[u..u + run.len()];
        vectorized(
            #[inline(always)]
            || own[surface].add(rays, ray_y, &depth_m.as_slice()[run]),
        );
    }
    let own = own.iter().map(LaneSums::total);
    let plane = |(surface, own): (&StructureSurface, PointSums)| {
        let (normal, offset_m) = (surface.normal.as_vec3().to_array(), surface.offset_m as f32);
        own.fit_plane().unwrap_or(StructurePlane { normal, offset_m, inlier_share: 0.0 })
    };
    surfaces.iter().zip(own).map(plane).collect()
}

/// Lanes of the sums, to which points are added side by side.
const LANES: usize = 8;

/// Sums over points in lanes; each point adds to one lane.
#[derive(Clone, Default)]
struct LaneSums {
    /// 1, x, y, z, xx, yy, zz, xy, yz, zx.
    sums: [[f64; LANES]; 10],
}

impl LaneSums {
    /// Adds points of one row, with depths `z_m`. Their rays have z = 1, these x and this y.
    #[inline(always)]
    fn add(&mut self, rays_x: &[f64], ray_y: f64, z_m: &[f32]) {
        let mut sums = self.sums;
        let (rays, depths) = (rays_x.chunks_exact(LANES), z_m.chunks_exact(LANES));
        // The free lanes at the end have depth 0 and count 0 and add nothing.
        let (mut last_rays, mut last_depths, mut last_counts) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for (lane, (ray, z)) in rays.remainder().iter().zip(depths.remainder()).enumerate() {
            (last_rays[lane], last_depths[lane], last_counts[lane]) = (*ray, *z, 1.0);
        }
        let mut add = |rays: &[f64; LANES], depths: &[f32; LANES], counts: &[f64; LANES]| {
            for lane in 0..LANES {
                // A hole that was bridged lies on the surface, but has no point.
                let (z, count) = match depths[lane] {
                    z if z.is_nan() => (0.0, 0.0),
                    z => (f64::from(z), counts[lane]),
                };
                // Rounded to 32 bits, as the points of a frame are.
                let [x, y] = [rays[lane] * z, ray_y * z].map(|x| f64::from(x as f32));
                let terms = [count, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x];
                for (sum, term) in sums.iter_mut().zip(terms) {
                    sum[lane] += term;
                }
            }
        };
        for (rays, depths) in rays.zip(depths) {
            if let (Ok(rays), Ok(depths)) = (rays.try_into(), depths.try_into()) {
                add(rays, depths, &[1.0; LANES]);
            }
        }
        add(&last_rays, &last_depths, &last_counts);
        self.sums = sums;
    }

    fn total(&self) -> PointSums {
        let [n, x, y, z, xx, yy, zz, xy, yz, zx] = self.sums.map(|lanes| lanes.iter().sum());
        PointSums::new(n, DVec3::new(x, y, z), DVec3::new(xx, yy, zz), DVec3::new(xy, yz, zx))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::kinect;

    proptest! {
        #[test]
        fn lanes_add_what_points_do_every_eighth_to_the_same(depths_m in prop::collection::vec(0.3_f32..4.0, 0..40), v in 0_usize..480) {
            let camera = kinect().camera();
            let rays: Vec<f64> = (0..depths_m.len()).map(|u| camera.ray(u as f64, 0.0)[0]).collect();
            let (mut lanes, mut expected) = (LaneSums::default(), [[0.0; LANES]; 10]);
            lanes.add(&rays, camera.ray(0.0, v as f64)[1], &depths_m);
            for (u, &z_m) in depths_m.iter().enumerate() {
                let [x, y, z] = camera.back_project(u, v, z_m).map(f64::from);
                let terms = [1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, z * x];
                expected.iter_mut().zip(terms).for_each(|(sum, term)| sum[u % LANES] += term);
            }
            // Equal to the bit except for the sign of zeros: the sums have the same order as in the released planes.
            prop_assert_eq!(lanes.sums, expected);
        }
    }
}
