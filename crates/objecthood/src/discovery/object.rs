//! One object of the result.

use crate::discovery::ids::{NodeId, ObjectId};
use crate::discovery::join::Join;
use crate::discovery::parts::ObjectnessParts;
use crate::raster::PixelBox;

/// One thing that can be grasped and moved.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Object {
    /// Its number in the label image.
    pub id: ObjectId,
    /// How likely it is an object, in [0, 1].
    pub objectness: f32,
    /// The parts of the objectness.
    pub parts: ObjectnessParts,
    /// Number of its pixels in the label image.
    pub size_px: usize,
    /// The smallest upright rectangle around its pixels.
    pub box_px: PixelBox,
    /// Mean of its points, camera frame (m).
    pub centroid_m: [f32; 3],
    /// Oriented box, one axis along up.
    pub box_m: OrientedBox,
    /// Height of its top above the support surface (m); `None` in `paper` and without a support.
    pub top_m: Option<f32>,
    /// Number of its facets.
    pub facets: usize,
    /// The joins of its parts that do not touch as one surface. Empty in `paper`.
    pub joins: Vec<Join>,
    /// Whether it is a thing 0.2 to 12 mm thick that lies flat on its support, seen by its colour or by a rise that only many pixels together
    /// show (docs/CONTEXT.md 2.4). Never in `paper`.
    pub is_flat: bool,
    /// Its node in the support graph.
    pub node: NodeId,
    /// The nodes that it stands on, lies in or leans against.
    pub parents: Vec<NodeId>,
}

impl Object {
    /// An object with this number, these pixels and this box, of objectness 1, without support or joins. For tests of
    /// programs that read discoveries; the fields can be changed.
    pub fn new(id: ObjectId, box_px: PixelBox, box_m: OrientedBox) -> Self {
        Self {
            id,
            objectness: 1.0,
            parts: ObjectnessParts {
                size: 1.0,
                support: 1.0,
                footing: 1.0,
                compactness: 1.0,
                separation: 1.0,
                visibility: 1.0,
            },
            top_m: None,
            size_px: box_px.width * box_px.height,
            box_px,
            centroid_m: box_m.center_m,
            box_m,
            facets: 1,
            node: NodeId(0),
            parents: Vec::new(),
            joins: Vec::new(),
            is_flat: false,
        }
    }
}

/// A box with any orientation, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Centre of the box (m).
    pub center_m: [f32; 3],
    /// Rotation from the box's axes to the camera frame, as a unit quaternion x, y, z, w.
    pub rotation_xyzw: [f32; 4],
    /// Full length of each side (m), along the box's own x, y and z axes.
    pub extents_m: [f32; 3],
}

impl OrientedBox {
    /// Its sides (m), the shortest first.
    pub(crate) fn sides_m(&self) -> [f32; 3] {
        let mut sides_m = self.extents_m;
        sides_m.sort_by(f32::total_cmp);
        sides_m
    }
}
