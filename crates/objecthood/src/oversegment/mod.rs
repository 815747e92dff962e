//! Stage 1: over-segmentation of the image into superpixels.
//!
//! `paper`: on colour, depth and curvature (III-A): [`smoothing`], [`graph`], [`felzenszwalb`], [`absorb`].
//! `context`: large planes are removed first ([`structure`]); a watershed of the fit residual ([`watershed`])
//! grows superpixels over [`links`].
//!
//! On a box of 10 cm, seen from above:
//!
//! ```
//! # use objecthood::attitude::Attitude;
//! # use objecthood::surface::surfaces::find_surfaces;
//! use objecthood::oversegment::linked::flood_superpixels;
//! use objecthood::oversegment::structure::find_structure;
//!
//! # use objecthood::{Camera, Frame, Params, Raster};
//! # let seen_m = |i: usize| if (60..100).contains(&(i % 160)) && (40..80).contains(&(i / 160)) { 0.9 } else { 1.0 };
//! # let depth_m = Raster::from_vec(160, 120, (0..160 * 120).map(seen_m).collect())?;
//! # let frame = Frame::new(depth_m, None, Camera::new(131.0, 131.0, 79.5, 59.5)?)?;
//! let params = Params::default();
//! # let surfaces = find_surfaces(&frame, &params.sensor, &params.local_fit);
//! let attitude = Attitude::of(&frame, &params.gravity);
//! let structure = find_structure(frame.depth_m(), &surfaces, &attitude, &params.structure);
//! assert_eq!(structure.planes.len(), 1); // the table
//! let superpixels = flood_superpixels(&surfaces, &structure, &params.watershed);
//! assert!(superpixels.segments.count() > 10);
//! # Ok::<(), objecthood::Error>(())
//! ```

pub mod absorb;
mod edges;
pub mod felzenszwalb;
pub mod graph;
pub mod linked;
mod linked_pairs;
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
