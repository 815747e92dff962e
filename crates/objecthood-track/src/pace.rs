//! The time between frames.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

/// Shorter pauses are no gaps, whatever the usual pause is (s).
const GAP_S: f64 = 0.3;
/// A gap is longer than this multiple of the usual pause. (A missing frame doubles a pause.)
const GAP_RATIO: f64 = 1.5;
/// The usual pause is the median of this many pauses,
const MOST_PAUSES: usize = 9;
/// and a source counts as slow only once this many are known: fast sources begin with one or two pauses.
const LEAST_PAUSES: usize = 3;

/// The time between frames.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Pace {
    /// Mean time between frames (s).
    pub(crate) frame_s: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl Pace {
    /// Before two frames are known: 30 frames a second.
    pub(crate) const UNKNOWN: Self = Self { frame_s: 1.0 / 30.0 };

    /// The pace after a pause (s). `earlier`: the pauses before it.
    pub(crate) fn after(self, pause_s: f64, earlier: &Pauses) -> Self {
        if pause_s > 0.0 && pause_s <= GAP_S {
            return Self { frame_s: 0.8 * self.frame_s + 0.2 * pause_s };
        }
        earlier.of_slow_source_s().map_or(self, |frame_s| Self { frame_s })
    }

    /// The number of frames in a time, at least 2.
    pub(crate) fn frames(self, seconds: f64) -> usize {
        ((seconds / self.frame_s).round() as usize).max(2)
    }
}

/// The pauses before the last frames (s).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Pauses(VecDeque<f64>);

impl Pauses {
    /// Whether a pause is much longer than usual. For the first pause this is unknown.
    pub(crate) fn is_gap(&self, pause_s: f64) -> bool {
        self.usual_s().is_some_and(|usual_s| pause_s > GAP_S.max(GAP_RATIO * usual_s))
    }

    /// The usual pause (s), if other sources would call it a gap.
    fn of_slow_source_s(&self) -> Option<f64> {
        self.usual_s().filter(|&usual_s| usual_s > GAP_S && self.0.len() >= LEAST_PAUSES)
    }

    /// Adds a pause. Before the first frame there is none.
    pub(crate) fn add(&mut self, pause_s: f64) {
        if pause_s > 0.0 {
            self.0.push_back(pause_s);
        }
        if self.0.len() > MOST_PAUSES {
            self.0.pop_front();
        }
    }

    /// The median; of two middle values the shorter one.
    fn usual_s(&self) -> Option<f64> {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len().saturating_sub(1) / 2).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pace after pauses (s), and those of them that were gaps.
    fn after(pauses_s: &[f64]) -> (f64, Vec<f64>) {
        let (mut pace, mut pauses, mut gaps_s) = (Pace::UNKNOWN, Pauses::default(), Vec::new());
        for &pause_s in pauses_s {
            gaps_s.extend(pauses.is_gap(pause_s).then_some(pause_s));
            pace = pace.after(pause_s, &pauses);
            pauses.add(pause_s);
        }
        (pace.frame_s, gaps_s)
    }

    /// Every frame followed a gap, and the pace stayed at 30 frames a second.
    #[test]
    fn a_slow_source_has_a_pace_and_few_gaps() {
        assert_eq!(after(&[0.5; 4]), (0.5, vec![]));
        assert_eq!(after(&[1.0, 1.1, 0.9, 1.0, 2.0, 1.0]), (1.0, vec![2.0]));
        assert_eq!(after(&[0.29, 0.31, 0.3, 0.32, 0.28, 0.31]).1, vec![]);
    }

    #[test]
    fn gaps_change_nothing_of_the_pace_of_a_fast_source() {
        let steady = |frame_s: f64| after(&[frame_s; 40]).0;
        for frame_s in [1.0 / 30.0, 0.2] {
            let with_gaps =
                [&[0.8, 0.7][..], &[frame_s; 20], &[0.31, 0.5, 0.4, 0.31], &[frame_s; 20]].concat();
            assert_eq!(after(&with_gaps), (steady(frame_s), vec![0.31, 0.5, 0.4, 0.31]));
        }
    }
}
