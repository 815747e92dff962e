//! Stage 2: superpixels grouped to facets, each one face of a convex shape (paper, III-B).

pub mod appearance;
pub mod grouping;
