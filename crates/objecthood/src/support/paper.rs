//! Support in `paper`: of two shapes in contact the higher one stands on the other (III-D, eq. 6 to 8).

use crate::discovery::support_graph::SupportGraph;
use crate::discovery::up::Up;
use crate::oversegment::Superpixels;
use crate::params;
use crate::raster::Raster;
use crate::regions::Segments;
use crate::shapes::contact::find_contacts;
use crate::shapes::descriptor::describe_regions;
use crate::support::by_height::build_by_height;

/// Finds the shapes in contact and builds their support graph. See [`find_contacts`] and [`build_by_height`].
pub fn stack_by_height(
    superpixels: &Superpixels,
    shapes: &Segments,
    points_m: &Raster<[f32; 3]>,
    normals: &Raster<[f32; 3]>,
    contact: &params::Contact,
    up: &Up,
) -> SupportGraph {
    let described = describe_regions(shapes, &superpixels.core, points_m, normals);
    build_by_height(shapes, &described, &find_contacts(shapes, points_m, contact), points_m, up)
}
