//! The search for large surfaces among the samples (docs/CONTEXT.md 1.1.1).

use std::collections::BTreeMap;

use glam::DVec3;

use super::pieces::largest_piece;
use super::sample::Sample;
use super::size::SurfaceSize;
use super::surface::StructureSurface;
use super::tilt::{Alike, Tilt};
use super::trials::find_best_plane;
use crate::quantile::element_at;
use crate::random::Lcg;
use crate::raster::Raster;
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::model::{Basis, Model};
use crate::surface::moments::Moments;
use crate::surface::plane_fit::PlaneFits;
use crate::surface::window_choice::Orientation;

/// Distance of the samples along columns and rows (px at a focal length of 525 px).
pub(super) const GRID_PX: usize = 6;
/// The first sample lies this part of their distance from the border of the image.
const FIRST_OF_GRID: usize = 3;
/// Rounds of the search, each for one surface: a room has a table, a floor, walls, shelves.
const ROUNDS: usize = 8;
/// The search ends when no more samples than this are left.
const LEAST_POOL: usize = 150;
/// Tolerances (quanta) of the three fits of a surface: the first fit takes the samples near the plane, the others the samples near
/// the previous fit.
const REFIT_QUANTA: [f64; 3] = [3.5, 3.0, 3.0];
/// Least number of samples of such a fit.
const LEAST_REFIT: usize = 50;
/// If the largest piece has at least this share of a surface's samples, the surface is that piece: nothing
/// else tilts it.
const MOST_SHARE: f64 = 0.8;
/// Samples nearer than this to a surface (quanta) are taken out with it.
const INLIER_QUANTA: f64 = 3.0;
/// Refits before this one measure the spread of the surface.
const LAST_SPREAD: usize = 2;
/// Samples less than this (quanta) behind a surface show its spread.
const BEHIND_QUANTA: f64 = 12.0;
/// Least number of such samples.
const LEAST_BEHIND: usize = 60;
/// A spread (quanta) below this is a Kinect's: 0.97 to 1.04 on mOSD learn.
const LEAST_SPREAD: f64 = 1.3;
/// Tolerances grow by this factor at most.
const MOST_SPREAD: f64 = 3.5;
/// Median distance from the mean of a normal distribution, in standard deviations.
const MEDIAN_OF_NORMAL: f64 = 0.6745;
/// Blocks of this many by this many samples show how a surface lies there, because single normals are noise
/// far away, ...
const BLOCK: usize = 6;
/// ... if at least a quarter of their samples is on it.
const LEAST_IN_BLOCK: usize = 9;
/// Least cosine of the angle (20 degrees) between the mean normal of a block and that of its surface.
const LEAST_ALIGNED: f64 = 0.94;
/// The spread of a surface is accepted if at most this share of it is in blocks that lie otherwise.
const MOST_ASKEW: f64 = 0.25;
/// Where the random numbers of the trial planes begin: fixed, so the same frame gives the same planes.
const SEED: u32 = 12345;

/// A surface that may be structure, and the samples near it.
pub(super) struct Candidate {
    pub(super) surface: StructureSurface,
    pub(super) inliers: Vec<Sample>,
}

impl Candidate {
    /// The size of the largest connected piece of its samples, because the tops of boxes of equal height are not one surface.
    pub(super) fn size(&self, view: &View<'_>) -> SurfaceSize {
        let inliers: Vec<&Sample> = self.inliers.iter().collect();
        let point_m = |s: &Sample| DVec3::from(view.space.point_m(s.at, s.disparity));
        let points_m: Vec<DVec3> = largest_piece(&inliers, view.grid).into_iter().map(point_m).collect();
        SurfaceSize::measure(&points_m, self.surface.normal, view.grid * view.grid, &view.space.camera())
    }
}

impl StructureSurface {
    /// Whether a sample lies near this surface.
    fn is_inlier(&self, sample: &Sample) -> bool {
        (sample.disparity - self.model.value(sample.at)).abs() < self.scale * INLIER_QUANTA
    }
}

/// The inputs of the search.
pub(super) struct View<'a> {
    pub(super) disparity: &'a Raster<f32>,
    pub(super) orientation: &'a Orientation,
    pub(super) space: &'a DisparitySpace,
    /// Distance (px) of the samples along columns and rows.
    pub(super) grid: usize,
    pub(super) alike: Alike,
}

impl View<'_> {
    /// Samples the pixels of the grid that have a plane fitted around them.
    pub(super) fn sample(&self, fits: &PlaneFits) -> Vec<Sample> {
        let (width, height) = self.disparity.size();
        let first = self.grid / FIRST_OF_GRID;
        let rows = (first..height).step_by(self.grid);
        let pixels = rows.flat_map(|v| (first..width).step_by(self.grid).map(move |u| v * width + u));
        let sample = |pixel: usize| Sample {
            pixel,
            at: position(pixel, width),
            disparity: f64::from(self.disparity[pixel]),
        };
        pixels.filter(|&pixel| fits.at(pixel).is_some()).map(sample).collect()
    }

    /// Finds up to eight surfaces. Each round takes the plane near most samples. It fits a surface to the
    /// largest piece of this plane and the samples near that piece. Then it removes the samples near the
    /// surface from the pool.
    pub(super) fn find_candidates(&self, mut pool: Vec<Sample>) -> Vec<Candidate> {
        let mut random = Lcg::new(SEED);
        let mut candidates = Vec::new();
        for _ in 0..ROUNDS {
            if pool.len() <= LEAST_POOL {
                break;
            }
            let Some(plane) = find_best_plane(&pool, &mut random, self.space, self.grid) else { break };
            let Some(found) = self.surface_near(&pool, plane) else { continue };
            let of_piece = self.plane_of_largest_piece(&pool, &found);
            let surface = of_piece.and_then(|plane| self.surface_near(&pool, plane)).unwrap_or(found);
            let inliers = pool.extract_if(.., |s: &mut Sample| surface.is_inlier(s)).collect();
            candidates.push(Candidate { surface, inliers });
        }
        candidates
    }

    /// The surface of the samples near the plane a u + b v + c; `None` for fewer than fifty.
    fn surface_near(&self, pool: &[Sample], [a, b, c]: [f64; 3]) -> Option<StructureSurface> {
        let normal = DVec3::from(self.space.normal([0.0; 2], c, [a, b]));
        let offset_m = self.space.distance_m([0.0; 2], c, [a, b]);
        let most_spread = self.space.noise().most_spread().min(MOST_SPREAD);
        let surface = |most_spread| {
            let (model, scale) = self.refit(pool, [a, b, c], normal, most_spread)?;
            Some(StructureSurface { model, normal, offset_m, scale })
        };
        let found = surface(most_spread)?;
        let is_wide = found.scale > self.space.noise().pixel_scale();
        // Samples that do not lie as the surface does belong to other surfaces, so its spread is no noise.
        if is_wide && self.askew_share(pool, &found) > MOST_ASKEW { surface(1.0) } else { Some(found) }
    }

    /// The share of the samples of the largest piece of a surface that lie in blocks whose mean normal is more than 20° off that of the surface.
    fn askew_share(&self, pool: &[Sample], surface: &StructureSurface) -> f64 {
        let own: Vec<&Sample> = pool.iter().filter(|s| surface.is_inlier(s)).collect();
        let mut blocks: BTreeMap<[usize; 2], (DVec3, usize)> = BTreeMap::new();
        for s in largest_piece(&own, self.grid) {
            let block = blocks.entry(s.at.map(|x| x as usize / (self.grid * BLOCK))).or_default();
            block.0 += Tilt::at(s.pixel, self.orientation).normal;
            block.1 += 1;
        }
        let judged = || blocks.values().filter(|block| block.1 >= LEAST_IN_BLOCK);
        let is_askew =
            |block: &&(DVec3, usize)| block.0.normalize_or_zero().dot(surface.normal) < LEAST_ALIGNED;
        let count =
            |blocks: &mut dyn Iterator<Item = &(DVec3, usize)>| blocks.map(|block| block.1).sum::<usize>();
        count(&mut judged().filter(is_askew)) as f64 / count(&mut judged()).max(1) as f64
    }

    /// The plane a u + b v + c of the largest piece of a surface; `None` if the piece has fewer than fifty samples, or nearly all.
    ///
    /// The plane with most samples may run through several things by chance. Its largest piece shows which
    /// surface is meant.
    fn plane_of_largest_piece(&self, pool: &[Sample], surface: &StructureSurface) -> Option<[f64; 3]> {
        let has_tilt = |s: &Sample| {
            let slope = surface.model.slope(s.at);
            self.has_tilt(&Tilt { normal: surface.normal, slope }, s, surface.scale)
        };
        let own: Vec<&Sample> = pool.iter().filter(|s| surface.is_inlier(s) && has_tilt(s)).collect();
        let piece = largest_piece(&own, self.grid);
        let mut moments = Moments::about([0.0; 2]);
        piece.iter().for_each(|s| moments.add(s.at, s.disparity));
        let is_meant = piece.len() >= LEAST_REFIT && (piece.len() as f64) < MOST_SHARE * own.len() as f64;
        let plane = is_meant.then(|| moments.fit(Basis::Plane).model)?;
        let [a, b] = plane.slope([0.0; 2]);
        Some([a, b, plane.value([0.0; 2])])
    }

    /// Fits a quadratic to the samples near a plane that have its tilt; `None` for fewer than fifty. Also returns the factor on
    /// tolerances that the spread of these samples demands.
    fn refit(
        &self,
        pool: &[Sample],
        [a, b, c]: [f64; 3],
        normal: DVec3,
        most_spread: f64,
    ) -> Option<(Model, f64)> {
        let (width, height) = self.disparity.size();
        let center = [(width / 2) as f64, (height / 2) as f64];
        let plane = Tilt { normal, slope: [a, b] };
        let mut surface: Option<Model> = None;
        let mut scale = self.space.noise().pixel_scale();
        for (round, tolerance) in REFIT_QUANTA.into_iter().enumerate() {
            let value = |at: [f64; 2]| surface.map_or(a * at[0] + b * at[1] + c, |model| model.value(at));
            let mut moments = Moments::about(center);
            for s in pool {
                if (s.disparity - value(s.at)).abs() < scale * tolerance && self.has_tilt(&plane, s, scale) {
                    moments.add(s.at, s.disparity);
                }
            }
            if moments.count() < LEAST_REFIT as f64 {
                break;
            }
            let model = moments.fit(Basis::Quadratic).model;
            surface = Some(model);
            if round < LAST_SPREAD {
                let spread = self.measure_spread(pool, &model, &plane, scale, most_spread);
                scale = self.space.noise().pixel_scale() * spread;
            }
        }
        surface.map(|model| (model, scale))
    }

    /// Whether a sample has the tilt of a surface.
    fn has_tilt(&self, surface: &Tilt, sample: &Sample, scale: f64) -> bool {
        self.alike.are(surface, &Tilt::at(sample.pixel, self.orientation), scale)
    }

    /// The spread of a surface: how much farther than a Kinect's its samples scatter about it; 1 on a Kinect.
    ///
    /// Only samples behind the surface count, because things stand before it. They have its tilt, and lie
    /// beside samples on it, so that no other surface close behind it counts. The spread is their median
    /// distance, converted to a standard deviation. O(samples).
    fn measure_spread(&self, pool: &[Sample], model: &Model, tilt: &Tilt, scale: f64, most: f64) -> f64 {
        if most <= LEAST_SPREAD {
            return 1.0;
        }
        let near = scale * INLIER_QUANTA;
        let own: Vec<&Sample> = pool.iter().filter(|s| self.has_tilt(tilt, s, scale)).collect();
        let behind = |s: &Sample| model.value(s.at) - s.disparity;
        let columns = self.disparity.width() / self.grid + 2;
        let cell = |s: &Sample| {
            let [u, v] = s.at.map(|x| (x / self.grid as f64) as usize);
            v * columns + u + columns + 1
        };
        let mut on_it = vec![false; columns * (self.disparity.height() / self.grid + 3)];
        own.iter().filter(|s| behind(s).abs() < near).for_each(|s| on_it[cell(s)] = true);
        let beside =
            |k: usize| [1, columns, columns - 1, columns + 1].iter().any(|d| on_it[k - d] || on_it[k + d]);
        let is_noise = |s: &&&Sample| (0.0..BEHIND_QUANTA).contains(&behind(s)) && beside(cell(s));
        let mut distances: Vec<f64> = own.iter().filter(is_noise).map(|s| behind(s)).collect();
        if distances.len() < LEAST_BEHIND {
            return 1.0;
        }
        let spread = element_at(&mut distances, 0.5) / MEDIAN_OF_NORMAL;
        if spread < LEAST_SPREAD { 1.0 } else { spread.min(most) }
    }
}
