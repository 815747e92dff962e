//! Stage 1 of `context` after the structure: superpixels by watershed, with their links and moments (docs/CONTEXT.md 1.2).

use crate::error::{Error, Result};
use crate::oversegment::linked_pairs::count_linked_pairs;
use crate::oversegment::links::Links;
use crate::oversegment::structure::Structure;
use crate::oversegment::watershed::{find_seeds, flood};
use crate::params;
use crate::raster::Raster;
use crate::regions::{RegionGraph, Segments};
use crate::surface::moments::Moments;
use crate::surface::surfaces::Surfaces;

/// The superpixels outside the structure, with the links between them.
#[derive(Clone, Debug)]
pub struct LinkedSuperpixels {
    /// The label map; -1 on structure and without depth.
    pub segments: Segments,
    /// Pairs of superpixels that links join, with the number of these links.
    pub linked_pairs: RegionGraph<u32>,
    /// The moments of every superpixel's disparity.
    pub moments: Vec<Moments>,
}

/// Finds superpixels: floods the residuals of the plane fits from one seed a block, across links only. O(pixels).
pub fn flood_superpixels(
    surfaces: &Surfaces,
    structure: &Structure,
    params: &params::Watershed,
) -> LinkedSuperpixels {
    let Surfaces { space, disparity, fits, orientation, .. } = surfaces;
    let links = Links::new(disparity, &orientation.slope, &structure.labels, space, params);
    let starts = find_seeds(&fits.residual, &links, space, params);
    let segments = flood(&fits.residual, &starts, &links);
    LinkedSuperpixels::new(segments, &links, surfaces)
}

impl LinkedSuperpixels {
    /// Superpixels from another source instead of [`flood_superpixels`]: a grid, or the labels of another segmenter. Pixels
    /// with a negative label, on structure or without depth belong to none. O(pixels log pixels).
    ///
    /// # Errors
    /// [`Error::LabelsMismatch`] when the labels differ from the frame in size.
    pub fn from_labels(
        labels: &Raster<i32>,
        surfaces: &Surfaces,
        structure: &Structure,
        params: &params::Watershed,
    ) -> Result<Self> {
        let Surfaces { space, disparity, orientation, .. } = surfaces;
        if labels.size() != disparity.size() {
            return Err(Error::LabelsMismatch { labels: labels.size(), frame: disparity.size() });
        }
        let is_free = |i: usize| structure.labels[i] < 0 && !disparity[i].is_nan();
        let free = (0..labels.len()).map(|i| if is_free(i) { labels[i] } else { Segments::NONE });
        let segments = Segments::from_labels(&labels.with_data(free.collect()));
        let links = Links::new(disparity, &orientation.slope, &structure.labels, space, params);
        Ok(Self::new(segments, &links, surfaces))
    }

    fn new(segments: Segments, links: &Links, surfaces: &Surfaces) -> Self {
        let (linked_pairs, moments) = rayon::join(
            || count_linked_pairs(&segments, links),
            || Moments::of_segments(&segments, &surfaces.disparity),
        );
        Self { segments, linked_pairs, moments }
    }
}
