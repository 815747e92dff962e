//! The numbers of frames as they were given, including those that were passed over.

use serde::{Deserialize, Serialize};

/// This many runs are kept: no more events refer to frames before them.
const MOST_RUNS: usize = 1000;

/// Converts frames of the memory, which counts only processed frames, to numbers of the given frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbering {
    /// The number of frames that were given.
    given: u64,
    /// Runs. Each says: from this frame of the memory on, frames were given without a pause, beginning with
    /// this number.
    runs: Vec<(u64, u64)>,
}

impl Numbering {
    /// The next given frame becomes this frame of the memory.
    pub(crate) fn take(&mut self, frame: u64) {
        if self.runs.is_empty() || self.of(frame) != self.given {
            self.runs.push((frame, self.given));
            if self.runs.len() > MOST_RUNS {
                self.runs.remove(0);
            }
        }
        self.given += 1;
    }

    /// The next given frame is passed over.
    pub(crate) fn skip(&mut self) {
        self.given += 1;
    }

    /// The memory starts over.
    pub(crate) fn begin_anew(&mut self) {
        self.runs.clear();
    }

    /// The given number of a frame of the memory.
    pub(crate) fn of(&self, frame: u64) -> u64 {
        let run = self.runs.iter().rev().find(|run| run.0 <= frame).or(self.runs.first());
        run.map_or(frame, |&(first, number)| number + frame.saturating_sub(first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_shows_nothing_counts_too() {
        let mut numbering = Numbering::default();
        numbering.skip();
        (0..3).for_each(|frame| numbering.take(frame));
        numbering.skip();
        numbering.skip();
        (3..5).for_each(|frame| numbering.take(frame));
        assert_eq!([0, 2, 3, 4].map(|frame| numbering.of(frame)), [1, 3, 6, 7]);
        numbering.begin_anew();
        numbering.take(0);
        assert_eq!(numbering.of(0), 8);
    }
}
