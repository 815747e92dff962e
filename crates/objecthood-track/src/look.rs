//! What a thing looks like: its colours.

use objecthood::color::lab;
use serde::{Deserialize, Serialize};

/// Lightness in 4 steps, a and b in 8 each.
const BINS: usize = 4 * 8 * 8;
/// The weight of a new look in the mean.
const NEW_SHARE: f32 = 0.1;

/// Colours of a smaller share are noise.
const RARE: f32 = 0.01;

/// Shares of colours. They sum to 1, or to 0 without colour.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Look {
    shares: Vec<f32>,
    samples: u32,
}

impl Default for Look {
    fn default() -> Self {
        Self { shares: vec![0.0; BINS], samples: 0 }
    }
}

/// The index of this colour.
fn bin(rgb: [u8; 3]) -> usize {
    let [l, a, b] = lab(rgb);
    let step = |x: f32, first: f32, width: f32, steps: usize| {
        (((x - first) / width).max(0.0) as usize).min(steps - 1)
    };
    // Most things have little chroma: the steps of a and b are 16 wide about grey.
    (step(l, 0.0, 25.0, 4) * 8 + step(a, -64.0, 16.0, 8)) * 8 + step(b, -64.0, 16.0, 8)
}

impl Look {
    pub(crate) fn add(&mut self, rgb: [u8; 3]) {
        self.shares[bin(rgb)] += 1.0;
        self.samples += 1;
    }

    /// The shares of a colour in two looks.
    pub(crate) fn shares(looks: [&Self; 2], rgb: [u8; 3]) -> [f32; 2] {
        let bin = bin(rgb);
        looks.map(|look| look.shares[bin])
    }

    pub(crate) fn finish(&mut self) {
        let n = self.samples.max(1) as f32;
        self.shares.iter_mut().for_each(|share| *share /= n);
    }

    /// The difference of two looks: 0 for equal looks, 1 for looks without a common colour; `None` without
    /// colour.
    pub(crate) fn distance(&self, other: &Self) -> Option<f64> {
        if self.is_empty() || other.is_empty() {
            return None;
        }
        let common: f32 = self.shares.iter().zip(other.shares.iter()).map(|(a, b)| a.min(*b)).sum();
        Some(1.0 - f64::from(common))
    }

    /// The share of this look that has colours of another look; `None` without colour.
    pub(crate) fn share_of(&self, whole: &Self) -> Option<f64> {
        if self.is_empty() || whole.is_empty() {
            return None;
        }
        let shares = self.shares.iter().zip(whole.shares.iter());
        Some(shares.filter(|&(_, &share)| share > RARE).map(|(&own, _)| f64::from(own)).sum())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// Adds a new look to the mean; the first one becomes the mean. A look without colour is ignored.
    pub(crate) fn learn(&mut self, new: &Self) {
        match (self.is_empty(), new.is_empty()) {
            (_, true) => {}
            (true, false) => *self = new.clone(),
            (false, false) => self.blend(new, NEW_SHARE),
        }
    }

    /// Makes a new look the n-th of the mean of looks. Looks of long ago are forgotten.
    pub(crate) fn average(&mut self, new: &Self, n: u32) {
        self.blend(new, NEW_SHARE.max(1.0 / n as f32));
    }

    fn blend(&mut self, new: &Self, weight: f32) {
        for (mean, share) in self.shares.iter_mut().zip(new.shares.iter()) {
            *mean += weight * (share - *mean);
        }
    }
}
