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

/// Cases that came out well, of all. Of several clips they are summed. Serialized with their `share`, `null` of none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cases {
    /// Those that came out well.
    pub right: u64,
    /// All of them.
    pub all: u64,
}

impl Cases {
    /// Adds a case.
    pub fn add(&mut self, is_right: bool) {
        self.all += 1;
        self.right += u64::from(is_right);
    }

    /// Share of the cases that came out well; `None` of none.
    pub fn share(&self) -> Option<f64> {
        share(self.right, self.all)
    }
}

impl AddAssign for Cases {
    fn add_assign(&mut self, other: Self) {
        self.right += other.right;
        self.all += other.all;
    }
}

impl Serialize for Cases {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { right, all } = *self;
        ShownCases { right, all, share: self.share() }.serialize(serializer)
    }
}

#[derive(Serialize)]
struct ShownCases {
    right: u64,
    all: u64,
    share: Option<f64>,
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
