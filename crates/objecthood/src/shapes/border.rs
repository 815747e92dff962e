//! What the common border of two facets tells: how it folds, and where one hides the other (METHOD 3.7).

use glam::DVec3;
use rayon::prelude::*;

use crate::facets::Facets;
use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId};
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::moments::{Model, length};

/// What was seen along the border of two facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BorderEvidence {
    /// The folds, in scan order.
    pub folds: Vec<Fold>,
    /// How much of the border (m) is a step in depth: one facet hides what lies behind it.
    pub step_m: f64,
}

/// The fold between two facets at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Angle between the surfaces (degrees): above 0 = ridge, convex; below 0 = valley, concave.
    pub angle_deg: f64,
    /// Length of border that it stands for (m).
    pub length_m: f64,
}

/// A side with fewer pixels in the window (at a focal length of 525 px) gives no evidence.
const LEAST_SIDE_PX: usize = 15;
/// Keeps a narrow side near the slope of its facet (px^2).
const RIDGE_PX2: f64 = 1.0;
/// The step between two single pixels counts beyond so many times the gap between surfaces.
const RAW_GAPS: f64 = 2.5;
/// It hides something beyond so many times the depth of a step between surfaces.
const RAW_DEPTHS: f64 = 2.0;
/// A small step may be a torn ridge when it folds by more than this (degrees) ...
const TORN_RIDGE_DEG: f64 = 25.0;
/// ... and then counts as so much of its length.
const TORN_RIDGE_SHARE: f64 = 0.5;
/// Every other pair of pixels is looked at, so each stands for two.
const PAIRS_PER_SAMPLE: f64 = 2.0;

/// One look at a border.
enum Sample {
    Fold(Fold),
    Step { length_m: f64 },
}

/// Looks at the border pixels of any two facets that are not both structure, every other one, and fits a plane to either side within
/// `radius_px`: locally, because curved and L-shaped facets have no one direction. O(border pixels · radius^2).
pub fn borders(
    facets: &Facets,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    params: &params::Border,
) -> RegionGraph<BorderEvidence> {
    let (width, height) = disparity.size();
    let border = Border { facets, disparity, space, params, radius: space.length_px(params.radius_px) };
    // Horizontal pairs on odd rows, vertical pairs in odd columns.
    let look = |v: usize| {
        let pairs = (0..width).flat_map(move |u| {
            let i = v * width + u;
            let right = (v % 2 == 1 && u + 1 < width).then_some(i + 1);
            let down = (u % 2 == 1 && v + 1 < height).then_some(i + width);
            [right, down].into_iter().flatten().map(move |j| (i, j))
        });
        pairs.filter_map(|(i, j)| border.sample(i, j)).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<_>> = (0..height).into_par_iter().map(look).collect();
    let add = |evidence: &mut BorderEvidence, sample| match sample {
        Sample::Fold(fold) => evidence.folds.push(fold),
        Sample::Step { length_m } => evidence.step_m += length_m,
    };
    RegionGraph::gather(facets.segments.count(), rows.into_iter().flatten(), add)
}

struct Border<'a> {
    facets: &'a Facets,
    disparity: &'a Raster<f32>,
    space: &'a DisparitySpace,
    params: &'a params::Border,
    radius: usize,
}

/// The plane of one side, about the middle of the pair.
struct Side {
    /// Disparity at the middle (quanta).
    value: f64,
    slope: [f64; 2],
    /// Mean position of its pixels (px), and the disparity there.
    mean: [f64; 2],
    mean_disparity: f64,
}

impl Border<'_> {
    /// What is seen between the 4-neighbours i and j, if they lie on two facets that are not both structure.
    fn sample(&self, i: usize, j: usize) -> Option<(SegmentId, SegmentId, Sample)> {
        let (i, j, a, b) = match (self.facets.segments.at(i)?, self.facets.segments.at(j)?) {
            (a, b) if a == b => return None,
            (a, b) if a < b => (i, j, a, b),
            (a, b) => (j, i, b, a),
        };
        if b.index() < self.facets.structure {
            return None;
        }
        let width = self.disparity.width();
        let (at_i, at_j) = (position(i, width), position(j, width));
        let middle = [0, 1].map(|k| ((at_i[k] + at_j[k]) / 2.0).floor());
        let side_a = self.side(a, middle)?;
        let side_b = self.side(b, middle)?;

        let (di, dj) = (f64::from(self.disparity[i]), f64::from(self.disparity[j]));
        let z_m = self.space.depth_m(0.5 * (di + dj));
        let camera = self.space.camera();
        // A pair along a row stands for border along the column.
        let focal_px = if i.abs_diff(j) == 1 { camera.fy_px } else { camera.fx_px };
        let length_m = PAIRS_PER_SAMPLE * z_m / focal_px;

        let gap = (side_a.value - side_b.value).abs();
        let raw = (di - dj).abs();
        let (slope_a, slope_b) = (side_a.slope, side_b.slope);
        let turn = length([slope_a[0] - slope_b[0], slope_a[1] - slope_b[1]]);
        let gentler = length(slope_a).min(length(slope_b));
        let is_step = gap > self.params.gap_quanta + self.space.lateral_noise_px() * turn
            || raw > RAW_GAPS * self.params.gap_quanta + gentler;
        let hides = self.space.step_m(gap, z_m) > self.params.step_depth_m
            || self.space.step_m(raw, z_m) > RAW_DEPTHS * self.params.step_depth_m;
        if is_step && hides {
            return Some((a, b, Sample::Step { length_m }));
        }
        let angle_deg = self.angle_deg(&side_a, &side_b, middle);
        let sample = match is_step {
            true if angle_deg < TORN_RIDGE_DEG => Sample::Step { length_m },
            true => Sample::Fold(Fold { angle_deg, length_m: TORN_RIDGE_SHARE * length_m }),
            false => Sample::Fold(Fold { angle_deg, length_m }),
        };
        Some((a, b, sample))
    }

    /// The plane through the pixels of one facet around `middle`; `None` when they are few.
    fn side(&self, facet: SegmentId, middle: [f64; 2]) -> Option<Side> {
        let (width, height) = self.disparity.size();
        let [u, v] = middle.map(|x| x as usize);
        let label = facet.0 as i32;
        let (mut n, mut sums) = (0_usize, [0.0; 8]);
        for y in v.saturating_sub(self.radius)..(v + self.radius + 1).min(height) {
            let columns = u.saturating_sub(self.radius)..(u + self.radius + 1).min(width);
            let labels = &self.facets.segments.labels().as_slice()[y * width..][columns.clone()];
            for (x, _) in columns.zip(labels).filter(|(_, l)| **l == label) {
                let d = f64::from(self.disparity[y * width + x]);
                let (x, y) = (x as f64 - middle[0], y as f64 - middle[1]);
                let terms = [x, y, d, x * x, x * y, y * y, x * d, y * d];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
                n += 1;
            }
        }
        if n < self.space.area_px(LEAST_SIDE_PX).max(1) {
            return None;
        }
        let [mx, my, md, xx, xy, yy, xd, yd] = sums.map(|sum| sum / n as f64);
        let model: &Model = &self.facets.models[facet.index()];
        let [gx, gy] = model.slope([middle[0] + mx, middle[1] + my]);
        let (xx, xy, yy) = (xx - mx * mx + RIDGE_PX2, xy - mx * my, yy - my * my + RIDGE_PX2);
        let (xd, yd) = (xd - mx * md + RIDGE_PX2 * gx, yd - my * md + RIDGE_PX2 * gy);
        let determinant = xx * yy - xy * xy;
        let slope = [(xd * yy - yd * xy) / determinant, (yd * xx - xd * xy) / determinant];
        let value = md - slope[0] * mx - slope[1] * my;
        Some(Side { value, slope, mean: [mx, my], mean_disparity: md })
    }

    /// Angle between the normals (degrees), below 0 when they lean towards each other.
    fn angle_deg(&self, a: &Side, b: &Side, middle: [f64; 2]) -> f64 {
        let normal = |side: &Side| self.space.normal(middle, side.value, side.slope);
        let point = |side: &Side| {
            let at = [middle[0] + side.mean[0], middle[1] + side.mean[1]];
            self.space.point_m(at, side.mean_disparity)
        };
        let turn: DVec3 = normal(a) - normal(b);
        let angle = libm::acos(normal(a).dot(normal(b)).clamp(-1.0, 1.0)).to_degrees();
        if turn.dot(point(a) - point(b)) < 0.0 { -angle } else { angle }
    }
}

impl BorderEvidence {
    /// The signed vote of a border (m): above 0 for one shape, below 0 for two. A fold gives its whole length for or against from
    /// `full_vote_deg` on either side of the valley of `reflex_offset_deg`; a step speaks against by `occlusion_weight`.
    pub fn vote_m(&self, params: &params::Contraction) -> f64 {
        let vote = |fold: &Fold| {
            let signed = (fold.angle_deg + params.reflex_offset_deg) / params.full_vote_deg;
            fold.length_m * signed.clamp(-1.0, 1.0)
        };
        self.folds.iter().map(vote).sum::<f64>() - params.occlusion_weight * self.step_m
    }
}
