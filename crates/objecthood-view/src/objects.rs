//! A map of objects, and how deep every pixel lies in its object.

use image::Rgb;
use objecthood::Raster;

use crate::distance::{self, Anchor};
use crate::labels::Label;
use crate::palette::object_color;
use crate::view::NOTHING;

/// The object of every pixel of a picture, and how deep in its object it lies.
pub(crate) struct Objects {
    /// 0 = none.
    ids: Raster<u16>,
    /// From every pixel to the border of its object, in units of 1 / [`distance::SIDE`] px.
    to_border: Vec<u32>,
}

impl Objects {
    /// Of a label image (0 = none) of the size of the picture.
    pub(crate) fn new(ids: Raster<u16>) -> Self {
        Self { to_border: distance::to_border(&ids), ids }
    }

    /// Columns and rows of the picture.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.ids.width() as u32, self.ids.height() as u32)
    }

    /// The object at a pixel, and how many pixels it is from there to the object's border: 1 = on it.
    pub(crate) fn at(&self, u: usize, v: usize) -> Option<(u16, u32)> {
        let id = *self.ids.get(u, v).filter(|&&id| id > 0)?;
        Some((id, self.to_border[v * self.ids.width() + u] / distance::SIDE))
    }

    /// The outline of an object, `line_px` wide, in its colour; `None` elsewhere. A dark line inside sets it off from an
    /// object of its own colour.
    pub(crate) fn outline(&self, u: usize, v: usize, line_px: u32) -> Option<Rgb<u8>> {
        match self.at(u, v)? {
            (id, depth) if depth <= line_px => Some(object_color(id)),
            (_, depth) if depth <= line_px + 1 => Some(NOTHING),
            _ => None,
        }
    }

    /// The numbers of the objects, each where its object has most room.
    pub(crate) fn numbers(&self) -> Vec<Label> {
        let label =
            |anchor: Anchor| Label { text: anchor.id.to_string(), color: object_color(anchor.id), anchor };
        distance::anchors(&self.ids, &self.to_border).into_iter().map(label).collect()
    }
}
