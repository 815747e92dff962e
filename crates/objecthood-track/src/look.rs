//! What a thing looks like: its colours.

use objecthood::color::lab;
use serde::{Deserialize, Serialize};

/// Lightness in 4 steps, a and b in 8 each.
const BINS: usize = 4 * 8 * 8;
/// The least weight of a new look in the mean: a third of a second counts at 30 frames a second.
const LEAST_WEIGHT: f32 = 0.1;

/// Colours of a smaller share are noise.
const RARE: f32 = 0.01;

/// Shares of colours. They sum to 1, or to 0 without colour.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Look {
    shares: Vec<f32>,
    samples: u32,
    /// The number of looks that were added to the first.
    added: u32,
}

impl Default for Look {
    fn default() -> Self {
        Self { shares: vec![0.0; BINS], samples: 0, added: 0 }
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

    /// Adds a new look to the mean; the first one becomes the mean. The first ten looks count alike, then old
    /// ones fade. A look without colour is ignored.
    pub(crate) fn learn(&mut self, new: &Self) {
        match (self.is_empty(), new.is_empty()) {
            (_, true) => {}
            (true, false) => *self = new.clone(),
            (false, false) => {
                self.added = self.added.saturating_add(1);
                let weight = LEAST_WEIGHT.max(1.0 / (self.added as f32 + 1.0));
                for (mean, share) in self.shares.iter_mut().zip(&new.shares) {
                    *mean += weight * (share - *mean);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(rgb: [u8; 3]) -> Look {
        let mut look = Look::default();
        look.add(rgb);
        look.finish();
        look
    }

    #[test]
    fn the_first_looks_count_alike_and_an_empty_one_changes_nothing() {
        let (red, blue) = ([200, 30, 30], [30, 30, 200]);
        let mut mean = look(red);
        mean.learn(&look(blue));
        mean.learn(&Look::default());
        assert_eq!(Look::shares([&mean, &mean], red), [0.5; 2]);
        mean.learn(&look(red));
        let [share, _] = Look::shares([&mean, &mean], red);
        assert!((share - 2.0 / 3.0).abs() < 1e-6, "{share}");
    }
}
