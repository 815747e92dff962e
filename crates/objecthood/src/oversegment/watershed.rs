//! Superpixels of `context`: watershed of the fit residual (METHOD 3.4).

use std::collections::VecDeque;

use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::surface::disparity::DisparitySpace;
use crate::surface::plane_fit::PlaneFit;

/// Which neighbouring pixels lie on one surface.
pub struct Links<'a> {
    disparity: &'a Raster<f32>,
    slope: &'a Raster<[f32; 2]>,
    jump_quanta: f32,
    lateral_noise_px: f32,
}

/// Levels of the relief per quantum of residual.
const LEVELS_PER_QUANTUM: f32 = 40.0;
/// The level of pixels without a fit, and the number of levels below it.
const HIGHEST: usize = 255;

impl<'a> Links<'a> {
    /// The links of a frame with these disparities and slopes.
    pub fn new(
        disparity: &'a Raster<f32>,
        slope: &'a Raster<[f32; 2]>,
        space: &DisparitySpace,
        params: &params::Watershed,
    ) -> Self {
        let lateral_noise_px = space.lateral_noise_px() as f32;
        Self { disparity, slope, jump_quanta: params.link_jump_quanta, lateral_noise_px }
    }

    /// Whether the disparities of two 4-neighbours differ by no more than the slope of either explains, but for
    /// `link_jump_quanta` and the sideways noise. `axis`: 0 when j is right or left of i, 1 when below or above.
    #[inline]
    pub fn linked(&self, i: usize, j: usize, axis: usize) -> bool {
        let step = if j > i { 1.0 } else { -1.0 };
        let (rise_i, rise_j) = (self.slope[i][axis] * step, self.slope[j][axis] * step);
        let rise = self.disparity[j] - self.disparity[i];
        let misfit = (rise - rise_i).abs().min((rise - rise_j).abs());
        misfit < self.jump_quanta + 0.5 * self.lateral_noise_px * rise_i.abs().min(rise_j.abs())
    }
}

/// The 4-neighbours of a pixel, right, left, down, up, each with the axis along which it lies.
pub(crate) fn neighbours(i: usize, width: usize, height: usize) -> impl Iterator<Item = (usize, usize)> {
    let (u, v) = (i % width, i / width);
    [
        (u + 1 < width).then(|| (i + 1, 0)),
        (u > 0).then(|| (i - 1, 0)),
        (v + 1 < height).then(|| (i + width, 1)),
        (v > 0).then(|| (i - width, 1)),
    ]
    .into_iter()
    .flatten()
}

/// Superpixels on everything measured that is no structure: regions grow in flat surface first and meet on the edges.
///
/// Watershed by flooding (Meyer 1994) of the relief of fit residuals, one seed per block where the residual is least,
/// across links only; what no seed reaches is flooded by itself. `structure`: -1 = none. O(pixels).
pub fn watershed(
    disparity: &Raster<f32>,
    fits: &Raster<PlaneFit>,
    structure: &Raster<i32>,
    links: &Links<'_>,
    space: &DisparitySpace,
    params: &params::Watershed,
) -> Segments {
    let (width, height) = disparity.size();
    let block = space.length_px(params.seed_block_px);
    let is_free = |i: usize| !disparity[i].is_nan() && structure[i] < 0;
    let level = |i: usize| match fits[i].residual {
        e if e.is_finite() => ((LEVELS_PER_QUANTUM * e) as usize).min(HIGHEST - 1),
        _ => HIGHEST,
    };
    let mut labels = vec![Segments::NONE; disparity.len()];
    let mut floods: Vec<VecDeque<u32>> = vec![VecDeque::new(); HIGHEST + 1];
    let mut count = 0;
    for top in (0..height).step_by(block) {
        for left in (0..width).step_by(block) {
            let rows = top..(top + block).min(height);
            let pixels = rows.flat_map(|v| (left..(left + block).min(width)).map(move |u| v * width + u));
            let free = pixels.filter(|&i| is_free(i));
            // The first of the least.
            let seed = free.min_by(|&i, &j| fits[i].residual.total_cmp(&fits[j].residual));
            if let Some(i) = seed {
                labels[i] = count;
                count += 1;
                floods[level(i)].push_back(i as u32);
            }
        }
    }

    let reaches = |labels: &[i32], i: usize, (j, axis): (usize, usize)| {
        labels[j] == Segments::NONE && is_free(j) && links.linked(i, j, axis)
    };
    for now in 0..=HIGHEST {
        while let Some(i) = floods[now].pop_front() {
            let i = i as usize;
            for near in neighbours(i, width, height) {
                if reaches(&labels, i, near) {
                    labels[near.0] = labels[i];
                    floods[level(near.0).max(now)].push_back(near.0 as u32);
                }
            }
        }
    }
    let mut open = Vec::new();
    for start in 0..labels.len() {
        if labels[start] != Segments::NONE || !is_free(start) {
            continue;
        }
        labels[start] = count;
        open.push(start);
        while let Some(i) = open.pop() {
            for near in neighbours(i, width, height) {
                if reaches(&labels, i, near) {
                    labels[near.0] = count;
                    open.push(near.0);
                }
            }
        }
        count += 1;
    }
    Segments::from_numbered(disparity.with_data(labels), count as usize)
}

/// How many linked pairs of 4-neighbours join any two superpixels.
pub fn linked_pairs(superpixels: &Segments, links: &Links<'_>) -> RegionGraph<u32> {
    let (width, height) = superpixels.labels().size();
    let labels = superpixels.labels().as_slice();
    let mut pairs = Vec::new();
    for (i, &a) in labels.iter().enumerate().filter(|&(_, &a)| a >= 0) {
        let (u, v) = (i % width, i / width);
        let right = (u + 1 < width).then(|| (i + 1, 0));
        let down = (v + 1 < height).then(|| (i + width, 1));
        for (j, axis) in [right, down].into_iter().flatten() {
            let b = labels[j];
            if b >= 0 && b != a && links.linked(i, j, axis) {
                pairs.push((SegmentId(a as u32), SegmentId(b as u32)));
            }
        }
    }
    RegionGraph::from_pairs(superpixels.count(), pairs)
}
