//! Evidence from the common border of two facets: folds, steps and changes of colour (docs/CONTEXT.md 3.1).

pub(super) mod color_change;
mod side;

use glam::DVec3;
use rayon::prelude::*;

use self::color_change::FacetColors;
use self::side::{MOST_RADIUS_PX, SidePlane, Surroundings};
use crate::facets::Facets;
use crate::linear::length;
use crate::params;
use crate::raster::{Raster, marked};
use crate::regions::{RegionGraph, SegmentId};
use crate::surface::disparity::{DisparitySpace, position};
use crate::surface::surfaces::Surfaces;

/// Evidence from the border of two facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BorderEvidence {
    /// The folds, in scan order.
    pub folds: Vec<Fold>,
    /// Length of the border (m) that is a step: one facet lies in front of the other by more than noise.
    pub step_m: f64,
    /// Length of the border (m) that runs along a seam of colour.
    pub seam_m: f64,
    /// Length of the folds (m), if the two facets have different colours; else 0.
    pub color_change_m: f64,
    /// How far the first facet lies in front of the second at the border, summed over all samples.
    pub gaps: Gaps,
}

/// Gaps between two surfaces along their border, weighted by its length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gaps {
    /// Length of the border (m).
    pub length_m: f64,
    /// Gap in disparity times length (quanta · m).
    pub quanta_m: f64,
    /// Gap in depth times length (m · m).
    pub depth_m2: f64,
}

/// The fold between two facets at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fold {
    /// Angle between the surfaces (degrees): above 0 = ridge, convex; below 0 = valley, concave.
    pub angle_deg: f64,
    /// Length of border that it represents (m).
    pub length_m: f64,
}

/// Two single pixels make a step when they differ by more than this multiple of `border.gap_quanta`.
const RAW_GAPS: f64 = 2.5;
/// Two single pixels hide something when they differ by more than this multiple of `border.step_depth_m`.
const RAW_DEPTHS: f64 = 2.0;
/// A step that hides nothing is a torn ridge when the sides fold outwards by at least this (degrees).
const TORN_RIDGE_DEG: f64 = 25.0;
/// A torn ridge counts as a fold of this share of its length.
const TORN_RIDGE_SHARE: f64 = 0.5;
/// Every other pair of pixels is a sample (px at 525 px). A sharper image has as many samples on a border, not more.
const PAIRS_PER_SAMPLE: usize = 2;

/// Marks a pixel whose right (`RIGHT`) or lower (`BELOW`) neighbour lies on another facet.
const RIGHT: i32 = 1;
const BELOW: i32 = 2;

/// The evidence from one place of a border.
struct Sample {
    kind: Kind,
    gaps: Gaps,
}

enum Kind {
    Fold(Fold),
    Step { length_m: f64 },
}

/// Measures the common borders of facets: folds and steps from depth, and changes of colour if the shapes use colour.
/// O(border pixels · radius^2 + image).
pub fn measure_borders(
    facets: &Facets,
    surfaces: &Surfaces,
    params: &params::Border,
) -> RegionGraph<BorderEvidence> {
    let borders = measure_by_depth(facets, &surfaces.disparity, &surfaces.space, params);
    match surfaces.lab_for_shapes() {
        Some(lab) => mark_color_changes(borders, &FacetColors::of(facets, lab, &surfaces.space)),
        None => borders,
    }
}

/// Marks the folds between facets of different colours. O(borders).
fn mark_color_changes(
    borders: RegionGraph<BorderEvidence>,
    colors: &FacetColors,
) -> RegionGraph<BorderEvidence> {
    borders.update(|facets, evidence| {
        if !evidence.folds.is_empty() && colors.differ(facets) {
            evidence.color_change_m = evidence.fold_m();
        }
    })
}

/// Measures the folds and steps between facets, except between two facets of the structure, or between a flat thing
/// and another facet that is no structure. Every other pair of pixels along a border is
/// a sample, or fewer where pixels are smaller. Each sample fits a plane to either side within `radius_px`: locally, because curved and
/// L-shaped facets have no single direction. O(border pixels · radius^2); parallel over rows.
pub(super) fn measure_by_depth(
    facets: &Facets,
    disparity: &Raster<f32>,
    space: &DisparitySpace,
    params: &params::Border,
) -> RegionGraph<BorderEvidence> {
    let (width, height) = disparity.size();
    let radius = space.length_px(params.radius_px).min(MOST_RADIUS_PX);
    let surroundings = Surroundings { facets, disparity, space, radius };
    let pairs_per_sample = space.length_px(PAIRS_PER_SAMPLE).max(PAIRS_PER_SAMPLE);
    let borders = Borders { surroundings, params, pairs_per_sample };
    let sampled = sampled_columns(width, pairs_per_sample);
    let sample_row = |marks: &mut Vec<i32>, v: usize| {
        mark_borders(facets.segments.labels(), v, pairs_per_sample, &sampled, marks);
        let mut samples = Vec::new();
        for u in marked(marks) {
            let i = v * width + u;
            if marks[u] & RIGHT != 0 {
                samples.extend(borders.sample(i, i + 1));
            }
            if marks[u] & BELOW != 0 {
                samples.extend(borders.sample(i, i + width));
            }
        }
        samples
    };
    let rows: Vec<Vec<_>> = (0..height).into_par_iter().map_init(|| vec![0; width], sample_row).collect();
    RegionGraph::gather(facets.segments.count(), rows.into_iter().flatten(), BorderEvidence::add)
}

/// [`BELOW`] in every `step`-th column, from the second, and 0 in the others.
fn sampled_columns(width: usize, step: usize) -> Vec<i32> {
    (0..width).map(|u| if u % step == 1 { BELOW } else { 0 }).collect()
}

/// Marks the samples of row `v`: horizontal pairs in every `step`-th row, from the second, vertical pairs in the `sampled` columns.
fn mark_borders(labels: &Raster<i32>, v: usize, step: usize, sampled: &[i32], marks: &mut [i32]) {
    let (width, height) = labels.size();
    let row = |v: usize| &labels.as_slice()[v * width..(v + 1) * width];
    // All bits or none.
    let is_border = |a: i32, b: i32| -i32::from((a != b) & (a >= 0) & (b >= 0));
    let (own, below) = (row(v), row((v + 1).min(height - 1)));
    let columns = marks.iter_mut().zip(sampled).zip(own.iter().zip(below));
    columns.for_each(|((mark, sampled), (own, below))| *mark = sampled & is_border(*own, *below));
    if v % step == 1 {
        for (mark, (own, right)) in marks.iter_mut().zip(own.iter().zip(&own[1..])) {
            *mark |= RIGHT & is_border(*own, *right);
        }
    }
}

/// Measures the borders of facets.
struct Borders<'a> {
    surroundings: Surroundings<'a>,
    params: &'a params::Border,
    /// Pairs of pixels that a sample stands for.
    pairs_per_sample: usize,
}

/// The difference between the two sides at one place.
struct Step {
    /// Between the planes of the sides at the place (quanta).
    gap: f64,
    /// Between the two pixels (quanta).
    raw: f64,
    z_m: f64,
}

impl Borders<'_> {
    /// Samples the border between the 4-neighbours i and j, if they lie on two facets that are not both structure, and none is a flat thing
    /// beside another facet.
    fn sample(&self, i: usize, j: usize) -> Option<(SegmentId, SegmentId, Sample)> {
        let Surroundings { facets, disparity, space, .. } = self.surroundings;
        let (i, j, a, b) = match (facets.segments.at(i)?, facets.segments.at(j)?) {
            (a, b) if a == b => return None,
            (a, b) if a < b => (i, j, a, b),
            (a, b) => (j, i, b, a),
        };
        // Flat things end where their evidence ends: their borders join nothing (docs/CONTEXT.md 2.4).
        let is_of_flat = a.index() >= facets.structure && (facets.is_flat(a) || facets.is_flat(b));
        if b.index() < facets.structure || is_of_flat {
            return None;
        }
        let width = disparity.width();
        let (at_i, at_j) = (position(i, width), position(j, width));
        let middle = [0, 1].map(|k| ((at_i[k] + at_j[k]) / 2.0).floor());
        let sides = self.surroundings.fit_sides([a, b], middle)?;

        let (di, dj) = (f64::from(disparity[i]), f64::from(disparity[j]));
        let z_m = space.depth_m(0.5 * (di + dj));
        let camera = space.camera();
        // A horizontal pair represents a vertical piece of border.
        let focal_px = if i.abs_diff(j) == 1 { camera.fy_px } else { camera.fx_px };
        let length_m = self.pairs_per_sample as f64 * z_m / focal_px;
        let before = sides[0].value - sides[1].value;
        let gaps =
            Gaps { length_m, quanta_m: before * length_m, depth_m2: space.step_m(before, z_m) * length_m };
        let step = Step { gap: before.abs(), raw: (di - dj).abs(), z_m };
        let kind = self.tell_kind(&sides, &step, middle, length_m);
        Some((a, b, Sample { kind, gaps }))
    }

    /// Decides between fold and step. A step that hides nothing may be a torn ridge.
    fn tell_kind(&self, sides: &[SidePlane; 2], step: &Step, middle: [f64; 2], length_m: f64) -> Kind {
        let is_step = self.is_step(sides, step);
        if is_step && self.hides(step) {
            return Kind::Step { length_m };
        }
        let angle_deg = self.angle_deg(sides, middle);
        match is_step {
            true if angle_deg < TORN_RIDGE_DEG => Kind::Step { length_m },
            true => Kind::Fold(Fold { angle_deg, length_m: TORN_RIDGE_SHARE * length_m }),
            false => Kind::Fold(Fold { angle_deg, length_m }),
        }
    }

    /// Whether the difference is larger than noise explains.
    fn is_step(&self, [a, b]: &[SidePlane; 2], step: &Step) -> bool {
        let turn = length([a.slope[0] - b.slope[0], a.slope[1] - b.slope[1]]);
        let gentler = length(a.slope).min(length(b.slope));
        let space = self.surroundings.space;
        let gap_quanta = space.noise().step_scale() * self.params.gap_quanta;
        step.gap > gap_quanta + space.lateral_noise_px() * turn || step.raw > RAW_GAPS * gap_quanta + gentler
    }

    /// Whether the step is deep enough for one side to hide things behind it.
    fn hides(&self, step: &Step) -> bool {
        let depth_m = |quanta: f64| self.surroundings.space.step_m(quanta, step.z_m);
        depth_m(step.gap) > self.params.step_depth_m
            || depth_m(step.raw) > RAW_DEPTHS * self.params.step_depth_m
    }

    /// Angle between the sides (degrees): above 0 for a ridge, below 0 for a valley.
    fn angle_deg(&self, sides: &[SidePlane; 2], middle: [f64; 2]) -> f64 {
        let space = self.surroundings.space;
        let [a, b] = sides.each_ref().map(|side| {
            let at = [middle[0] + side.mean[0], middle[1] + side.mean[1]];
            (
                space.point_m(at, side.mean_disparity).into(),
                space.normal(middle, side.value, side.slope).into(),
            )
        });
        fold_angle_deg(a, b)
    }
}

/// Angle (degrees) between two surfaces, each given by a point and its normal: above 0 when they fold outwards (ridge), below 0 when
/// they fold inwards (valley).
pub(crate) fn fold_angle_deg(
    (point_a, normal_a): (DVec3, DVec3),
    (point_b, normal_b): (DVec3, DVec3),
) -> f64 {
    let turn = normal_a - normal_b;
    let angle = libm::acos(normal_a.dot(normal_b).clamp(-1.0, 1.0)).to_degrees();
    if turn.dot(point_a - point_b) < 0.0 { -angle } else { angle }
}

impl Fold {
    /// Its vote (m): above 0 for one shape, below 0 for two. It is 0 for a valley of `reflex_offset_deg`, and plus or minus the whole
    /// length from `full_vote_deg` away from there on.
    pub fn vote_m(&self, params: &params::Contraction) -> f64 {
        let signed = (self.angle_deg + params.reflex_offset_deg) / params.full_vote_deg;
        self.length_m * signed.clamp(-1.0, 1.0)
    }
}

impl BorderEvidence {
    fn add(&mut self, Sample { kind, gaps }: Sample) {
        match kind {
            Kind::Fold(fold) => self.folds.push(fold),
            Kind::Step { length_m } => self.step_m += length_m,
        }
        self.gaps.length_m += gaps.length_m;
        self.gaps.quanta_m += gaps.quanta_m;
        self.gaps.depth_m2 += gaps.depth_m2;
    }

    /// Length of the border (m) that is a fold.
    pub fn fold_m(&self) -> f64 {
        // Not `sum`, which gives -0.0 for no folds.
        self.folds.iter().fold(0.0, |sum, fold| sum + fold.length_m)
    }

    /// The vote of the border (m): above 0 for one shape, below 0 for two. It is the sum of the votes of the folds, minus
    /// `occlusion_weight` times the length of the steps, `seam_weight` times that of the seams, and `color_change_weight`
    /// times that of the changes of colour.
    pub fn vote_m(&self, params: &params::Contraction) -> f64 {
        let folds = self.folds.iter().map(|fold| fold.vote_m(params)).sum::<f64>();
        let steps = params.occlusion_weight * self.step_m;
        folds - steps - params.seam_weight * self.seam_m - params.color_change_weight * self.color_change_m
    }
}

#[cfg(test)]
mod tests;
