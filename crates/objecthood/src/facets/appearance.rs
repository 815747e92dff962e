//! How a superpixel looks: its colours and the directions it faces (paper, eq. 3).

use std::f32::consts::PI;

use crate::color::lab;
use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;

/// Normalised histograms of every superpixel: colours, and normals. An empty one is all zero.
#[derive(Clone, Debug)]
pub struct Appearance {
    color_weight: f64,
    color: Histograms,
    normal: Histograms,
}

impl Appearance {
    /// Counts the core pixels of every superpixel; one without any counts all its pixels. O(pixels).
    ///
    /// `color`: sRGB, unsmoothed; none leaves the colour histograms empty. `normals`: unit, zero = none.
    pub fn new(
        superpixels: &Superpixels,
        color: Option<&Raster<[u8; 3]>>,
        normals: &Raster<[f32; 3]>,
        params: &params::Appearance,
    ) -> Self {
        let segments = &superpixels.segments;
        let mut has_core = vec![false; segments.count()];
        segments.members().filter(|&(i, _)| superpixels.core[i]).for_each(|(_, s)| has_core[s] = true);

        let speaking = || segments.members().filter(|&(i, s)| superpixels.core[i] || !has_core[s]);
        let colors = speaking().filter_map(|(i, s)| Some((s, lab_bin(lab(color?[i]), params.lab_bins))));
        let directions = speaking()
            .filter(|&(i, _)| normals[i] != [0.0; 3])
            .map(|(i, s)| (s, direction_bin(normals[i], params)));
        Self {
            color_weight: params.color_weight,
            color: Histograms::new(segments.count(), colors),
            normal: Histograms::new(segments.count(), directions),
        }
    }

    /// How much superpixels `a` and `b` differ, in [0, 1]: one minus the weighted mean of the intersections of
    /// their histograms, ω = `color_weight`. O(occupied bins of both).
    ///
    /// *Differs from the paper:* eq. 3 as printed is a similarity, while its text needs a distance.
    pub fn difference(&self, a: usize, b: usize) -> f64 {
        let similarity = self.color_weight * self.color.intersection(a, b)
            + (1.0 - self.color_weight) * self.normal.intersection(a, b);
        1.0 - similarity
    }
}

/// One histogram a superpixel: its occupied bins only, because most are empty.
#[derive(Clone, Debug)]
struct Histograms {
    /// Bins in ascending order with the share of the superpixel's pixels, superpixel after superpixel.
    bins: Vec<(u32, f32)>,
    /// Where the bins of each superpixel start; one more, where the last end.
    starts: Vec<usize>,
}

impl Histograms {
    /// Counts (superpixel, bin) for `count` superpixels. O(n) for n observations: the sort is a radix sort.
    fn new(count: usize, observed: impl Iterator<Item = (usize, usize)>) -> Self {
        let mut keys: Vec<u64> = observed.map(|(s, bin)| ((s as u64) << 32) | bin as u64).collect();
        radsort::sort(&mut keys);
        let mut bins = Vec::new();
        let mut starts = vec![0];
        let mut rest = keys.as_slice();
        for s in 0..count {
            let (own, others) = rest.split_at(rest.partition_point(|key| key >> 32 <= s as u64));
            let runs = own.chunk_by(|a, b| a == b);
            bins.extend(runs.map(|run| (run[0] as u32, run.len() as f32 / own.len() as f32)));
            starts.push(bins.len());
            rest = others;
        }
        Self { bins, starts }
    }

    /// Sum of the smaller of both shares over all bins (Swain and Ballard 1991), in [0, 1].
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

/// The bin of a colour: L over [0, 100], a and b over [-64, 64], what lies beyond in the outermost bin.
fn lab_bin([l, a, b]: [f32; 3], bins: usize) -> usize {
    let axis = |share: f32| bin_of(share, bins);
    (axis(l / 100.0) * bins + axis((a + 64.0) / 128.0)) * bins + axis((b + 64.0) / 128.0)
}

/// The bin of a normal: its inclination from the camera's up (acos of -y) and its azimuth around it.
fn direction_bin([x, y, z]: [f32; 3], params: &params::Appearance) -> usize {
    let inclination = libm::acosf((-y).clamp(-1.0, 1.0)) / PI;
    let azimuth = (libm::atan2f(x, -z) + PI) / (2.0 * PI);
    bin_of(inclination, params.inclination_bins) * params.azimuth_bins + bin_of(azimuth, params.azimuth_bins)
}

fn bin_of(share: f32, bins: usize) -> usize {
    ((share * bins as f32).max(0.0) as usize).min(bins - 1)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use proptest::prelude::*;

    use super::*;
    use crate::regions::Segments;

    /// Superpixels of one row, all core.
    fn row(labels: Vec<i32>) -> Superpixels {
        let labels = Raster::from_vec(labels.len(), 1, labels).unwrap();
        Superpixels { core: labels.map(|_| true), segments: Segments::from_labels(&labels) }
    }

    /// Intersection of two histograms counted in maps, with the bins computed anew.
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
    fn bins_of_known_colours_and_directions() {
        assert_eq!(lab_bin([0.0, -64.0, -64.0], 8), 0);
        assert_eq!(lab_bin([100.0, 200.0, 200.0], 8), 511);
        assert_eq!(lab_bin([50.0, 0.0, 0.0], 8), (4 * 8 + 4) * 8 + 4);
        let params = params::Appearance::default();
        // Up (camera -y) is inclination 0; the camera's own direction (-z) is azimuth 0, the middle.
        assert_eq!(direction_bin([0.0, -1.0, 0.0], &params) / 16, 0);
        assert_eq!(direction_bin([0.0, 1.0, 0.0], &params) / 16, 7);
        // Tilted a little downwards it is just past the middle of the inclinations.
        assert_eq!(direction_bin([0.0, 0.1, -0.99], &params), 4 * 16 + 8);
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
