//! The stages of both methods, in the order in which they run.

use std::fmt;

use serde::Serialize;

/// A stage of a method. The order of the variants is the order in which the stages run; neither method has all of them.
///
/// The four stages of the paper are [`Superpixels`](Self::Superpixels), [`Facets`](Self::Facets), [`Shapes`](Self::Shapes)
/// and objectness: all stages from [`Clusters`](Self::Clusters) on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Stage {
    /// The normal of the surface at every pixel.
    Normals,
    /// The curvature of the surface at every pixel, eq. 2 (`paper`).
    Curvature,
    /// Large planes that carry or enclose the objects (`context`).
    Structure,
    /// Stage 1: small regions of one surface.
    Superpixels,
    /// Stage 2: faces of convex shapes.
    Facets,
    /// Evidence from the common borders of facets (`context`).
    Borders,
    /// Stage 3: facets joined across convex edges.
    Shapes,
    /// Shapes joined by their surroundings (`context`).
    Clusters,
    /// The direction up and the support graph.
    Support,
    /// Regions that may be objects, with their scores.
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
