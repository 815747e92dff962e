//! Stage 1: over-segmentation of the image into superpixels on colour, depth and curvature (paper, III-A).

pub mod absorb;
pub mod felzenszwalb;
pub mod graph;
pub mod smoothing;
