//! What can be wrong with an image file.

/// Why an image cannot be used: one line that says what is wrong, and what to do about the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// A file of no bytes.
    #[error("the file is empty: record or copy it again")]
    Empty,
    /// The content is that of no image format that is read, whatever the name says.
    #[error(
        "the content is not that of a PNG, JPEG, TIFF, EXR or NPY image, whatever its name: convert it to one"
    )]
    UnknownFormat,
    /// An image that cannot be decoded.
    #[error("not a usable {format} image ({reason}): write or copy it again")]
    Broken {
        /// Name of the format.
        format: &'static str,
        /// What the decoder says.
        reason: String,
    },
    /// An image with more pixels than are allowed.
    #[error(
        "{}x{} pixels are more than the {max_pixels} that may be read",
        size.0, size.1
    )]
    TooManyPixels {
        /// Columns and rows.
        size: (usize, usize),
        /// What is allowed.
        max_pixels: usize,
    },
    /// Colours for printing.
    #[error("the colours are CMYK, made for printing: save the image as RGB")]
    Cmyk,
    /// A kind of pixel that is not read.
    #[error("pixels of {found} are not read: save it as {wanted}")]
    PixelKind {
        /// What the image has.
        found: String,
        /// What would be read.
        wanted: &'static str,
    },
    /// A colour image that looks like depth.
    #[error("{found} is depth rather than colour")]
    ColorIsDepth {
        /// What the image has.
        found: &'static str,
    },
    /// A depth image of colours.
    #[error(
        "a depth image has one channel but this one has {channels}, as a picture has: give the file with the depth as it was measured, 16-bit grey PNG or TIFF, or float TIFF"
    )]
    DepthIsColor {
        /// Channels, alpha included.
        channels: usize,
    },
    /// A depth image of 8 bits.
    #[error(
        "the depth has 8 bits, 256 steps from nearest to farthest, too coarse to see surfaces in: save the depth as it was measured, 16-bit grey PNG or TIFF, or float TIFF"
    )]
    DepthEightBit,
    /// Lossy depth.
    #[error("a JPEG image holds no depth: give a 16-bit grey PNG or TIFF, or a float TIFF")]
    DepthIsJpeg,
    /// Integers of an unknown unit.
    #[error("the unit of integer depth is not known")]
    NoDepthScale,
    /// Depth seen by an unknown camera.
    #[error("depth images do not say which camera saw them")]
    NoCamera,
    /// Depths at which no depth camera measures.
    #[error(
        "with {depth_scale} units a metre half of the depths lie {} (median {median_m:.3} m)",
        if *median_m > 1.0 { "beyond 50 m" } else { "below 0.05 m" }
    )]
    UnlikelyUnit {
        /// Units a metre that were assumed.
        depth_scale: f64,
        /// Median of the valid depths (m).
        median_m: f64,
        /// The usual scale with which the median comes nearest to a metre; `None` when none makes sense of it.
        likely: Option<f64>,
    },
    /// A camera of another image size.
    #[error(
        "the camera is given for {}x{} pixels but the depth image has {}x{}: give the camera of this image; when an image is resized, fx, cx and fy, cy change with it",
        given.0, given.1, image.0, image.1
    )]
    CameraSize {
        /// Columns and rows given with the camera.
        given: (usize, usize),
        /// Columns and rows of the depth image.
        image: (usize, usize),
    },
}
