//! Stage 3: facets joined across convex edges to shapes (paper, III-C).

pub mod contact;
pub mod convexity;
pub mod descriptor;
