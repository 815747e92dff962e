//! What the tracker is made of, each of which can be left out to measure what it gains.

use serde::{Deserialize, Serialize};

/// A part of the method that can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Ingredient {
    /// The motion of the camera.
    Camera,
    /// Hands and people are told from objects.
    Agents,
    /// The motion of every object predicts where it is seen.
    Motion,
    /// Tracks that were hidden or moved far are found again by their looks, size and reach; those that move, among the hypotheses that are no
    /// objects; and those in a hand, on another face or by their colours.
    Finding,
    /// Known things that no segment of the frame shows are held where they should be.
    Holding,
    /// What motion proved: parts that are one, things that are not.
    Knowledge,
    /// Labels are steadied where nothing changes.
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
