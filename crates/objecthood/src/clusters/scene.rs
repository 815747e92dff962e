//! What the rules look at.

use crate::facets::Facets;
use crate::frame::Frame;
use crate::oversegment::structure::{Structure, StructureSurface};
use crate::params;
use crate::raster::Raster;
use crate::regions::SegmentId;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::surfaces::Surfaces;

/// What stage 4 looks at besides the clusters: it stays as it is.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Facets and structure after [`fill`](crate::clusters::fill::fill).
    pub facets: &'a Facets,
    /// Disparity (quanta); `NaN` without depth.
    pub disparity: &'a Raster<f32>,
    /// Unit normals towards the camera; zero where there is none.
    pub normals: &'a Raster<[f32; 3]>,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// Colour, if the frame has any.
    pub color: Option<&'a Raster<[u8; 3]>>,
    /// The camera and its noise.
    pub space: &'a DisparitySpace,
    /// What objects stand on.
    pub support: Option<&'a StructureSurface>,
    /// Which facet that is.
    pub support_facet: Option<SegmentId>,
    /// How much disparity may differ without a step in depth.
    pub steps: Steps,
}

impl<'a> Scene<'a> {
    /// What a frame looks like once its facets are there. `filled`: the facets after [`fill`](crate::clusters::fill::fill).
    pub fn new(
        frame: &'a Frame,
        surfaces: &'a Surfaces,
        structure: &'a Structure,
        filled: &'a Facets,
        points_m: &'a Raster<[f32; 3]>,
        steps: Steps,
    ) -> Self {
        Self {
            facets: filled,
            disparity: &surfaces.disparity,
            normals: &surfaces.orientation.normal,
            points_m,
            color: frame.color(),
            space: &surfaces.space,
            support: structure.support.map(|surface| &structure.surfaces[surface]),
            support_facet: structure.support.map(|surface| SegmentId(surface as u32)),
            steps,
        }
    }
}

/// Largest differences in disparity (quanta) that are no step in depth.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// Between pixels side by side.
    pub touch_quanta: f32,
    /// Across a gap.
    pub level_quanta: f32,
}

impl Steps {
    /// What a link of the watershed allows; side by side one quantum more, as much as rounding makes.
    pub fn of(params: &params::Watershed) -> Self {
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
