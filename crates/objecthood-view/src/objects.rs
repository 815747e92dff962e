//! A map of objects at the size of a tile.

use objecthood::Raster;

use crate::distance::{self, Anchor};
use crate::grid::sample;

/// The object of every pixel of a tile, and how deep in its object it lies.
pub(crate) struct Objects {
    /// 0 = none.
    ids: Raster<u16>,
    /// From every pixel to the border of its object, in units of 1 / [`distance::SIDE`] px.
    to_border: Vec<u32>,
}

impl Objects {
    /// Of the label image of a frame.
    pub(crate) fn new(labels: &Raster<u16>) -> Self {
        let ids = sample(labels);
        Self { to_border: distance::to_border(&ids), ids }
    }

    /// Columns and rows of the tile.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.ids.width() as u32, self.ids.height() as u32)
    }

    /// The object at a pixel, and how many pixels it is from there to the object's border: 1 = on it.
    pub(crate) fn at(&self, u: usize, v: usize) -> Option<(u16, u32)> {
        let id = *self.ids.get(u, v).filter(|&&id| id > 0)?;
        Some((id, self.to_border[v * self.ids.width() + u] / distance::SIDE))
    }

    /// Where to write the numbers of the objects.
    pub(crate) fn anchors(&self) -> Vec<Anchor> {
        distance::anchors(&self.ids, &self.to_border)
    }
}
