//! Superpixels of `context`: watershed of the fit residual (METHOD 3.4).

use std::collections::VecDeque;

use rayon::prelude::*;

use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, SegmentId, Segments};
use crate::surface::disparity::DisparitySpace;
use crate::surface::plane_fit::PlaneFit;
use crate::workspace::Workspace;

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
/// Label of a pixel that no superpixel may have.
const TAKEN: i32 = -2;

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
    workspace: &mut Workspace,
) -> Segments {
    let (width, height) = disparity.size();
    let block = space.length_px(params.seed_block_px);
    let is_free = |i: usize| !disparity[i].is_nan() && structure[i] < 0;
    let level = |i: usize| match fits[i].residual {
        e if e.is_finite() => ((LEVELS_PER_QUANTUM * e) as usize).min(HIGHEST - 1),
        _ => HIGHEST,
    };
    // What is not free is taken from the start, so that one look at the label tells.
    let free = (0..disparity.len()).map(|i| if is_free(i) { Segments::NONE } else { TAKEN });
    let mut labels = workspace.collected(free);
    let mut floods: Vec<VecDeque<u32>> = vec![VecDeque::new(); HIGHEST + 1];
    let tops: Vec<usize> = (0..height).step_by(block).collect();
    let seeds_from = |&top: &usize| -> Vec<usize> {
        let seed = |left: usize| {
            let rows = top..(top + block).min(height);
            let pixels = rows.flat_map(|v| (left..(left + block).min(width)).map(move |u| v * width + u));
            let free = pixels.filter(|&i| labels[i] == Segments::NONE);
            // The first of the least.
            free.min_by(|&i, &j| fits[i].residual.total_cmp(&fits[j].residual))
        };
        (0..width).step_by(block).filter_map(seed).collect()
    };
    let seeds: Vec<Vec<usize>> = tops.par_iter().map(seeds_from).collect();
    let mut count = 0;
    for i in seeds.into_iter().flatten() {
        labels[i] = count;
        count += 1;
        floods[level(i)].push_back(i as u32);
    }

    for now in 0..=HIGHEST {
        while let Some(i) = floods[now].pop_front() {
            let i = i as usize;
            for (j, axis) in neighbours(i, width, height) {
                if labels[j] == Segments::NONE && links.linked(i, j, axis) {
                    labels[j] = labels[i];
                    floods[level(j).max(now)].push_back(j as u32);
                }
            }
        }
    }
    let mut open = Vec::new();
    for start in 0..labels.len() {
        if labels[start] != Segments::NONE {
            continue;
        }
        labels[start] = count;
        open.push(start);
        while let Some(i) = open.pop() {
            for (j, axis) in neighbours(i, width, height) {
                if labels[j] == Segments::NONE && links.linked(i, j, axis) {
                    labels[j] = count;
                    open.push(j);
                }
            }
        }
        count += 1;
    }
    labels.iter_mut().filter(|l| **l == TAKEN).for_each(|l| *l = Segments::NONE);
    Segments::from_numbered(disparity.with_data(labels), count as usize)
}

/// How many linked pairs of 4-neighbours join any two superpixels. O(pixels); parallel over rows.
pub fn linked_pairs(superpixels: &Segments, links: &Links<'_>) -> RegionGraph<u32> {
    let (width, height) = superpixels.labels().size();
    let labels = superpixels.labels().as_slice();
    let from_row = |v: usize| {
        let mut pairs = Vec::new();
        for (run, a) in superpixels.runs_in(v..v + 1) {
            let mut look = |i: usize, j: usize, axis: usize| {
                if let Ok(b) = u32::try_from(labels[j])
                    && b != a as u32
                    && links.linked(i, j, axis)
                {
                    pairs.push((SegmentId(a as u32), SegmentId(b)));
                }
            };
            if run.end % width > 0 {
                look(run.end - 1, run.end, 0);
            }
            if run.end + width <= labels.len() {
                run.for_each(|i| look(i, i + width, 1));
            }
        }
        pairs
    };
    let rows: Vec<Vec<_>> = (0..height).into_par_iter().map(from_row).collect();
    RegionGraph::from_pairs(superpixels.count(), rows.into_iter().flatten())
}

#[cfg(test)]
mod tests {
    use std::cmp::Reverse;
    use std::collections::{BTreeMap, BinaryHeap};

    use proptest::prelude::*;

    use super::*;
    use crate::testing::{coarse_disparity, kinect, raster, small_size};

    /// What the watershed looks at, in coarse steps, so that levels and residuals tie.
    #[derive(Clone, Debug)]
    struct Relief {
        disparity: Raster<f32>,
        slope: Raster<[f32; 2]>,
        fits: Raster<PlaneFit>,
        structure: Raster<i32>,
    }

    fn relief() -> impl Strategy<Value = Relief> {
        let fit = prop_oneof![
            1 => Just(PlaneFit::NONE),
            // From flat to beyond the highest level.
            6 => (0_u8..6).prop_map(|k| PlaneFit { residual: 1.3 * f32::from(k), ..PlaneFit::NONE }),
        ];
        let slope = prop::array::uniform2(-2_i8..=2).prop_map(|slope| slope.map(|s| 1.5 * f32::from(s)));
        let structure = prop_oneof![7 => Just(-1), 1 => Just(0)];
        small_size().prop_flat_map(move |size| {
            let disparity = raster(size, coarse_disparity());
            let parts = (
                disparity,
                raster(size, slope.clone()),
                raster(size, fit.clone()),
                raster(size, structure.clone()),
            );
            parts.prop_map(|(disparity, slope, fits, structure)| Relief { disparity, slope, fits, structure })
        })
    }

    /// The neighbours of a pixel in the order of the flood.
    fn around(i: usize, (width, height): (usize, usize)) -> Vec<(usize, usize)> {
        let (u, v) = ((i % width) as isize, (i / width) as isize);
        [(1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .map(|(du, dv)| (u + du, v + dv, usize::from(dv != 0)))
            .filter(|&(u, v, _)| (0..width as isize).contains(&u) && (0..height as isize).contains(&v))
            .map(|(u, v, axis)| (v as usize * width + u as usize, axis))
            .collect()
    }

    /// Floods pixel by pixel, always from the lowest level, there from the pixel that was reached first.
    fn naive(relief: &Relief, links: &Links<'_>, block: usize) -> Vec<i32> {
        let Relief { disparity, fits, structure, .. } = relief;
        let size = disparity.size();
        let is_free = |i: usize| !disparity[i].is_nan() && structure[i] < 0;
        let level = |i: usize| {
            if fits[i].is_some() { (fits[i].residual * 40.0).floor().min(254.0) as usize } else { 255 }
        };
        let mut seeds: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        for i in (0..disparity.len()).filter(|&i| is_free(i)) {
            let seed = seeds.entry((i / size.0 / block, i % size.0 / block)).or_insert(i);
            if fits[i].residual < fits[*seed].residual {
                *seed = i;
            }
        }
        let mut labels = vec![-1; disparity.len()];
        let mut queue = BinaryHeap::new();
        let mut reached = 0;
        for (label, &i) in seeds.values().enumerate() {
            labels[i] = label as i32;
            queue.push(Reverse((level(i), reached, i)));
            reached += 1;
        }
        let mut count = seeds.len() as i32;
        loop {
            while let Some(Reverse((now, _, i))) = queue.pop() {
                for (j, axis) in around(i, size) {
                    if labels[j] < 0 && is_free(j) && links.linked(i, j, axis) {
                        labels[j] = labels[i];
                        queue.push(Reverse((level(j).max(now), reached, j)));
                        reached += 1;
                    }
                }
            }
            let Some(left) = (0..labels.len()).find(|&i| labels[i] < 0 && is_free(i)) else { return labels };
            labels[left] = count;
            count += 1;
            queue.push(Reverse((0, reached, left)));
        }
    }

    proptest! {
        #[test]
        fn the_flood_is_the_naive_one(relief in relief(), block in 1_usize..6) {
            let params = params::Watershed { seed_block_px: block, link_jump_quanta: 2.5 };
            let Relief { disparity, slope, fits, structure } = &relief;
            let links = Links::new(disparity, slope, &kinect(), &params);
            let superpixels = watershed(disparity, fits, structure, &links, &kinect(), &params, &mut Workspace::default());
            let expected = naive(&relief, &links, block);
            prop_assert_eq!(superpixels.labels().as_slice(), expected.as_slice());
            prop_assert_eq!(superpixels.count() as i32, expected.iter().max().map_or(0, |most| most + 1));
        }

        #[test]
        fn superpixels_cover_what_is_free_and_hang_together_by_links(relief in relief()) {
            let params = params::Watershed { seed_block_px: 3, link_jump_quanta: 2.5 };
            let Relief { disparity, slope, fits, structure } = &relief;
            let links = Links::new(disparity, slope, &kinect(), &params);
            let superpixels = watershed(disparity, fits, structure, &links, &kinect(), &params, &mut Workspace::default());
            let size = disparity.size();
            let mut pairs: BTreeMap<(u32, u32), u32> = BTreeMap::new();
            let mut parts = crate::union_find::UnionFind::new(disparity.len());
            for i in 0..disparity.len() {
                let is_free = !disparity[i].is_nan() && structure[i] < 0;
                prop_assert_eq!(superpixels.at(i).is_some(), is_free, "{}", i);
                for (j, axis) in around(i, size) {
                    prop_assert_eq!(links.linked(i, j, axis), links.linked(j, i, axis), "{} {}", i, j);
                    let (Some(a), Some(b)) = (superpixels.at(i), superpixels.at(j)) else { continue };
                    if a == b && links.linked(i, j, axis) {
                        let [p, q] = [i, j].map(|k| parts.find(k));
                        parts.link(p, q);
                    } else if a < b && links.linked(i, j, axis) {
                        *pairs.entry((a.0, b.0)).or_default() += 1;
                    }
                }
            }
            // In one piece each.
            let mut root: BTreeMap<SegmentId, usize> = BTreeMap::new();
            for i in (0..disparity.len()).filter(|&i| superpixels.at(i).is_some()) {
                let found = parts.find(i);
                let expected = superpixels.at(i).map(|s| *root.entry(s).or_insert(found));
                prop_assert_eq!(expected, Some(found), "{}", i);
            }
            let graph = linked_pairs(&superpixels, &links);
            let got: Vec<_> = graph.edges().iter().map(|e| ((e.a.0, e.b.0), e.evidence)).collect();
            prop_assert_eq!(got, pairs.into_iter().collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_step_parts_and_a_slope_does_not() {
        let params = params::Watershed::default();
        let disparity = Raster::from_vec(4, 1, vec![200.0, 207.0, 214.0, 230.0]).unwrap();
        let linked = |slope: f32| {
            let slopes = Raster::filled(4, 1, [slope, 0.0]).unwrap();
            let links = Links::new(&disparity, &slopes, &kinect(), &params);
            [0, 1, 2].map(|i| links.linked(i, i + 1, 0))
        };
        assert_eq!(linked(0.0), [false, false, false]);
        assert_eq!(linked(7.0), [true, true, false]);
        // 0.8 px of sideways noise on a slope of 12 quanta/px are 4.8 quanta more to either side.
        assert_eq!(linked(12.0), [true, true, true]);
    }
}
