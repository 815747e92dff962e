//! What every pixel really shows.

use objecthood::Raster;

/// Truth per pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Truth {
    /// Number of the solid: index in [`World::solids`](crate::World::solids) plus 1; 0 = none.
    pub instance: Raster<u16>,
    /// Number of the face, unique in the scene: from 1, in the order of solids, their parts and the faces of these; 0 = none.
    pub surface: Raster<u16>,
}
