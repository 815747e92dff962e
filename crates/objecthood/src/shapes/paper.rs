//! Stage 3 of `paper`: shapes are facets that meet in convex edges (III-C, eq. 4 and 5).

use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::shapes::contact::find_contacts;
use crate::shapes::convexity::{join_shapes, measure_convexities};
use crate::shapes::descriptor::describe_regions;

/// Finds the facets in contact, measures the convexity of each contact, and joins facets across convex ones. See
/// [`find_contacts`] and [`join_shapes`].
pub fn join_convex(
    superpixels: &Superpixels,
    facets: &Segments,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    contact: &params::Contact,
) -> Segments {
    let described = describe_regions(facets, &superpixels.core, points_m, normals);
    let convexities = measure_convexities(&find_contacts(facets, points_m, contact), &described);
    join_shapes(facets, &described, &convexities)
}
