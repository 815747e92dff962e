//! The depths of a frame as numbers: how many are different, how far they reach.

use objecthood::Frame;

use super::{Cause, Certainty, Finding};

/// Images of 8 bits have no more different values than this.
const EIGHT_BITS: usize = 256;

/// Depth that is measured has more values than this for each metre that it spans beyond a tenth of one: stereo at 4 m still has
/// 60, and 8 bits over 4 m have 64 in all.
const FEWEST_A_METRE: f64 = 120.0;

/// Below this span (m) few values are natural.
const LEAST_SPAN_M: f64 = 0.2;

/// A flat, even surface seen straight on has noise; depth that spans less than this share of itself is made up.
const CONSTANT_SHARE: f64 = 1e-4;

/// With fewer depths nothing is said.
const FEWEST: usize = 1000;

/// What the frames have in common.
#[derive(Debug, Default)]
pub(super) struct Values {
    pixels: usize,
    valid: usize,
    /// Of each frame the depths (m) between which nine tenths lie.
    ranges_m: Vec<[f64; 2]>,
    /// The most different depths of a frame.
    most_different: usize,
}

impl Values {
    /// Looks at a frame; what is wrong with its numbers.
    pub(super) fn look(&mut self, frame: &Frame) -> Option<Finding> {
        let mut depths: Vec<f32> =
            frame.depth_m().as_slice().iter().copied().filter(|z| !z.is_nan()).collect();
        depths.sort_unstable_by(f32::total_cmp);
        self.pixels += frame.depth_m().as_slice().len();
        self.valid += depths.len();
        let at =
            |share: f64| f64::from(depths[((share * depths.len() as f64) as usize).min(depths.len() - 1)]);
        if depths.is_empty() {
            return None;
        }
        self.ranges_m.push([at(0.05), at(0.95)]);
        let (nearest, farthest, count) = (at(0.0), at(1.0), depths.len());
        // Between the outermost hundredths, so that stray pixels do not stretch the span.
        let (near, far) = (at(0.01), at(0.99));
        let span_m = far - near;
        depths.dedup();
        self.most_different = self.most_different.max(depths.len());
        if count < FEWEST {
            return None;
        }
        if farthest - nearest < CONSTANT_SHARE * farthest {
            let reason =
                format!("every depth is {nearest:.3} m, as no sensor measures: this is no depth of a scene");
            return Some(Finding::new(Certainty::Sure, Cause::Constant, reason));
        }
        let is_coarse = depths.len() <= EIGHT_BITS && span_m > LEAST_SPAN_M;
        (is_coarse && (depths.len() as f64) < FEWEST_A_METRE * span_m).then(|| {
            let reason = format!(
                "there are only {} different depths between {near:.2} and {far:.2} m, as in an image of 8 bits: the depth was saved or read with 8 bits instead of 16",
                depths.len()
            );
            Finding::new(Certainty::Sure, Cause::EightBit, reason)
        })
    }

    /// The depths (m) between which nine tenths of the pixels lie, in the frame in the middle.
    pub(super) fn range_m(&self) -> [f64; 2] {
        super::middle(&self.ranges_m, |range| range[1]).unwrap_or_default()
    }

    pub(super) fn valid_share(&self) -> f64 {
        self.valid as f64 / self.pixels.max(1) as f64
    }

    /// Bits that are enough for the different depths of a frame.
    pub(super) fn bits(&self) -> u32 {
        self.most_different.max(1).next_power_of_two().trailing_zeros()
    }
}
