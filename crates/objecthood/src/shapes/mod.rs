//! Stage 3: facets joined across convex edges to shapes (paper, III-C).
//!
//! `paper` compares centres and mean normals: [`contact`], [`descriptor`], [`convexity`]. `context` collects evidence along the
//! whole common border ([`border`]), and the votes of borders decide ([`contraction`]).

pub mod border;
pub mod contact;
pub mod contraction;
pub mod convexity;
pub mod descriptor;
pub mod paper;
