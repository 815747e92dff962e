//! How a superpixel looks: its colours and the directions it faces (paper, eq. 3).

use std::f32::consts::{FRAC_PI_2, PI};

use crate::color::{NEARLY_LAB_ERROR, lab, linear, nearly_lab};
use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;
use crate::simd::vectorized;

/// Normalised histograms of every superpixel: colours, and normals. An empty one is all zero.
#[derive(Clone, Debug)]
pub struct Appearance {
    color_weight: f64,
    color: Histograms,
    normal: Histograms,
}

impl Appearance {
    /// Counts the core pixels of every superpixel; one without any counts all its pixels. O(pixels); colours and
    /// normals in parallel.
    ///
    /// `color`: sRGB, unsmoothed; none leaves the colour histograms empty. `normals`: unit, zero = none.
    pub fn new(
        superpixels: &Superpixels,
        color: Option<&Raster<[u8; 3]>>,
        normals: &Raster<[f32; 3]>,
        params: &params::Appearance,
    ) -> Self {
        let width = normals.width();
        let row = |v: usize| v * width..(v + 1) * width;
        let color_bins = |v: usize, bins: &mut [i32]| match color {
            Some(color) => color_bins(&color.as_slice()[row(v)], params.lab_bins, bins),
            None => bins.fill(NONE),
        };
        let direction_bins =
            |v: usize, bins: &mut [i32]| direction_bins(&normals.as_slice()[row(v)], params, bins);
        superpixels.segments.find_runs();
        let (color, normal) = rayon::join(
            || Histograms::new(superpixels, color_bins),
            || Histograms::new(superpixels, direction_bins),
        );
        Self { color_weight: params.color_weight, color, normal }
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
    /// Counts the bins of the pixels of every superpixel, which `bins_of` writes row by row: first all bins of each superpixel side
    /// by side, then how often each occurs. O(n + k log k) for n pixels that occupy k bins.
    fn new(superpixels: &Superpixels, bins_of: impl Fn(usize, &mut [i32])) -> Self {
        let Superpixels { segments, core } = superpixels;
        let (width, height) = core.size();
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

/// The bin of a pixel that does not count.
const NONE: i32 = -1;
/// The bin of a pixel that is too near to a limit of bins.
const UNSURE: i32 = -2;

/// The bins of colours: L over [0, 100], a and b over [-64, 64], what lies beyond in the outermost bin.
///
/// What is nearly the colour decides where its error cannot change the bin, which is nearly always: all at once.
fn color_bins(colors: &[[u8; 3]], lab_bins: usize, bins: &mut [i32]) {
    let side = lab_bins as i32;
    let (error_l, error_ab) = (NEARLY_LAB_ERROR / 100.0, NEARLY_LAB_ERROR / 128.0);
    for (bins, colors) in bins.chunks_mut(SIDE_BY_SIDE).zip(colors.chunks(SIDE_BY_SIDE)) {
        let mut light = [[0.0; 3]; SIDE_BY_SIDE];
        light.iter_mut().zip(colors).for_each(|(light, rgb)| *light = linear(*rgb));
        vectorized(
            #[inline(always)]
            || {
                for (bin, light) in bins.iter_mut().zip(&light) {
                    let [l, a, b] = shares(nearly_lab(*light));
                    let [l, a, b] = [
                        sure_bin(l, error_l, side),
                        sure_bin(a, error_ab, side),
                        sure_bin(b, error_ab, side),
                    ];
                    *bin = if (l | a | b) < 0 { UNSURE } else { (l * side + a) * side + b };
                }
            },
        );
        for (bin, rgb) in bins.iter_mut().zip(colors).filter(|(bin, _)| **bin == UNSURE) {
            *bin = lab_bin(lab(*rgb), lab_bins) as i32;
        }
    }
}

/// Colours that are converted together.
const SIDE_BY_SIDE: usize = 64;

fn lab_bin(lab: [f32; 3], bins: usize) -> usize {
    let [l, a, b] = shares(lab);
    (bin_of(l, bins) * bins + bin_of(a, bins)) * bins + bin_of(b, bins)
}

#[inline(always)]
fn shares([l, a, b]: [f32; 3]) -> [f32; 3] {
    [l / 100.0, (a + 64.0) / 128.0, (b + 64.0) / 128.0]
}

/// The bins of normals: their inclination from the camera's up (acos of -y) and their azimuth around it; [`NONE`] without.
///
/// Polynomials decide where their error cannot change the bin, which is nearly always: all at once.
fn direction_bins(normals: &[[f32; 3]], params: &params::Appearance, bins: &mut [i32]) {
    let (inclination_bins, azimuth_bins) = (params.inclination_bins as i32, params.azimuth_bins as i32);
    vectorized(
        #[inline(always)]
        || {
            for (bin, &[x, y, z]) in bins.iter_mut().zip(normals) {
                let [inclination, azimuth] =
                    [nearly_acos(up(y)) / PI, (nearly_atan2(x, -z) + PI) / (2.0 * PI)];
                let inclination = sure_bin(inclination, ANGLE_ERROR, inclination_bins);
                let azimuth = sure_bin(azimuth, ANGLE_ERROR, azimuth_bins);
                let sure = inclination * azimuth_bins + azimuth;
                let is_some = (x != 0.0) | (y != 0.0) | (z != 0.0);
                let or_unsure = if (inclination | azimuth) < 0 { UNSURE } else { sure };
                *bin = if is_some { or_unsure } else { NONE };
            }
        },
    );
    for (bin, normal) in bins.iter_mut().zip(normals).filter(|(bin, _)| **bin == UNSURE) {
        *bin = direction_bin(*normal, params) as i32;
    }
}

fn direction_bin([x, y, z]: [f32; 3], params: &params::Appearance) -> usize {
    let inclination = libm::acosf(up(y)) / PI;
    let azimuth = (libm::atan2f(x, -z) + PI) / (2.0 * PI);
    bin_of(inclination, params.inclination_bins) * params.azimuth_bins + bin_of(azimuth, params.azimuth_bins)
}

/// The cosine of a normal's inclination.
#[inline(always)]
fn up(y: f32) -> f32 {
    (-y).clamp(-1.0, 1.0)
}

fn bin_of(share: f32, bins: usize) -> usize {
    ((share * bins as f32).max(0.0) as usize).min(bins - 1)
}

/// The bin of what is `share` but for an `error`; below 0 if it does not lie farther than that from the limits of the bin.
#[inline(always)]
fn sure_bin(share: f32, error: f32, bins: i32) -> i32 {
    let place = share * bins as f32;
    let bin = place as i32;
    let (past, margin) = (place - bin as f32, error * bins as f32);
    let is_sure = (past > margin) & (past < 1.0 - margin) & (bin < bins);
    if is_sure { bin } else { UNSURE }
}

/// More than [`nearly_acos`] errs in shares of π, and [`nearly_atan2`] in shares of 2π.
const ANGLE_ERROR: f32 = 3e-5;

/// The arc cosine but for 6.8e-5 (Abramowitz and Stegun 4.4.45).
#[inline(always)]
fn nearly_acos(x: f32) -> f32 {
    let t = x.abs();
    let positive = (1.0 - t).sqrt() * (1.570_728_8 + t * (-0.212_114_4 + t * (0.074_261 - 0.018_729_3 * t)));
    if x < 0.0 { PI - positive } else { positive }
}

/// The angle of (x, y) in -π..π but for 1.2e-5 (Abramowitz and Stegun 4.4.49); `NaN` of (0, 0).
#[inline(always)]
fn nearly_atan2(y: f32, x: f32) -> f32 {
    let ratio = x.abs().min(y.abs()) / x.abs().max(y.abs());
    let s = ratio * ratio;
    let first =
        ratio * (0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1))));
    let steep = if y.abs() > x.abs() { FRAC_PI_2 - first } else { first };
    let right = if x < 0.0 { PI - steep } else { steep };
    right.copysign(y)
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

    proptest! {
        #[test]
        fn bins_are_the_exact_ones(
            rgb in any::<[u8; 3]>(),
            // Also along the axes, where angles are the limits of bins.
            normal in prop::array::uniform3(prop_oneof![-1.0_f32..1.0, Just(0.0), Just(-0.0), Just(1.0), Just(-1.0)]),
            lab_bins in 1_usize..=32,
            inclination_bins in 1_usize..=180,
            azimuth_bins in 1_usize..=360,
        ) {
            let mut bins = [0];
            color_bins(&[rgb], lab_bins, &mut bins);
            prop_assert_eq!(bins[0], lab_bin(lab(rgb), lab_bins) as i32);
            let params = params::Appearance { inclination_bins, azimuth_bins, ..Default::default() };
            let unit = glam::Vec3::from(normal).normalize_or_zero().to_array();
            direction_bins(&[unit], &params, &mut bins);
            prop_assert_eq!(bins[0], if unit == [0.0; 3] { NONE } else { direction_bin(unit, &params) as i32 });
        }
    }

    #[test]
    fn polynomials_are_within_their_error() {
        for k in -100_000..=100_000 {
            let x = k as f32 / 100_000.0;
            assert!((nearly_acos(x) - libm::acosf(x)).abs() < ANGLE_ERROR * PI, "{x}");
            let (y, x) = (libm::sinf(x * PI), libm::cosf(x * PI));
            assert!((nearly_atan2(y, x) - libm::atan2f(y, x)).abs() < ANGLE_ERROR * 2.0 * PI, "{x} {y}");
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
