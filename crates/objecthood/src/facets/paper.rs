//! Stage 2 of `paper`: facets are groups of superpixels of similar appearance (III-B, eq. 3).

use crate::facets::appearance::Appearance;
use crate::facets::grouping::group_superpixels;
use crate::frame::Frame;
use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;

/// Compares superpixels by colour and normals, and groups similar ones. See [`Appearance::new`] and [`group_superpixels`].
pub fn group_alike(
    frame: &Frame,
    superpixels: &Superpixels,
    normals: &Raster<[f32; 3]>,
    appearance: &params::Appearance,
    grouping: &params::Grouping,
) -> Segments {
    let appearance = Appearance::new(superpixels, frame.color(), normals, appearance);
    group_superpixels(superpixels, &appearance, frame.depth_m(), grouping)
}
