//! How long the stages of a frame take.

use objecthood::{Observer, Stage};

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
    fn observe(&mut self, stage: Stage<'_>) {
        let name = match stage {
            Stage::Normals(_) => "normals",
            Stage::Curvature(_) => "curvature",
            Stage::Structure(_) => "structure",
            Stage::Superpixels(_) => "superpixels",
            Stage::Facets(_) => "facets",
            Stage::Borders { .. } => "borders",
            Stage::Shapes(_) => "shapes",
            Stage::Clusters { .. } => "clusters",
            Stage::Hypotheses(_) => "hypotheses",
            Stage::Support { .. } => "support",
            Stage::Objects(_) => "objects",
            _ => "another stage",
        };
        self.laps.push((name, self.since.elapsed()));
        self.since = Spent::now();
    }
}
