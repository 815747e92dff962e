//! The stages of both methods, in the order in which they run.

use std::fmt;

use serde::Serialize;

/// A stage of a method. Stages are ordered as they run; each method leaves out those that it does not have.
///
/// The four stages of the paper are [`Superpixels`](Self::Superpixels), [`Facets`](Self::Facets), [`Shapes`](Self::Shapes)
/// and, for its objectness, everything from [`Clusters`](Self::Clusters) on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Stage {
    /// The surface at every pixel, with its normal.
    Normals,
    /// How much the surface bends at every pixel, eq. 2 (`paper`).
    Curvature,
    /// Large planes that carry or enclose the objects (`context`).
    Structure,
    /// Stage 1: small regions of one surface.
    Superpixels,
    /// Stage 2: faces of convex shapes.
    Facets,
    /// What the common borders of facets tell (`context`).
    Borders,
    /// Stage 3: facets joined across convex edges.
    Shapes,
    /// What the surroundings of shapes join (`context`).
    Clusters,
    /// What stands on what.
    Support,
    /// What may be an object, with its score.
    Hypotheses,
    /// The objects.
    Objects,
}

impl Stage {
    /// Its name, as `objecthood segment -v` prints it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::Curvature => "curvature",
            Self::Structure => "structure",
            Self::Superpixels => "superpixels",
            Self::Facets => "facets",
            Self::Borders => "borders",
            Self::Shapes => "shapes",
            Self::Clusters => "clusters",
            Self::Support => "support",
            Self::Hypotheses => "hypotheses",
            Self::Objects => "objects",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
