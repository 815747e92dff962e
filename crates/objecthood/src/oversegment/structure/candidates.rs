//! The search for large surfaces among the samples.

use glam::DVec3;

use super::sample::Sample;
use super::surface::StructureSurface;
use super::tilt::{Alike, Tilt};
use super::trials::find_best_plane;
use crate::random::Lcg;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;
use crate::surface::plane_fit::PlaneFits;
use crate::surface::window_choice::Orientation;

/// Distance of the samples along columns and rows (px at a focal length of 525 px).
pub(super) const GRID_PX: usize = 6;
/// Rounds of the search, each for one surface: a room has a table, a floor, walls, shelves.
const ROUNDS: usize = 8;
/// The search ends when no more samples than this are left.
const LEAST_POOL: usize = 150;
/// Tolerances (quanta) of the three fits of a surface: the first fit takes the samples near the plane, the others the samples near
/// the previous fit.
const REFIT_QUANTA: [f64; 3] = [3.5, 3.0, 3.0];
/// Least number of samples of such a fit.
const LEAST_REFIT: usize = 50;
/// Samples nearer than this to a surface (quanta) are taken out with it.
const INLIER_QUANTA: f64 = 3.0;
/// Where the random numbers of the trial planes begin: fixed, so the same frame gives the same planes.
const SEED: u32 = 12345;

/// A surface that may be structure, and the samples near it.
pub(super) struct Candidate {
    pub(super) surface: StructureSurface,
    pub(super) inliers: Vec<Sample>,
}

/// The inputs of the search.
pub(super) struct View<'a> {
    pub(super) disparity: &'a Raster<f32>,
    pub(super) orientation: &'a Orientation,
    pub(super) depth_m: &'a Raster<f32>,
    pub(super) space: &'a DisparitySpace,
    /// Distance (px) of the samples along columns and rows.
    pub(super) grid: usize,
    pub(super) alike: Alike,
}

impl View<'_> {
    /// Samples the pixels of the grid that have a plane fitted around them.
    pub(super) fn sample(&self, fits: &PlaneFits) -> Vec<Sample> {
        let (width, height) = self.disparity.size();
        let rows = (self.grid / 3..height).step_by(self.grid);
        let pixels = rows.flat_map(|v| (self.grid / 3..width).step_by(self.grid).map(move |u| v * width + u));
        let sample = |pixel: usize| Sample {
            pixel,
            at: position(pixel, width),
            disparity: f64::from(self.disparity[pixel]),
        };
        pixels.filter(|&pixel| fits.at(pixel).is_some()).map(sample).collect()
    }

    /// Finds up to eight surfaces. Each round takes the plane near most samples, and removes the samples near its surface from the
    /// pool.
    pub(super) fn find_candidates(&self, mut pool: Vec<Sample>) -> Vec<Candidate> {
        let mut random = Lcg::new(SEED);
        let mut candidates = Vec::new();
        for _ in 0..ROUNDS {
            if pool.len() <= LEAST_POOL {
                break;
            }
            let Some([a, b, c]) = find_best_plane(&pool, &mut random, self.space) else { break };
            let normal = DVec3::from(self.space.normal([0.0; 2], c, [a, b]));
            let Some(model) = self.refit(&pool, [a, b, c], normal) else { continue };
            let offset_m = self.space.distance_m([0.0; 2], c, [a, b]);
            let is_inlier = |s: &mut Sample| (s.disparity - model.value(s.at)).abs() < INLIER_QUANTA;
            let inliers = pool.extract_if(.., is_inlier).collect();
            candidates.push(Candidate { surface: StructureSurface { model, normal, offset_m }, inliers });
        }
        candidates
    }

    /// Fits a quadratic to the samples near a plane that have its tilt; `None` for fewer than fifty.
    fn refit(&self, pool: &[Sample], [a, b, c]: [f64; 3], normal: DVec3) -> Option<Model> {
        let (width, height) = self.disparity.size();
        let center = [(width / 2) as f64, (height / 2) as f64];
        let plane = Tilt { normal, slope: [a, b] };
        let mut surface: Option<Model> = None;
        for tolerance in REFIT_QUANTA {
            let value = |at: [f64; 2]| surface.map_or(a * at[0] + b * at[1] + c, |model| model.value(at));
            let mut moments = Moments::about(center);
            for s in pool {
                if (s.disparity - value(s.at)).abs() < tolerance
                    && self.alike.are(&plane, &Tilt::at(s.pixel, self.orientation))
                {
                    moments.add(s.at, s.disparity);
                }
            }
            if moments.count() < LEAST_REFIT as f64 {
                break;
            }
            surface = Some(moments.fit(Basis::Quadratic).model);
        }
        surface
    }
}
