//! Whether frames show something as one segment or in pieces. A single frame may be wrong; where nothing
//! moves, most frames decide (ours).

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::associate::Overlap;
use crate::memory::Memory;
use crate::pace::Pace;
use crate::scene::Key;
use crate::segment::Segment;
use crate::track::RESTING_CHANGE;

/// Earlier frames are forgotten with this time constant (s).
const VOTES_S: f64 = 0.5;
/// A frame has at most this weight, however long it lasts: a few frames decide, never one alone.
const MOST_WEIGHT: f64 = 0.15;
/// What is one stays one while at least this share of the last frames shows it as one. It is less than half,
/// so that one frame is not enough to separate it.
const STAYS_ONE: f64 = 0.4;
/// Two tracks turn out to be one if at least this share shows them as one, ...
const IS_ONE: f64 = 0.8;
/// ... unless the share was once below this: then they were clearly two, and what is seen now is a worse view
/// of them.
const WAS_TWO: f64 = 0.2;

/// The share of the last frames that show something as one, and the least that this share has been.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Oneness {
    share: f64,
    least: f64,
}

impl Default for Oneness {
    fn default() -> Self {
        Self { share: 0.5, least: 0.5 }
    }
}

impl Oneness {
    /// Counts a frame.
    pub(crate) fn count(&mut self, is_one: bool, pace: Pace) {
        let weight = (pace.frame_s / VOTES_S).min(MOST_WEIGHT);
        self.share += weight * (f64::from(u8::from(is_one)) - self.share);
        self.least = self.least.min(self.share);
    }

    /// Whether one thing that comes in pieces in this frame is still one.
    pub(crate) fn holds(self) -> bool {
        self.share > STAYS_ONE
    }

    /// Whether two tracks turn out to be one.
    pub(crate) fn is_proved(self) -> bool {
        self.share > IS_ONE && self.least > WAS_TWO
    }
}

impl Memory {
    /// Counts a frame for every track that rests, of which nothing has changed, and that no agent reaches:
    /// whether one segment shows it, or several do. `fresh`: segments that show no known track.
    pub(crate) fn vote_on_wholes(
        &mut self,
        segments: &[Segment],
        keys: &[Key],
        fresh: &[(usize, Key)],
        overlap: &Overlap,
    ) {
        let mut shown: BTreeMap<Key, usize> = BTreeMap::new();
        keys.iter().for_each(|&key| *shown.entry(key).or_default() += 1);
        let pieces = fresh.iter().filter_map(|&(k, _)| self.came_off(k, &segments[k], overlap));
        let in_pieces: BTreeSet<Key> = pieces.collect();
        for (k, key) in keys.iter().enumerate() {
            let Some(track) = self.tracks.get_mut(key) else { continue };
            let is_first = !keys[..k].contains(key);
            if is_first && track.is_left_alone() && segments[k].changed < RESTING_CHANGE {
                track.oneness.count(shown[key] == 1 && !in_pieces.contains(key), self.pace);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(frames: impl IntoIterator<Item = bool>) -> Oneness {
        after_at(30.0, frames)
    }

    fn after_at(frames_per_s: f64, frames: impl IntoIterator<Item = bool>) -> Oneness {
        let mut oneness = Oneness::default();
        let pace = Pace { frame_s: 1.0 / frames_per_s };
        frames.into_iter().for_each(|is_one| oneness.count(is_one, pace));
        oneness
    }

    #[test]
    fn most_frames_decide() {
        assert!(after([]).holds() && after([false]).holds(), "a single frame parts nothing");
        assert!(after_at(5.0, [false]).holds(), "nor does it at 5 frames a second");
        assert!(after((0..60).map(|k| k % 2 == 0)).holds(), "every second frame");
        assert!(!after([false; 5]).holds(), "it was two from its second frame on");
        assert!(!after([true; 60].into_iter().chain([false; 20])).holds(), "it came apart for good");
    }

    #[test]
    fn two_are_one_when_frames_say_so_and_they_were_never_clearly_two() {
        assert!(!after([true; 5]).is_proved(), "a sixth of a second");
        assert!(after([true; 20]).is_proved());
        assert!(!after_at(5.0, [true; 3]).is_proved(), "three slow frames");
        assert!(!after([false; 20].into_iter().chain([true; 60])).is_proved(), "a worse view of two");
    }
}
