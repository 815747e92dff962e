//! Why something cannot be evaluated. Which option of a program helps, the program adds.

use std::path::PathBuf;

use crate::dataset::Split;

/// Result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why something cannot be evaluated.
///
/// What caused an error is part of its message, so it is not repeated by [`source`](std::error::Error::source).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A folder of the data set cannot be listed.
    #[error("{}: cannot list the folder ({reason}): give the folder that holds the folders of scenes", path.display())]
    ReadFolder {
        /// The folder.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// The data set has no such scenes.
    #[error(
        "{}: no scenes of split `{split}`: {}", root.display(),
        if folders.is_empty() {
            "it holds no folders; give the folder that holds the folders of scenes (.pcd files)".to_owned()
        } else {
            format!("the splits there are: all, {}", folders.join(", "))
        }
    )]
    NoScenes {
        /// The data set.
        root: PathBuf,
        /// What was asked for.
        split: Split,
        /// The folders in it.
        folders: Vec<String>,
    },
    /// Two scenes that nothing tells apart in a report or a folder of label images.
    #[error("{} and {} have the same name", first.display(), second.display())]
    SameName {
        /// A scene.
        first: PathBuf,
        /// Another of its name.
        second: PathBuf,
    },
    /// A scene file or label image with something wrong in it; the message names it.
    #[error(transparent)]
    Input(#[from] objecthood_io::Error),
    /// A scene file without truth.
    #[error("{}: no truth: the file has no `label` field, so only `segment` can use it", path.display())]
    NoTruth {
        /// The scene.
        path: PathBuf,
    },
    /// An image of truth that is not of its frame.
    #[error("{}: {}x{} pixels, but the frame has {}x{}", path.display(), truth.0, truth.1, frame.0, frame.1)]
    TruthSize {
        /// The image.
        path: PathBuf,
        /// Columns and rows of it.
        truth: (usize, usize),
        /// Columns and rows of the frame.
        frame: (usize, usize),
    },
    /// A label image that is not there or cannot be read.
    #[error("{}: no label image for scene {scene} ({reason}): check folder and suffix", path.display())]
    ReadLabels {
        /// Name of the scene.
        scene: String,
        /// Where its label image should be.
        path: PathBuf,
        /// Why it cannot be read.
        reason: std::io::Error,
    },
    /// A file of the truth of a clip that is not there or cannot be read.
    #[error("{}: cannot read the truth of a clip ({reason}): give a folder as `objecthood synth` writes it", path.display())]
    ReadTruth {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// A file of a tracker that is not there or cannot be read.
    #[error("{}: cannot read what the tracker says ({reason}): give the folder that it wrote for this clip", path.display())]
    ReadTracks {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// A line of JSON that is not what it should be.
    #[error("{}, line {line}: {reason}: see docs/EVALUATION.md, Videos, for what belongs there", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        reason: serde_json::Error,
    },
    /// A file of a clip that contradicts itself or another.
    #[error("{}: {why}", path.display())]
    NotClip {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A folder without a clip.
    #[error(
        "{}: no clip with truth, and no folder of such clips: give a folder that holds clip.json, or the folder around",
        path.display()
    )]
    NoClips {
        /// The folder.
        path: PathBuf,
    },
    /// A label image of another size than the truth.
    #[error(
        "the label image has {}x{} pixels, the truth {}x{}: give the labels of this scene",
        labels.0, labels.1, truth.0, truth.1
    )]
    PredictionSize {
        /// Columns and rows of the label image.
        labels: (usize, usize),
        /// Columns and rows of the truth.
        truth: (usize, usize),
    },
    /// Segments of another size than the truth.
    #[error(
        "the segments have {}x{} pixels, the truth {}x{}: give the segments of this scene",
        segments.0, segments.1, truth.0, truth.1
    )]
    SegmentsSize {
        /// Columns and rows of the segments.
        segments: (usize, usize),
        /// Columns and rows of the truth.
        truth: (usize, usize),
    },
    /// Labels and parts of a truth of different size.
    #[error(
        "the truth has {}x{} pixels, its parts {}x{}: give both for the same frame",
        labels.0, labels.1, parts.0, parts.1
    )]
    PartsSize {
        /// Columns and rows of the labels.
        labels: (usize, usize),
        /// Columns and rows of the parts.
        parts: (usize, usize),
    },
    /// More pairs of regions than memory should hold.
    #[error("{rows} x {columns} regions are too many to compare: check that the labels are not noise")]
    TooManyRegions {
        /// Regions of one map.
        rows: usize,
        /// Regions of the other.
        columns: usize,
    },
    /// Nothing to measure.
    #[error("no scene has an object in its truth: there is nothing to measure")]
    NoObjects,
    /// No scene to compose others from.
    #[error("no scene has a table with an object on it that is seen whole, so there is nothing to compose")]
    NothingToCompose,
    /// Parameters that cannot be changed by name.
    #[error("the parameters cannot be varied ({0}): report this, with the parameters")]
    Params(#[from] serde_json::Error),
    /// A frame that cannot be.
    #[error(transparent)]
    Frame(#[from] objecthood::Error),
    /// A synthetic scene that cannot be seen.
    #[error(transparent)]
    Scene(#[from] objecthood_scene::Error),
    /// What went wrong with one scene.
    #[error("{scene}: {error}")]
    InScene {
        /// Its file, or its name if it has none.
        scene: String,
        /// What it is.
        error: Box<Error>,
    },
}
