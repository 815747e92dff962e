//! The files that `objecthood segment` can write for a frame.

use clap::ValueEnum;

/// What can be written for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum OutputKind {
    /// NAME.labels.png, a 16-bit label image: 0 = no object, 1 and up = objects. Numbers this small look black in an image
    /// viewer; look at the overlay.
    Labels,
    /// NAME.labels.pcd, of unorganized clouds only: x, y, z and label of every point, in the order of the input.
    Points,
    /// NAME.json, the scene file: objects with boxes, support, planes.
    Json,
    /// NAME.structure.png, a 16-bit label image of the large planes: table, floor, wall.
    Structure,
    /// NAME.overlay.png, the colour image (depth if there is none) with outlines and numbers of the objects.
    Overlay,
    /// NAME.panels.png, pictures of every stage.
    Panels,
}

impl OutputKind {
    /// What follows the name of the frame in the name of the file.
    pub(crate) fn suffix(self) -> &'static str {
        match self {
            Self::Labels => ".labels.png",
            Self::Points => ".labels.pcd",
            Self::Json => ".json",
            Self::Structure => ".structure.png",
            Self::Overlay => ".overlay.png",
            Self::Panels => ".panels.png",
        }
    }
}
