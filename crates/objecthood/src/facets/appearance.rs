//! The appearance of superpixels: histograms of colours and of normals (paper, eq. 3).

use crate::facets::bins::{NONE, find_color_bins, find_direction_bins};
use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;

/// Two normalised histograms for every superpixel: colours and normals. An empty histogram is all zero.
#[derive(Clone, Debug)]
pub struct Appearance {
    color_weight: f64,
    color: Histograms,
    normal: Histograms,
}

impl Appearance {
    /// Counts the core pixels of every superpixel, or all its pixels if it has no core. O(pixels); colours and normals run in
    /// parallel.
    ///
    /// `color`: sRGB, not smoothed; without it the colour histograms are empty. `normals`: unit vectors, zero = none.
    pub fn new(
        superpixels: &Superpixels,
        color: Option<&Raster<[u8; 3]>>,
        normals: &Raster<[f32; 3]>,
        params: &params::Appearance,
    ) -> Self {
        let width = normals.width();
        let row = |v: usize| v * width..(v + 1) * width;
        let color_bins = |v: usize, bins: &mut [i32]| match color {
            Some(color) => find_color_bins(&color.as_slice()[row(v)], params.lab_bins, bins),
            None => bins.fill(NONE),
        };
        let direction_bins =
            |v: usize, bins: &mut [i32]| find_direction_bins(&normals.as_slice()[row(v)], params, bins);
        superpixels.segments.find_runs();
        let (color, normal) = rayon::join(
            || Histograms::new(superpixels, color_bins),
            || Histograms::new(superpixels, direction_bins),
        );
        Self { color_weight: params.color_weight, color, normal }
    }

    /// The difference of superpixels `a` and `b` in [0, 1]: one minus the weighted mean of the intersections of
    /// their histograms, ω = `color_weight`. O(occupied bins of both).
    ///
    /// *Differs from the paper:* eq. 3 as printed is a similarity, but the text needs a distance.
    pub fn difference(&self, a: usize, b: usize) -> f64 {
        let similarity = self.color_weight * self.color.intersection(a, b)
            + (1.0 - self.color_weight) * self.normal.intersection(a, b);
        1.0 - similarity
    }
}

/// One histogram for each superpixel. Only occupied bins are stored, because most are empty.
#[derive(Clone, Debug)]
struct Histograms {
    /// For each superpixel in turn, its occupied bins in ascending order, each with its share of the counted pixels.
    bins: Vec<(u32, f32)>,
    /// The start of each superpixel's bins in `bins`; one entry more for the end of the last.
    starts: Vec<usize>,
}

impl Histograms {
    /// Counts the bins of the pixels of every superpixel. `bins_of` writes the bins of a row. O(n + k log k) for n pixels that occupy
    /// k bins.
    fn new(superpixels: &Superpixels, bins_of: impl Fn(usize, &mut [i32])) -> Self {
        let (grouped, ends) = group_bins(superpixels, bins_of);
        let most = grouped.iter().fold(0, |most, bin| most.max(*bin));
        let mut times = vec![0_u32; most as usize + 1];
        let mut occupied = Vec::new();
        let (mut bins, mut starts, mut start) = (Vec::new(), vec![0], 0);
        for end in ends {
            let mut pixels = 0_u32;
            for bin in grouped[start..end].iter().filter_map(|bin| usize::try_from(*bin).ok()) {
                if times[bin] == 0 {
                    occupied.push(bin);
                }
                times[bin] += 1;
                pixels += 1;
            }
            occupied.sort_unstable();
            for bin in occupied.drain(..) {
                let times = std::mem::take(&mut times[bin]);
                bins.push((bin as u32, times as f32 / pixels as f32));
            }
            starts.push(bins.len());
            start = end;
        }
        Self { bins, starts }
    }

    /// The sum over all bins of the smaller share (Swain and Ballard 1991), in [0, 1].
    fn intersection(&self, a: usize, b: usize) -> f64 {
        let of = |s: usize| &self.bins[self.starts[s]..self.starts[s + 1]];
        let (mut a, mut b) = (of(a), of(b));
        let mut sum = 0.0;
        while let (Some((&(bin_a, x), rest_a)), Some((&(bin_b, y), rest_b))) =
            (a.split_first(), b.split_first())
        {
            if bin_a == bin_b {
                sum += f64::from(x.min(y));
            }
            if bin_a <= bin_b {
                a = rest_a;
            }
            if bin_b <= bin_a {
                b = rest_b;
            }
        }
        sum
    }
}

/// The bins of all pixels, superpixel by superpixel, and the end of each superpixel's bins. In a superpixel with core pixels the
/// other pixels are not counted; they have [`NONE`].
fn group_bins(superpixels: &Superpixels, bins_of: impl Fn(usize, &mut [i32])) -> (Vec<i32>, Vec<usize>) {
    let Superpixels { segments, core } = superpixels;
    let (width, height) = core.size();
    // In turn: the numbers of pixels, the starts and the ends of the superpixels.
    let mut ends = vec![0_usize; segments.count()];
    let mut has_core = vec![false; segments.count()];
    for (run, s) in segments.runs() {
        ends[s] += run.len();
        has_core[s] |= core.as_slice()[run].contains(&true);
    }
    let mut start = 0;
    for end in &mut ends {
        start += std::mem::replace(end, start);
    }
    let mut grouped = vec![NONE; start];
    let mut bins = vec![NONE; width];
    let mut runs = segments.runs().peekable();
    for v in 0..height {
        bins_of(v, &mut bins);
        while let Some((run, s)) = runs.next_if(|(run, _)| run.start < (v + 1) * width) {
            let bins = &mut bins[run.start - v * width..run.end - v * width];
            if has_core[s] {
                let pixels = bins.iter_mut().zip(&core.as_slice()[run]);
                pixels.for_each(|(bin, core)| *bin = if *core { *bin } else { NONE });
            }
            grouped[ends[s]..][..bins.len()].copy_from_slice(bins);
            ends[s] += bins.len();
        }
    }
    (grouped, ends)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;

    use super::*;
    use crate::color::lab;
    use crate::facets::bins::{direction_bin, lab_bin};
    use crate::regions::Segments;

    /// Superpixels of one row, all core.
    fn row(labels: Vec<i32>) -> Superpixels {
        let labels = Raster::from_vec(labels.len(), 1, labels).unwrap();
        Superpixels { core: labels.map(|_| true), segments: Segments::from_labels(&labels) }
    }

    /// Intersection of two histograms that are counted in maps, with exact bins.
    fn naive(bins_a: &[usize], bins_b: &[usize]) -> f64 {
        let count = |bins: &[usize]| {
            let mut map = HashMap::new();
            bins.iter().for_each(|b| *map.entry(*b).or_insert(0.0) += 1.0 / bins.len() as f64);
            map
        };
        let (a, b) = (count(bins_a), count(bins_b));
        a.iter().map(|(bin, x)| f64::min(*x, *b.get(bin).unwrap_or(&0.0))).sum()
    }

    proptest! {
        #[test]
        fn difference_is_the_naive_one(
            pixels in prop::collection::vec((any::<[u8; 3]>(), prop::array::uniform3(-1.0_f32..1.0)), 2..40),
            omega in 0.0_f64..1.0,
        ) {
            let n = pixels.len();
            let superpixels = row((0..n as i32).map(|i| i % 2).collect());
            let color = Raster::from_vec(n, 1, pixels.iter().map(|p| p.0).collect()).unwrap();
            let unit = |p: &([u8; 3], [f32; 3])| glam::Vec3::from(p.1).normalize_or_zero().to_array();
            let normals = Raster::from_vec(n, 1, pixels.iter().map(unit).collect()).unwrap();
            let params = params::Appearance { color_weight: omega, ..Default::default() };
            let appearance = Appearance::new(&superpixels, Some(&color), &normals, &params);

            let of = |s: usize, f: &dyn Fn(usize) -> usize| (s..n).step_by(2).map(f).collect::<Vec<_>>();
            let by_color = |i: usize| lab_bin(lab(color[i]), 8);
            let by_normal = |i: usize| direction_bin(normals[i], &params);
            let expected = 1.0
                - omega * naive(&of(0, &by_color), &of(1, &by_color))
                - (1.0 - omega) * naive(&of(0, &by_normal), &of(1, &by_normal));
            let got = appearance.difference(0, 1);
            prop_assert!((got - expected).abs() < 1e-5, "{} {}", got, expected);
            prop_assert!((got - appearance.difference(1, 0)).abs() < 1e-12);
            prop_assert!(appearance.difference(0, 0).abs() < 1e-5);
        }
    }

    #[test]
    fn without_core_all_pixels_count_and_with_core_only_core() {
        let mut superpixels = row(vec![0, 0, 1, 1]);
        superpixels.core.as_mut_slice().copy_from_slice(&[true, false, false, false]);
        let color = Raster::from_vec(4, 1, vec![[255; 3], [0; 3], [255; 3], [0; 3]]).unwrap();
        let normals = Raster::filled(4, 1, [0.0, 0.0, -1.0]).unwrap();
        let by_color = params::Appearance { color_weight: 1.0, ..Default::default() };
        let appearance = Appearance::new(&superpixels, Some(&color), &normals, &by_color);
        // All of superpixel 0 is white, half of superpixel 1.
        assert!((appearance.difference(0, 1) - 0.5).abs() < 1e-6);
    }
}
