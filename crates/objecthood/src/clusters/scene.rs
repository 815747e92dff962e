//! What the rules look at.

use crate::facets::Facets;
use crate::oversegment::structure::StructureSurface;
use crate::params;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};

/// What stage 4 looks at besides the clusters: it stays as it is.
pub(crate) struct Scene<'a> {
    /// Facets and structure after [`fill`](crate::clusters::fill::fill).
    pub facets: &'a Facets,
    pub disparity: &'a Raster<f32>,
    pub normals: &'a Raster<[f32; 3]>,
    pub points_m: &'a Raster<[f32; 3]>,
    pub color: Option<&'a Raster<[u8; 3]>>,
    pub space: &'a DisparitySpace,
    /// What objects stand on.
    pub support: Option<&'a StructureSurface>,
    pub steps: Steps,
}

/// Largest differences in disparity (quanta) that are no step in depth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps {
    /// Between pixels side by side.
    pub touch_quanta: f32,
    /// Across a gap.
    pub level_quanta: f32,
}

impl Steps {
    /// What a link of the watershed allows; side by side one quantum more, as much as rounding makes.
    pub(crate) fn of(params: &params::Watershed) -> Self {
        Self { touch_quanta: params.link_jump_quanta + 1.0, level_quanta: params.link_jump_quanta }
    }

    /// Whether there is no step between two pixels side by side.
    pub(crate) fn touch(self, disparity: &Raster<f32>, i: usize, j: usize) -> bool {
        (disparity[j] - disparity[i]).abs() <= self.touch_quanta
    }
}

impl Scene<'_> {
    /// Height (m) of a pixel above a surface.
    pub(crate) fn height_m(&self, i: usize, support: &StructureSurface) -> f64 {
        support.height_m(position(i, self.disparity.width()), f64::from(self.disparity[i]), self.space)
    }
}
