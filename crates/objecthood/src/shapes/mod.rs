//! Stage 3: facets joined across convex edges to shapes (paper, III-C).
//!
//! `paper` looks at centres and mean normals: [`contact`], [`descriptor`], [`convexity`]. `context` gathers evidence along the whole
//! common border ([`border`]) and lets it vote ([`contraction`]).

pub mod border;
pub mod contact;
pub mod contraction;
pub mod convexity;
pub mod descriptor;
pub mod paper;
