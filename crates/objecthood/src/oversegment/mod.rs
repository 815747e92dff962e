//! Stage 1: over-segmentation of the image into superpixels.
//!
//! `paper`: on colour, depth and curvature (III-A): [`smoothing`], [`graph`], [`felzenszwalb`], [`absorb`].
//! `context`: large planes are taken out ([`structure`]); a watershed of the fit residual ([`watershed`]) grows superpixels over
//! [`links`].

pub mod absorb;
mod edges;
pub mod felzenszwalb;
pub mod graph;
pub mod linked;
pub mod linked_pairs;
pub mod links;
pub mod paper;
pub(crate) mod pixel_edge;
mod settled;
pub mod smoothing;
pub mod structure;
pub mod watershed;

use crate::raster::Raster;
use crate::regions::Segments;

/// Superpixels of `paper`, and the pixels from which their statistics are taken.
#[derive(Clone, Debug)]
pub struct Superpixels {
    /// The label map.
    pub segments: Segments,
    /// Pixels from which later stages take statistics: those without high curvature that were not absorbed.
    pub core: Raster<bool>,
}
