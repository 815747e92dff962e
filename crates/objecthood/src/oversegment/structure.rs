//! Structure planes: large surfaces that carry or enclose the objects (docs/CONTEXT.md 1.1).
//!
//! They are found and removed first: objects stand on them or in front of them, "up" and "height" follow from
//! them, and every later stage is cheaper without their pixels. The steps have the numbers of their sections,
//! and run in this order:
//!
//! - 1.1.1: `candidates` are searched for in a grid of pixels; their `size` decides.
//! - 1.1.2: `labels` of all pixels.
//! - 1.1.3: `islands` are no part of the surface.
//! - 1.1.4 to 1.1.7: the `choice` of the `ground`.
//! - 1.1.8: the supports beside the `ground`.
//! - 1.1.9: `skirts` are given back to the surface.

mod candidates;
mod choice;
mod ground;
mod islands;
mod labels;
mod pieces;
mod planes;
mod sample;
mod size;
mod skirts;
mod stretches;
mod surface;
mod tilt;
mod trials;

use glam::DVec3;
use rayon::prelude::*;

use self::candidates::{Candidate, GRID_PX, View};
pub use self::ground::Supports;
use self::ground::find_supports;
use self::islands::free_islands;
use self::labels::label_pixels;
use self::planes::fit_planes;
use self::size::SurfaceSize;
use self::skirts::reclaim_skirts;
use self::stretches::Stretches;
pub use self::surface::StructureSurface;
use self::tilt::{Alike, least_square};
use crate::attitude::Attitude;
use crate::params;
use crate::planes::StructurePlane;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::surface::plane_fit::PlaneFits;
use crate::surface::surfaces::Surfaces;

/// The structure of a scene.
#[derive(Clone, Debug)]
pub struct Structure {
    /// The surfaces, in the order in which they were found.
    pub surfaces: Vec<StructureSurface>,
    /// The surface of every pixel; -1 = none.
    pub labels: Raster<i32>,
    /// The pixels, in scan order, that belong to a surface by their colour, not by their depth.
    pub skirts: Vec<u32>,
    /// The surfaces on which things stand.
    pub supports: Supports,
    /// Every surface as a plane, fitted to its own pixels.
    pub planes: Vec<StructurePlane>,
}

/// The first surface is also structure if it holds more than this share of the samples ...
const DOMINANT_SHARE: f64 = 0.2;
/// ... and has a larger area than this.
const DOMINANT_M2: f64 = 0.03;
/// Where depth is smeared (docs/CONTEXT.md 0.7) a skirt reaches farther by this factor: such depth comes from
/// large matching windows.
const SMEARED_REACH: usize = 2;

/// Finds the structure of a scene.
///
/// RANSAC (Fischler and Bolles 1981) with fixed random numbers over a grid of pixels. The best plane is
/// fitted again as a quadratic, to its largest piece and the samples near that. It is kept if it is large.
/// Finally, islands are removed. `attitude`: how the camera is held. O(rounds · trials · pixels / 36 +
/// surfaces · pixels · log(pixels)).
pub fn find_structure(
    depth_m: &Raster<f32>,
    surfaces_at: &Surfaces,
    attitude: &Attitude,
    params: &params::Structure,
) -> Structure {
    let Surfaces { space, disparity, fits, orientation, .. } = surfaces_at;
    let alike = Alike {
        least_cosine: cosine(params.angle_deg),
        slope_squared: least_square(space.slope_per_px(params.slope_quanta_per_px)),
    };
    let view = View { disparity, orientation, space, grid: space.length_px(GRID_PX), alike };
    let Found { mut surfaces, large } = find_surfaces(&view, fits);
    let stretches = Stretches::of(disparity);
    let mut labels =
        label_pixels(&surfaces, disparity, &stretches, orientation, &view.alike, params.tolerance_quanta);
    free_islands(&mut labels, &surfaces, disparity, &stretches, space, params.tolerance_quanta);
    let mut supports = find_supports(&surfaces, large, &labels, disparity, space, attitude);
    let kept = supports.keep(surfaces.len(), large);
    if kept.len() < surfaces.len() {
        surfaces = kept.iter().map(|&s| surfaces[s].clone()).collect();
        renumber(&mut labels, &kept);
    }
    let planes = fit_planes(&surfaces, &labels, depth_m, &space.camera());
    let reach_px = params.skirt_reach_px * if surfaces_at.sharpened_share > 0.0 { SMEARED_REACH } else { 1 };
    let skirts = match surfaces_at.lab_for_shapes() {
        Some(lab) if reach_px > 0 => reclaim_skirts(&mut labels, disparity, lab, space.length_px(reach_px)),
        _ => Vec::new(),
    };
    Structure { surfaces, labels, skirts, supports, planes }
}

/// Surfaces that may be structure.
struct Found {
    /// First those that are large, then those that are structure only if things stand on them.
    surfaces: Vec<StructureSurface>,
    /// The number of large surfaces.
    large: usize,
}

/// Finds the surfaces that are large enough to be structure, or large enough to be the board of a shelf.
fn find_surfaces(view: &View<'_>, fits: &PlaneFits) -> Found {
    let samples = view.sample(fits);
    let all = samples.len() as f64;
    let candidates = view.find_candidates(samples);
    let sizes: Vec<SurfaceSize> = candidates.par_iter().map(|c| c.size(view)).collect();
    let (mut surfaces, mut boards) = (Vec::new(), Vec::new());
    for (Candidate { surface, inliers }, size) in candidates.into_iter().zip(sizes) {
        let dominates =
            surfaces.is_empty() && inliers.len() as f64 > DOMINANT_SHARE * all && size.area_m2 > DOMINANT_M2;
        if size.is_large() || dominates {
            surfaces.push(surface);
        } else if size.is_board() {
            boards.push(surface);
        }
    }
    let large = surfaces.len();
    surfaces.append(&mut boards);
    Found { surfaces, large }
}

/// Labels the pixels of the kept surfaces by their new numbers, and removes the labels of the others. O(pixels).
fn renumber(labels: &mut Raster<i32>, kept: &[usize]) {
    let new = |old: i32| kept.iter().position(|&s| s as i32 == old).map_or(Segments::NONE, |new| new as i32);
    labels.as_mut_slice().iter_mut().for_each(|label| *label = new(*label));
}

impl Structure {
    /// The unit normal of the ground, if there is one.
    pub(crate) fn ground_normal(&self) -> Option<DVec3> {
        self.supports.surfaces.first().map(|&ground| self.planes[ground].normal())
    }

    /// The label map of the surfaces alone.
    pub(crate) fn segments(&self) -> Segments {
        Segments::from_numbered(self.labels.clone(), self.surfaces.len())
    }

    /// One label map of both: first the surfaces, then the segments of the other pixels.
    pub(crate) fn with(&self, segments: &Segments) -> Segments {
        let surfaces = self.surfaces.len();
        let both = self.labels.as_slice().iter().zip(segments.labels().as_slice());
        let label = |(&surface, &segment): (&i32, &i32)| match (surface, segment) {
            (0.., _) => surface,
            (_, 0..) => surfaces as i32 + segment,
            _ => Segments::NONE,
        };
        let labels = self.labels.with_data(both.map(label).collect());
        Segments::from_numbered(labels, surfaces + segments.count())
    }
}

/// Cosine of an angle in degrees, the same on every platform.
fn cosine(degrees: f64) -> f64 {
    libm::cos(degrees.to_radians())
}

#[cfg(test)]
mod tests;
