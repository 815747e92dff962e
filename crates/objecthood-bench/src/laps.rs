//! How long the stages of a frame take.

use objecthood::{Observer, Output};

use crate::figure::{Now, Spent};

/// Takes the time of every stage.
pub struct Laps {
    since: Now,
    /// The stages in their order, each with what it took.
    pub laps: Vec<(&'static str, Spent)>,
}

impl Laps {
    /// Begins the first lap.
    pub fn start() -> Self {
        Self { since: Spent::now(), laps: Vec::new() }
    }
}

impl Observer for Laps {
    fn observe(&mut self, output: Output<'_>) {
        self.laps.push((output.stage().name(), self.since.elapsed()));
        self.since = Spent::now();
    }
}
