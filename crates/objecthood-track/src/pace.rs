//! How long frames last.

use serde::{Deserialize, Serialize};

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
    /// Longer pauses are gaps, which say nothing of the pace (s).
    pub(crate) const GAP_S: f64 = 0.3;

    pub(crate) fn after(self, pause_s: f64) -> Self {
        if pause_s > 0.0 && pause_s <= Self::GAP_S {
            Self { frame_s: 0.8 * self.frame_s + 0.2 * pause_s }
        } else {
            self
        }
    }

    /// The frames in a time, at least 2.
    pub(crate) fn frames(self, seconds: f64) -> usize {
        ((seconds / self.frame_s).round() as usize).max(2)
    }
}
