//! Where a region lies and which way it faces (paper, eq. 4).

use glam::{DVec3, Vec3};

use crate::raster::Raster;
use crate::regions::Segments;

/// A region with fewer core points than this is described by all its points.
const MIN_CORE_POINTS: u32 = 10;

/// Centre and mean normal of one region.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Descriptor {
    /// Mean of its points, camera frame (m); zero without points.
    pub centroid_m: [f64; 3],
    /// Mean of its unit normals, not made unit again: the shorter, the more the region bends. Zero without any.
    pub normal: [f64; 3],
    /// Core pixels with a normal.
    pub core_normals: u32,
}

/// Describes every region by its core pixels with depth; with fewer than ten of them by all pixels with depth.
///
/// Sums are f64 in scan order. O(pixels).
pub fn descriptors(
    segments: &Segments,
    core: &Raster<bool>,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
) -> Vec<Descriptor> {
    let mut core_sums = vec![Sums::default(); segments.count()];
    let mut all_sums = vec![Sums::default(); segments.count()];
    for (i, s) in segments.members().filter(|&(i, _)| !points_m[i][2].is_nan()) {
        all_sums[s].add(points_m[i], normals[i]);
        if core[i] {
            core_sums[s].add(points_m[i], normals[i]);
        }
    }
    core_sums
        .iter()
        .zip(&all_sums)
        .map(|(core, all)| {
            let speaking = if core.points >= MIN_CORE_POINTS { core } else { all };
            Descriptor {
                centroid_m: (speaking.point / f64::from(speaking.points.max(1))).to_array(),
                normal: (speaking.normal / f64::from(speaking.normals.max(1))).to_array(),
                core_normals: core.normals,
            }
        })
        .collect()
}

#[derive(Clone, Default)]
struct Sums {
    point: DVec3,
    normal: DVec3,
    points: u32,
    normals: u32,
}

impl Sums {
    fn add(&mut self, point: [f32; 3], normal: [f32; 3]) {
        self.point += Vec3::from(point).as_dvec3();
        self.points += 1;
        if normal != [0.0; 3] {
            self.normal += Vec3::from(normal).as_dvec3();
            self.normals += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn core_pixels_speak_unless_they_are_few() {
        // Twelve core pixels at x = 0 and four others at x = 1.
        let labels = Raster::filled(16, 1, 0).unwrap();
        let segments = Segments::from_labels(&labels);
        let x_of = |i: usize| if i < 12 { 0.0 } else { 1.0 };
        let points = labels.with_data((0..16).map(|i| [x_of(i), 0.0, 1.0]).collect());
        let normals =
            labels.with_data((0..16).map(|i| if i % 2 == 0 { [0.0, 0.0, -1.0] } else { [0.0; 3] }).collect());
        let core = |count: usize| labels.with_data((0..16).map(|i| i < count).collect());

        let many = descriptors(&segments, &core(12), &points, &normals)[0];
        assert_eq!((many.centroid_m, many.core_normals), ([0.0, 0.0, 1.0], 6));
        let few = descriptors(&segments, &core(9), &points, &normals)[0];
        assert_eq!((few.centroid_m, few.core_normals), ([0.25, 0.0, 1.0], 5));
        assert_eq!(few.normal, [0.0, 0.0, -1.0], "the mean is over the normals that there are");
    }

    #[test]
    fn ten_core_points_are_enough_to_speak() {
        // The first half lies at x = 0, the other at x = 1.
        let labels = Raster::filled(20, 1, 0).unwrap();
        let points = labels.with_data((0..20).map(|i| [(i / 10) as f32, 0.0, 1.0]).collect());
        let normals = labels.map(|_| [0.0, 0.0, -1.0]);
        let x_of = |core: usize| {
            let core = labels.with_data((0..20).map(|i| i < core).collect());
            descriptors(&Segments::from_labels(&labels), &core, &points, &normals)[0].centroid_m[0]
        };
        assert_eq!((x_of(9), x_of(10)), (0.5, 0.0));
    }
}
