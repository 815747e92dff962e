//! The ingredients of the tracker. Each can be left out to measure what it gains.

use serde::{Deserialize, Serialize};

/// A part of the method that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Ingredient {
    /// The motion of the camera.
    Camera,
    /// Hands and people are distinguished from objects.
    Agents,
    /// The motion of every object predicts where it will be seen.
    Motion,
    /// Tracks that were hidden or moved far are found again by looks, size and reach. Moving ones are also
    /// found among refused hypotheses, and things in a hand on another face or by their colours.
    Finding,
    /// Known things that no segment of the frame shows are held where they should be.
    Holding,
    /// What motion has proved is applied: parts that are one, things that are not.
    Knowledge,
    /// Labels are kept steady where nothing changes.
    Steadying,
}

impl Ingredient {
    /// All of them, in the order of the method.
    pub const ALL: [Self; 7] = [
        Self::Camera,
        Self::Agents,
        Self::Motion,
        Self::Finding,
        Self::Holding,
        Self::Knowledge,
        Self::Steadying,
    ];

    /// Its name on a command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Agents => "agents",
            Self::Motion => "motion",
            Self::Finding => "finding",
            Self::Holding => "holding",
            Self::Knowledge => "knowledge",
            Self::Steadying => "steadying",
        }
    }
}
