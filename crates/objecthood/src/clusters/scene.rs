//! The scene: the inputs of the rules besides the clusters.

use glam::DVec3;

use crate::clusters::steps::StepLimits;
use crate::color::image::LabImage;
use crate::facets::Facets;
use crate::frame::Frame;
use crate::oversegment::structure::{Structure, StructureSurface};
use crate::params::ColorFor;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::SegmentId;
use crate::shapes::seams::{Cuts, Seams};
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::surfaces::Surfaces;

/// About this many pixels of a cluster are sampled for quantiles.
const SAMPLED_PX: usize = 200;

/// A pixel within this angle of level can carry a foot (degrees): what stands on more slides off.
pub(crate) const LEVEL_DEG: f64 = 25.0;

/// The inputs of the rules besides the clusters. The rules do not change them.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Facets and structure after [`fill_facets`](crate::clusters::fill::fill_facets).
    pub facets: &'a Facets,
    /// Disparity (quanta); `NaN` without depth.
    pub disparity: &'a Raster<f32>,
    /// Unit normals towards the camera; zero where there is none.
    pub normals: &'a Raster<[f32; 3]>,
    /// Points (m); `NaN` without depth.
    pub points_m: &'a Raster<[f32; 3]>,
    /// Colour, if the frame has any and the rules use it.
    pub color: Option<&'a Raster<[u8; 3]>>,
    /// The colours as they are compared.
    pub lab: Option<&'a LabImage>,
    /// The camera and the sensor's noise.
    pub space: &'a DisparitySpace,
    /// The surfaces of the structure; surface k is facet k.
    pub surfaces: &'a [StructureSurface],
    /// The same as planes, fitted to all their pixels.
    pub planes: &'a [StructurePlane],
    /// The surfaces on which things stand, the ground first.
    pub supports: &'a [usize],
    /// The largest differences in disparity that are no step.
    pub steps: StepLimits,
    /// Whether the sensor smears edges over several pixels (docs/CONTEXT.md 0.7).
    pub is_smeared: bool,
    /// The seams that cut facets; `None` without seams.
    pub cuts: Option<&'a Cuts>,
}

/// About [`SAMPLED_PX`] of the pixels of a cluster, evenly spread.
pub(crate) fn sampled(pixels: &[u32]) -> impl Iterator<Item = usize> {
    let step = pixels.len().div_ceil(SAMPLED_PX).max(1);
    pixels.iter().step_by(step).map(|&i| i as usize)
}

/// The share of the pixels of a cluster that face up, to [`LEVEL_DEG`].
pub(crate) fn level_share(scene: &Scene<'_>, up: DVec3, pixels: &[u32]) -> f64 {
    let (mut level, mut all) = (0_u32, 0_u32);
    for i in sampled(pixels) {
        level += u32::from(scene.is_level(up, i));
        all += 1;
    }
    f64::from(level) / f64::from(all.max(1))
}

impl<'a> Scene<'a> {
    /// The scene of a frame. `filled`: the facets after [`fill_facets`](crate::clusters::fill::fill_facets).
    pub fn new(
        frame: &'a Frame,
        surfaces: &'a Surfaces,
        structure: &'a Structure,
        filled: &'a Facets,
        points_m: &'a Raster<[f32; 3]>,
        steps: StepLimits,
    ) -> Self {
        Self {
            facets: filled,
            disparity: &surfaces.disparity,
            normals: &surfaces.orientation.normal,
            points_m,
            color: frame.color().filter(|_| surfaces.color == ColorFor::All),
            lab: surfaces.lab_for_shapes(),
            space: &surfaces.space,
            surfaces: &structure.surfaces,
            planes: &structure.planes,
            supports: &structure.supports.surfaces,
            steps,
            is_smeared: surfaces.sharpened_share > 0.0,
            cuts: None,
        }
    }

    /// The same with the seams that cut its facets, if there are any.
    #[must_use]
    pub fn with_seams(self, seams: Option<&'a Seams>) -> Self {
        Self { cuts: seams.map(|seams| &seams.cuts), ..self }
    }
}

impl<'a> Scene<'a> {
    /// Whether a pixel faces up, to [`LEVEL_DEG`].
    pub(crate) fn is_level(&self, up: DVec3, i: usize) -> bool {
        up.dot(DVec3::from(self.normals[i].map(f64::from))) > libm::cos(LEVEL_DEG.to_radians())
    }

    /// The surface on which most stands.
    pub(crate) fn ground(&self) -> Option<&'a StructureSurface> {
        self.supports.first().map(|&ground| &self.surfaces[ground])
    }

    /// The facet of that surface.
    pub(crate) fn ground_facet(&self) -> Option<SegmentId> {
        self.supports.first().map(|&ground| SegmentId(ground as u32))
    }

    /// The facet of the support nearest to a pixel, along the normals of the supports.
    pub(crate) fn nearest_support(&self, i: usize) -> Option<SegmentId> {
        let distance_m = |&k: &usize| self.height_over_m(i, k).abs();
        let nearest = self.supports.iter().copied().min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)));
        nearest.map(|k| SegmentId(k as u32))
    }

    /// The point (m) on the surface that a pixel shows, from its disparity.
    pub(crate) fn point_at(&self, i: usize) -> DVec3 {
        DVec3::from(self.space.point_m(position(i, self.disparity.width()), self.disparity[i].into()))
    }

    /// The points (m) of about [`SAMPLED_PX`] of the pixels of a cluster, evenly spread.
    pub(crate) fn sampled_points(&self, pixels: &[u32]) -> impl Iterator<Item = DVec3> {
        sampled(pixels).map(|i| self.point_at(i))
    }

    /// Height (m) of a pixel above a surface.
    pub(crate) fn height_m(&self, i: usize, support: &StructureSurface) -> f64 {
        support.height_m(position(i, self.disparity.width()), f64::from(self.disparity[i]), self.space)
    }
}
