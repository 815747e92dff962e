//! The numbers of frames: as they are given, those too of which nothing is known.

use serde::{Deserialize, Serialize};

/// So many runs are kept: frames before them are about no more events.
const MOST_RUNS: usize = 1000;

/// Turns the frames of the memory, which knows only those that it has seen, into numbers of the frames that were given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbering {
    /// Frames that were given.
    given: u64,
    /// Each: from this frame of the memory on they were given one after the other, beginning with this number.
    runs: Vec<(u64, u64)>,
}

impl Numbering {
    /// The next frame that is given is this one of the memory.
    pub(crate) fn take(&mut self, frame: u64) {
        if self.runs.is_empty() || self.of(frame) != self.given {
            self.runs.push((frame, self.given));
            if self.runs.len() > MOST_RUNS {
                self.runs.remove(0);
            }
        }
        self.given += 1;
    }

    /// Nothing is known of the next frame that is given.
    pub(crate) fn skip(&mut self) {
        self.given += 1;
    }

    /// The memory begins anew.
    pub(crate) fn begin_anew(&mut self) {
        self.runs.clear();
    }

    /// The number of a frame of the memory.
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
