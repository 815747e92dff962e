//! Random numbers that are the same on every machine, in sequence or by address.
//!
//! Both are `SplitMix64` (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, 2014). Numbers by
//! address make noise independent of the order in which pixels are computed.

use std::f64::consts::TAU;
use std::ops::Range;

const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number in [0, 1) from the upper 53 bits.
fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// A sequence of random numbers.
pub struct Rng {
    state: u64,
}

impl Rng {
    /// The sequence with this seed; `stream` tells apart sequences of one seed.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self { state: mix(seed ^ mix(stream.wrapping_add(GOLDEN))) }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix(self.state)
    }

    /// Uniform in the range.
    pub fn range(&mut self, range: Range<f64>) -> f64 {
        range.start + (range.end - range.start) * unit(self.bits())
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        unit(self.bits()) < probability
    }

    /// A number in 0..n; n must not be 0.
    pub fn below(&mut self, n: usize) -> usize {
        (unit(self.bits()) * n as f64) as usize
    }

    /// One of these; there must be one.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }
}

/// Random numbers by address: two coordinates in one of the streams of a seed.
#[derive(Clone, Copy)]
pub(crate) struct Field {
    key: u64,
}

impl Field {
    pub(crate) fn new(seed: u64, stream: u64) -> Self {
        Self { key: mix(seed ^ mix(stream.wrapping_mul(GOLDEN).wrapping_add(1))) }
    }

    fn bits(self, u: i64, v: i64) -> u64 {
        mix(mix(self.key.wrapping_add((u as u64).wrapping_mul(GOLDEN)))
            ^ (v as u64).wrapping_mul(0xd6e8_feb8_6659_fd93))
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(self, u: i64, v: i64) -> f64 {
        unit(self.bits(u, v))
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(crate) fn normal(self, u: i64, v: i64) -> f64 {
        let bits = self.bits(u, v);
        let (radius, angle) = (1.0 - unit(bits), unit(mix(bits ^ GOLDEN)));
        (-2.0 * libm::log(radius)).sqrt() * libm::cos(TAU * angle)
    }

    /// Uniform values with mean 0 and deviation 1 on a lattice of `cell` units, joined smoothly (the cubic of Catmull
    /// and Rom 1974): features of about a cell.
    pub(crate) fn slow(self, u: f64, v: f64, cell: f64) -> f64 {
        let (x, y) = (u / cell, v / cell);
        let (i, j) = (x.floor(), y.floor());
        let (wx, wy) = (cubic(x - i), cubic(y - j));
        let mut sum = 0.0;
        for (b, wy) in wy.into_iter().enumerate() {
            for (a, wx) in wx.into_iter().enumerate() {
                sum += wx * wy * (self.unit(i as i64 + a as i64 - 1, j as i64 + b as i64 - 1) - 0.5);
            }
        }
        sum * 12_f64.sqrt()
    }
}

/// Weights of the four neighbours of a place `x` in [0, 1) between the second and the third.
fn cubic(x: f64) -> [f64; 4] {
    let (x2, x3) = (x * x, x * x * x);
    [
        (-x + 2.0 * x2 - x3) / 2.0,
        (2.0 - 5.0 * x2 + 3.0 * x3) / 2.0,
        (x + 4.0 * x2 - 3.0 * x3) / 2.0,
        (x3 - x2) / 2.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pinned, so that a scene's number keeps meaning the same scene.
    #[test]
    fn the_numbers_never_change() {
        let mut rng = Rng::new(7, 0);
        let field = Field::new(7, 0);
        let numbers = [rng.bits(), rng.bits(), field.bits(0, 0), field.bits(-1, 5)];
        assert_eq!(numbers, PINNED);
        assert_eq!(field.normal(3, 4).to_bits(), PINNED_NORMAL);
    }

    const PINNED: [u64; 4] = [
        8_879_317_973_683_161_050,
        12_264_814_258_053_725_385,
        2_290_641_772_096_332_958,
        16_319_586_212_240_611_068,
    ];
    const PINNED_NORMAL: u64 = 4_581_207_068_115_524_280;

    #[test]
    fn normal_values_are_normal() {
        let field = Field::new(1, 2);
        let values: Vec<f64> = (0..200).flat_map(|u| (0..200).map(move |v| field.normal(u, v))).collect();
        let mean = values.iter().sum::<f64>() / 4e4;
        let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 4e4;
        let beyond_two = values.iter().filter(|x| x.abs() > 2.0).count() as f64 / 4e4;
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.03, "{mean} {variance}");
        assert!((beyond_two - 0.0455).abs() < 0.004, "{beyond_two}");
        let neighbours: f64 = values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 4e4;
        assert!(neighbours.abs() < 0.02, "{neighbours}");
    }

    #[test]
    fn slow_values_run_through_the_lattice() {
        let field = Field::new(3, 1);
        let knot = (field.unit(2, -3) - 0.5) * 12_f64.sqrt();
        assert!((field.slow(20.0, -30.0, 10.0) - knot).abs() < 1e-12);
        assert!((field.slow(20.0, 4.999_999, 10.0) - field.slow(20.0, 5.0, 10.0)).abs() < 1e-5);
    }
}
