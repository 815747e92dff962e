//! What can be wrong with a file, on the way in or out.

use std::io;
use std::path::{Path, PathBuf};

use crate::formats::{ContentError, Unread, extensions};
use crate::images::ImageError;
use crate::organize::MAX_RESIDUAL_PX;
use crate::pipe::PipeFrameError;
use crate::scope::Limit;

/// Result with this crate's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why something could not be read or written: one line that says what is wrong, and what to do about the file. What
/// else may help depends on the program: it reads the fields and adds which of its options that is.
///
/// What caused an error is part of its message, so it is not repeated by [`source`](std::error::Error::source).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something is wrong with the file at a path.
    #[error("{}: {error}", path.display())]
    At {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: Box<Error>,
    },
    /// The system does not let the file be read.
    #[error("cannot be read ({reason}): check that the path is right and that you may read it")]
    Read {
        /// What the system says.
        reason: io::Error,
    },
    /// A file of no bytes.
    #[error("the file is empty: record or copy it again")]
    Empty,
    /// A folder that the system does not list.
    #[error("cannot list the folder ({reason}): check its permissions")]
    List {
        /// What the system says.
        reason: io::Error,
    },
    /// No format on the list.
    #[error("not a file that objecthood reads{}", looks_like.map(|kind| format!(", but {kind}")).unwrap_or_default())]
    UnknownFormat {
        /// What it is, if it is recognised.
        looks_like: Option<Unread>,
    },
    /// A folder without frames.
    #[error("no point cloud ({}) in this folder or below", endings())]
    NoFrames,
    /// A file that breaks its format, such as [`PcdError`](crate::formats::pcd::PcdError).
    #[error("{0}")]
    Content(ContentError),
    /// Lists of a point cloud that do not belong together.
    #[error(
        "the point cloud says {}x{} points but has {points} points, {} colours and {} labels: the file is damaged, or its reader is wrong",
        size.0, size.1, count(*color), count(*label)
    )]
    CloudLengths {
        /// Columns and rows.
        size: (usize, usize),
        /// Points.
        points: usize,
        /// Colours, if there are any.
        color: Option<usize>,
        /// Labels, if there are any.
        label: Option<usize>,
    },
    /// An image that cannot be used.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A frame of a stream that is none; the next may be.
    #[error(transparent)]
    Pipe(#[from] PipeFrameError),
    /// Depth, colour and camera that make no frame.
    #[error(transparent)]
    Frame(#[from] objecthood::Error),

    /// Text that is no [`GridCamera`](crate::GridCamera).
    #[error(
        "`{given}` is not a camera: write fx,fy,cx,cy or fx,fy,cx,cy,width,height in pixels, for example 525,525,319.5,239.5"
    )]
    BadCameraText {
        /// What was given.
        given: String,
    },
    /// A file that holds no camera.
    #[error(
        "not a camera file ({reason}): write {{\"fx\": 525, \"fy\": 525, \"cx\": 319.5, \"cy\": 239.5}} in pixels, with \"width\", \"height\" and \"depth_scale\" if they are known"
    )]
    BadCameraFile {
        /// What is missing or wrong.
        reason: String,
    },
    /// The size given with the camera is not that of the organized cloud.
    #[error(
        "the camera is given for {}x{} pixels but the point cloud has {}x{}: give the camera of this cloud, or leave out the size",
        given.0, given.1, cloud.0, cloud.1
    )]
    CameraSize {
        /// Columns and rows given with the camera.
        given: (usize, usize),
        /// Columns and rows of the cloud.
        cloud: (usize, usize),
    },
    /// A camera without a size, whose principal point is not the middle of an image.
    #[error(
        "a principal point at ({cx_px}, {cy_px}) px is not the middle of an image, so the size of the image must be given too"
    )]
    NoImageSize {
        /// Column of the principal point (px).
        cx_px: f64,
        /// Row of the principal point (px).
        cy_px: f64,
    },
    /// An unorganized cloud that no one camera sees.
    #[error(
        "the {points} points lie all around the place from which they would be seen, or span more than 120 degrees: save them in the frame of the camera, or cut out a part"
    )]
    NoView {
        /// Points in the cloud.
        points: usize,
    },
    /// Columns or rows that do not run the way a camera's do.
    #[error(
        "the points do not run rightwards with x and downwards with y, as in the frame of a camera (x right, y down, z forward)"
    )]
    NotPinhole,
    /// The best pinhole camera does not explain the points.
    #[error(
        "the points miss the pixels of the best pinhole camera by {residual_px:.2} px rms (at most {MAX_RESIDUAL_PX})"
    )]
    CameraResidual {
        /// Root mean square distance between projected points and their pixels.
        residual_px: f64,
    },
    /// No point falls into the image of the camera.
    #[error(
        "none of the {points} points with depth falls into the {}x{} image: check the camera and the unit of the points (metres)",
        size.0, size.1
    )]
    NothingInView {
        /// Points with depth.
        points: usize,
        /// Columns and rows of the image.
        size: (usize, usize),
    },

    /// A line of a TUM list that is not a time and a file name.
    #[error(
        "line {line}: `{text}` is not a time in seconds and the name of a file: correct or remove the line"
    )]
    BadListLine {
        /// Its number, from 1.
        line: usize,
        /// What it says, or the beginning of it.
        text: String,
    },
    /// A line of a TUM list of poses that is none.
    #[error(
        "line {line}: `{text}` is not a time in seconds, a position and a unit quaternion, x y z and x y z w"
    )]
    BadPoseLine {
        /// Its number, from 1.
        line: usize,
        /// What it says, or the beginning of it.
        text: String,
    },
    /// A TUM folder without a camera.
    #[error("the folder has no {name}")]
    NoCameraFile {
        /// The file that would tell the camera.
        name: &'static str,
    },
    /// A TUM folder without a frame.
    #[error(
        "none of its {color} colour and {depth} depth images were taken within {max_apart_ms} ms of each other: check the times in rgb.txt and depth.txt"
    )]
    NoPairs {
        /// Colour images.
        color: usize,
        /// Depth images.
        depth: usize,
        /// How far apart two images of a frame may be taken (ms).
        max_apart_ms: i64,
    },
    /// Text that is no [`FrameRange`](crate::FrameRange).
    #[error(
        "`{given}` is not a range of frames: write first..end or first..end:step, counted from 0, for example 10..200:5"
    )]
    BadFrameRange {
        /// What was given.
        given: String,
    },
    /// Text that is no [`TimeRange`](crate::TimeRange).
    #[error(
        "`{given}` is not a range of times: write first..end in seconds from the first frame, for example 3.0..8.0"
    )]
    BadTimeRange {
        /// What was given.
        given: String,
    },
    /// A frame without a time where times select.
    #[error("the frame has no time, so none can be selected by time: select frames by their number")]
    NoStamp,
    /// Text that is no [`DepthRange`](crate::scope::DepthRange).
    #[error("`{given}` is not a range of depths: write nearest..farthest in metres, for example 0.3..1.5")]
    BadRange {
        /// What was given.
        given: String,
    },
    /// Text that is no [`Region`](crate::scope::Region).
    #[error(
        "`{given}` is not a region of the image: write x,y,width,height in pixels, for example 100,80,400,300"
    )]
    BadRegion {
        /// What was given.
        given: String,
    },
    /// A region that does not lie in the image.
    #[error(
        "the region {region} leaves the image of {}x{} pixels: give one that lies in it",
        size.0, size.1
    )]
    RegionOutside {
        /// The region.
        region: crate::scope::Region,
        /// Columns and rows of the image.
        size: (usize, usize),
    },
    /// A mask of another size than the frame.
    #[error(
        "the mask has {}x{} pixels but the frame has {}x{}: give a mask of the size of the frame",
        mask.0, mask.1, frame.0, frame.1
    )]
    MaskSize {
        /// Columns and rows of the mask.
        mask: (usize, usize),
        /// Columns and rows of the frame.
        frame: (usize, usize),
    },
    /// Limits that leave no pixel with depth.
    #[error(
        "none of the {valid} pixels with depth, {nearest_m:.2} to {farthest_m:.2} m away, lies within {}",
        in_words(limits)
    )]
    NothingInScope {
        /// What leaves nothing: those limits that do so alone, else all that are given.
        limits: Vec<Limit>,
        /// Columns and rows of the frame.
        size: (usize, usize),
        /// Pixels with depth.
        valid: usize,
        /// Least depth (m).
        nearest_m: f32,
        /// Greatest depth (m).
        farthest_m: f32,
    },

    /// A PNG that is broken or too large, or an image that cannot be written as PNG.
    #[error("not a usable PNG image ({reason}): write the label image again")]
    Png {
        /// What the decoder says.
        reason: String,
    },
    /// An image that is not one grey channel of 8 or 16 bits.
    #[error(
        "a label image has one grey channel of 8 or 16 bits, this one has {found}: save it as 16-bit greyscale PNG"
    )]
    NotGrey {
        /// Kind of pixel found.
        found: String,
    },
    /// A value of a scene is not a finite number.
    #[error("{place} of the scene is not a finite number: this is a mistake in objecthood, please report it")]
    NotFinite {
        /// Where in the scene file it would stand.
        place: String,
    },
    /// A scene that has no JSON form.
    #[error("the scene has no JSON form ({reason}): this is a mistake in objecthood, please report it")]
    NoJson {
        /// What is wrong.
        reason: serde_json::Error,
    },
    /// A frame that a layout of folders cannot hold.
    #[error("{reason}, and the layout of {layout} cannot hold that: write another format")]
    NotForLayout {
        /// The layout.
        layout: &'static str,
        /// What it cannot hold.
        reason: &'static str,
    },
    /// A file that could not be written; none of it is left.
    #[error("{}: cannot be written ({reason}): {advice}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
        /// What to do.
        advice: &'static str,
    },
}

impl Error {
    /// The same error, said of the file at `path`. Whoever opens a file says its path, once.
    #[must_use]
    pub fn at(self, path: &Path) -> Self {
        Self::At { path: path.to_owned(), error: Box::new(self) }
    }

    /// Columns and rows of the frame, if it could be read but no pixel of it has depth, or none that is to be looked at.
    pub fn blank_size(&self) -> Option<(usize, usize)> {
        match self {
            Self::At { error, .. } => error.blank_size(),
            Self::Frame(objecthood::Error::NoValidDepth { size }) | Self::NothingInScope { size, .. } => {
                Some(*size)
            }
            _ => None,
        }
    }
}

/// The endings that are looked for in folders, as one reads them: `.pcd`.
fn endings() -> String {
    extensions().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
}

/// Limits as a sentence names them.
fn in_words(limits: &[Limit]) -> String {
    limits.iter().map(Limit::to_string).collect::<Vec<_>>().join(" and ")
}

fn count(length: Option<usize>) -> String {
    length.map_or_else(|| "no".to_owned(), |length| length.to_string())
}
