//! What was found in a frame.

use std::fmt;

use crate::objectness::gravity::{StructurePlane, Up};
use crate::objectness::join::Join;
pub use crate::objectness::parts::ObjectnessParts;
use crate::objectness::support::{NodeId, SupportGraph};
use crate::raster::Raster;

/// Number of an object in the label image: 1, 2, .. by falling objectness, then pixel count, then first pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u16);

/// Everything found in one frame.
#[derive(Clone, Debug)]
pub struct Discovery {
    /// The object of every pixel: 0 = none, else the number of an [`ObjectId`].
    pub labels: Raster<u16>,
    /// The objects; object k stands at index k - 1.
    pub objects: Vec<Object>,
    /// The direction against gravity.
    pub up: Up,
    /// Large planes of the scene: the table, the floor. In `paper` at most the dominant one.
    pub structure_planes: Vec<StructurePlane>,
    /// The structure plane of every pixel: 0 = none, else k stands for the plane at index k - 1.
    pub structure: Raster<u16>,
    /// What stands on what.
    pub support: SupportGraph,
    /// What the user should know about how this came about.
    pub notices: Vec<Notice>,
}

/// One thing that can be grasped and moved.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its number in the label image.
    pub id: ObjectId,
    /// How sure it is, in [0, 1].
    pub objectness: f32,
    /// What the objectness is made of.
    pub parts: ObjectnessParts,
    /// Pixels in the label image.
    pub size_px: usize,
    /// The smallest upright rectangle around its pixels.
    pub box_px: PixelBox,
    /// Mean of its points, camera frame (m).
    pub centroid_m: [f32; 3],
    /// Oriented box, one axis along up.
    pub box_m: OrientedBox,
    /// How high it stands above the support plane (m), where that is known (`context`).
    pub top_m: Option<f32>,
    /// Number of facets it is made of.
    pub facets: usize,
    /// Which of its parts were joined although they do not touch as one surface. None in `paper`.
    pub joins: Vec<Join>,
    /// Its place in the support graph.
    pub node: NodeId,
    /// The nodes that it stands on, lies in or leans against.
    pub parents: Vec<NodeId>,
}

/// An upright rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBox {
    /// Leftmost column.
    pub u: usize,
    /// Topmost row.
    pub v: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

/// A box with any orientation, in the camera frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Middle of the box (m).
    pub center_m: [f32; 3],
    /// Rotation that takes the box's axes to the camera's frame, as a unit quaternion x, y, z, w.
    pub rotation_xyzw: [f32; 4],
    /// Full length of each side (m), along the box's own x, y and z axes.
    pub extents_m: [f32; 3],
}

/// Something the user should know although the frame was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Notice {
    /// No plane dominates the scene, so the camera is taken to be horizontal.
    NoPlane,
    /// The frame has no colour, so depth alone decides.
    NoColor,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoPlane => {
                "no plane dominates the scene: up is taken from the camera, as if it were held horizontally"
            }
            Self::NoColor => "the frame has no colour: surfaces are told apart by depth alone",
        })
    }
}
