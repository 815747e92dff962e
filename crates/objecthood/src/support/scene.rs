//! The scene: regions in space, some of which carry others.

use glam::DVec3;

use crate::discovery::up::Up;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::disparity::DisparitySpace;

/// Regions in space, and the direction up. All rasters are of one size.
#[derive(Clone, Copy, Debug)]
pub struct SupportScene<'a> {
    /// First the structure, where region k lies on `planes[k]`, then the things.
    pub regions: &'a Segments,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// Unit normals; zero where there is none.
    pub normals: &'a Raster<[f32; 3]>,
    /// The planes of the structure.
    pub planes: &'a [StructurePlane],
    /// The direction against gravity.
    pub up: &'a Up,
    /// The camera and the sensor's noise.
    pub space: &'a DisparitySpace,
}

impl SupportScene<'_> {
    /// The point (m) at pixel `i`; `NaN` without depth.
    pub(super) fn point_at(&self, i: usize) -> DVec3 {
        DVec3::from(self.points_m[i].map(f64::from))
    }
}
