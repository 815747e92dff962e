//! Stage 1: over-segmentation of the image into superpixels.
//!
//! `paper`: on colour, depth and curvature (III-A): [`smoothing`], [`graph`], [`felzenszwalb`], [`absorb`].
//! `context`: large planes apart ([`structure`]), then a watershed of how badly a plane fits ([`watershed`]).

pub mod absorb;
mod edges;
pub mod felzenszwalb;
pub mod graph;
pub mod linked;
pub mod paper;
mod settled;
pub mod smoothing;
pub mod structure;
pub mod watershed;

use crate::raster::Raster;
use crate::regions::Segments;

/// Superpixels, and which of their pixels speak for them.
#[derive(Clone, Debug)]
pub struct Superpixels {
    /// The label map.
    pub segments: Segments,
    /// Pixels away from high curvature: they carry the statistics of all later stages.
    pub core: Raster<bool>,
}
