//! The files that `objecthood segment` can write, and how reports are printed.

use clap::{Args, ValueEnum};

/// How a report is printed.
#[derive(Debug, Args)]
pub(crate) struct Printed {
    /// Print JSON instead of text.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What can be written: most of it for every frame, some as files of the run. docs/OUTPUTS.md describes each.
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
    #[value(alias = "pictures")]
    Overlay,
    /// NAME.panels.png, pictures of every stage.
    Panels,
    /// NAME.labels.npz, arrays for NumPy: rgb, depth (m), K, segmap, structure, objectness, boxes, parents.
    Npz,
    /// NAME.labels.ply, the points with colour, label and pixel.
    Ply,
    /// NAME.object1.labels.ply, NAME.object2.labels.ply, ..: the points of each object.
    PlyObjects,
    /// instances.coco.json, one file for all frames: masks, boxes and objectness as COCO has them.
    Coco,
    /// The folder bop: `objecthood_results.json` for all frames, and for each scene masks, boxes and poses as BOP has them.
    Bop,
    /// objects.labels.mcap, one recording for all frames: label images and boxes as ROS 2 messages, with the stamps of the input.
    Mcap,
    /// report.html, one page for all frames; it is asked for by `--report`.
    #[value(skip)]
    Report,
}

impl OutputKind {
    /// What follows the name of the frame in the name of the file; `None` where all frames share files. Of several files of a frame that of the
    /// first.
    pub(crate) fn suffix(self) -> Option<&'static str> {
        match self {
            Self::Labels => Some(".labels.png"),
            Self::Points => Some(".labels.pcd"),
            Self::Json => Some(".json"),
            Self::Structure => Some(".structure.png"),
            Self::Overlay => Some(".overlay.png"),
            Self::Panels => Some(".panels.png"),
            Self::Npz => Some(".labels.npz"),
            Self::Ply => Some(".labels.ply"),
            Self::PlyObjects => Some(".object1.labels.ply"),
            Self::Coco | Self::Bop | Self::Mcap | Self::Report => None,
        }
    }

    /// The option that asks for it.
    pub(crate) fn option(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(|| "--report".to_owned(), |value| format!("--write {}", value.get_name()))
    }

    /// Whether all frames share files of this kind.
    pub(crate) fn is_of_run(self) -> bool {
        self.suffix().is_none()
    }
}
