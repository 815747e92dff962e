//! The position and direction of a region: mean point and mean normal (paper, eq. 4).

use std::ops::Range;

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
    /// Mean of its unit normals, not normalised: the more the region bends, the shorter it is. Zero without normals.
    pub normal: [f64; 3],
    /// Core pixels with a normal.
    pub core_normals: u32,
}

/// Describes every region by its core pixels with depth, or by all its pixels with depth if the core has fewer than ten.
///
/// Sums are f64 in scan order. O(pixels).
pub fn describe_regions(
    segments: &Segments,
    core: &Raster<bool>,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
) -> Vec<Descriptor> {
    let pixels = |run: Range<usize>| {
        let of_run = core.as_slice()[run.clone()].iter().zip(&points_m.as_slice()[run.clone()]);
        of_run.zip(&normals.as_slice()[run]).map(|((core, point), normal)| (*core, *point, *normal))
    };
    let mut core_points = vec![0; segments.count()];
    for (run, s) in segments.runs() {
        core_points[s] += pixels(run).map(|(core, [.., z], _)| u32::from(core & !z.is_nan())).sum::<u32>();
    }
    let mut sums = vec![RegionSums::default(); segments.count()];
    for (run, s) in segments.runs() {
        let is_core_enough = core_points[s] >= MIN_CORE_POINTS;
        let measured = pixels(run).filter(|(_, [.., z], _)| !z.is_nan());
        let mut own = sums[s];
        for (core, point, normal) in measured.filter(|(core, ..)| *core || !is_core_enough) {
            own.add(core, point, normal);
        }
        sums[s] = own;
    }
    let described = |sums: RegionSums| Descriptor {
        centroid_m: (sums.point / f64::from(sums.points.max(1))).to_array(),
        normal: (sums.normal / f64::from(sums.normals.max(1))).to_array(),
        core_normals: sums.core_normals,
    };
    sums.into_iter().map(described).collect()
}

#[derive(Clone, Copy, Default)]
/// Sums over the pixels of a region.
struct RegionSums {
    point: DVec3,
    normal: DVec3,
    points: u32,
    normals: u32,
    core_normals: u32,
}

impl RegionSums {
    /// Adds a point and its normal; a normal of zero is not counted.
    #[inline]
    fn add(&mut self, core: bool, point: [f32; 3], normal: [f32; 3]) {
        let has_normal = normal != [0.0; 3];
        self.point += Vec3::from(point).as_dvec3();
        self.normal += Vec3::from(normal).as_dvec3();
        self.points += 1;
        self.normals += u32::from(has_normal);
        self.core_normals += u32::from(has_normal & core);
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

        let many = describe_regions(&segments, &core(12), &points, &normals)[0];
        assert_eq!((many.centroid_m, many.core_normals), ([0.0, 0.0, 1.0], 6));
        let few = describe_regions(&segments, &core(9), &points, &normals)[0];
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
            describe_regions(&Segments::from_labels(&labels), &core, &points, &normals)[0].centroid_m[0]
        };
        assert_eq!((x_of(9), x_of(10)), (0.5, 0.0));
    }
}
