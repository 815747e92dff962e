//! Errors: the caller's input cannot be used. Bad pixels are data, not errors.

/// Result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Why a call failed. Each message says how to fix the input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A raster whose size is zero, too large, or does not match its data.
    #[error(
        "an image of {width} x {height} pixels with {values} values: give one value a pixel, at least one pixel and at most 2^28"
    )]
    BadSize {
        /// Columns claimed.
        width: usize,
        /// Rows claimed.
        height: usize,
        /// Values given.
        values: usize,
    },
    /// Colour and depth of different size.
    #[error(
        "colour is {}x{} but depth is {}x{} pixels: give them registered to each other (aligned), of one field of view",
        color.0, color.1, depth.0, depth.1
    )]
    SizeMismatch {
        /// Columns and rows of the colour image.
        color: (usize, usize),
        /// Columns and rows of the depth image.
        depth: (usize, usize),
    },
    /// Labels of another size than the frame.
    #[error(
        "the labels are {}x{} but the frame is {}x{} pixels: give one label a pixel of the frame",
        labels.0, labels.1, frame.0, frame.1
    )]
    LabelsMismatch {
        /// Columns and rows of the label image.
        labels: (usize, usize),
        /// Columns and rows of the frame.
        frame: (usize, usize),
    },
    /// Not one pixel with depth.
    #[error("no pixel has a valid depth (finite and above 0 m): check the file and its depth unit")]
    NoValidDepth {
        /// Columns and rows of the depth; a list of points is one row.
        size: (usize, usize),
    },
    /// Intrinsics that no camera has.
    #[error(
        "fx {} fy {} cx {} cy {} is not a camera: give pixels, focal lengths from 1e-3 to 1e7 and a principal point within 1e7",
        camera[0], camera[1], camera[2], camera[3]
    )]
    BadCamera {
        /// The intrinsics given: fx, fy, cx and cy (px).
        camera: [f64; 4],
    },
    /// A direction that is none.
    #[error("{up:?} is no direction up: give three finite numbers of which not all are 0")]
    BadUp {
        /// The vector given.
        up: [f32; 3],
    },
    /// A parameter outside its range.
    #[error("{parameter} = {value} is outside its range {range}: see `objecthood params`")]
    BadParameter {
        /// `stage.name` of the parameter.
        parameter: String,
        /// The value given.
        value: String,
        /// The values allowed.
        range: String,
    },
    /// A pixel outside the image.
    #[error(
        "pixel {},{} lies outside the image of {} x {} pixels: give a column up to {} and a row up to {}",
        pixel[0], pixel[1], size.0, size.1, size.0 - 1, size.1 - 1
    )]
    OutsideImage {
        /// Column and row that were given.
        pixel: [usize; 2],
        /// Columns and rows of the image; never zero.
        size: (usize, usize),
    },
    /// A method whose decisions cannot be explained.
    #[error("the method `{method}` cannot be explained: only the decisions of `context` can")]
    OnlyContext {
        /// The method.
        method: String,
    },
    /// More objects than a 16-bit label image can number.
    #[error(
        "{found} objects were found but a label image numbers at most 65535: raise objectness.min_size_px"
    )]
    TooManyObjects {
        /// Objects found.
        found: usize,
    },
}
