//! Right, wrong and missed: what precision and recall are read off.

use std::ops::AddAssign;

use serde::{Serialize, Serializer};

/// Of several clips the counts are summed, so that every statement weighs the same (micro-average).
///
/// Serialized with `precision`, `recall` and `f`, each `null` where it is about nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// What was said and is so.
    pub right: u64,
    /// What was said and is not so.
    pub wrong: u64,
    /// What is so and was not said.
    pub missed: u64,
}

impl Counts {
    /// Share of what was said that is so; `None` when nothing was said.
    pub fn precision(&self) -> Option<f64> {
        share(self.right, self.right + self.wrong)
    }

    /// Share of what is so that was said; `None` when nothing is so.
    pub fn recall(&self) -> Option<f64> {
        share(self.right, self.right + self.missed)
    }

    /// Harmonic mean of both; `None` when nothing was said and nothing is so.
    pub fn f(&self) -> Option<f64> {
        share(2 * self.right, 2 * self.right + self.wrong + self.missed)
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.missed += other.missed;
    }
}

#[derive(Serialize)]
struct Shown {
    right: u64,
    wrong: u64,
    missed: u64,
    precision: Option<f64>,
    recall: Option<f64>,
    f: Option<f64>,
}

impl Serialize for Counts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { right, wrong, missed } = *self;
        let (precision, recall, f) = (self.precision(), self.recall(), self.f());
        Shown { right, wrong, missed, precision, recall, f }.serialize(serializer)
    }
}

/// A part of a whole; `None` of nothing.
pub(crate) fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}
