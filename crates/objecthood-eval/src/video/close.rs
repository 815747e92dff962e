//! %75: how many objects of a frame are close to what was found, as [`crate::metrics`] has it for images.

use std::ops::AddAssign;

use super::overlap::{FrameOverlap, Overlaps};
use crate::assignment::maximize;
use crate::metrics::pair_f;

/// A sum over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CloseSum {
    shares: f64,
    frames: u64,
}

impl CloseSum {
    /// Sums up. One assignment a frame, O(r² c) for its r objects and c tracks.
    pub fn of(overlaps: &Overlaps) -> Self {
        let with_objects = overlaps.frames.iter().filter(|frame| !frame.objects.is_empty());
        with_objects.fold(Self::default(), |mut sum, frame| {
            sum += Self { shares: share(frame), frames: 1 };
            sum
        })
    }

    /// The mean over the frames that show an object, `None` when none does.
    pub fn mean(&self) -> Option<f64> {
        (self.frames > 0).then(|| self.shares / self.frames as f64)
    }
}

/// Share of the objects of a frame whose track has F > 0.75; objects and tracks are paired so that the sum of F is greatest.
fn share(frame: &FrameOverlap) -> f64 {
    let f = frame.matrix(|pair| pair_f(pair.px, frame.objects[pair.object].px, frame.tracks[pair.track].px));
    let columns = frame.tracks.len();
    let pairs = maximize(&f, frame.objects.len(), columns);
    let close = pairs.into_iter().filter(|&(row, column)| f[row * columns + column] > 0.75).count();
    close as f64 / frame.objects.len() as f64
}

impl AddAssign for CloseSum {
    fn add_assign(&mut self, other: Self) {
        self.shares += other.shares;
        self.frames += other.frames;
    }
}
