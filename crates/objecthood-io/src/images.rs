//! A frame in image files: one for depth, perhaps one for colour, and a camera.
//!
//! | | depth | colour | mask |
//! |---|---|---|---|
//! | PNG | 16-bit grey | 8 and 16 bits, grey, RGB, palette | any |
//! | JPEG | - | grey, RGB | any |
//! | TIFF | 16-bit and float grey | 8 and 16 bits, grey, RGB | 8 and 16 bits, grey, RGB |
//!
//! * Depth is z in units of which `depth_scale` make a metre: 1000 for millimetres, 5000 in TUM's data, 10000 in
//!   YCB-Video. Integer depth has no scale of its own, so none is assumed; float depth is in metres unless a scale is
//!   given. Zero, negative and not finite = no depth.
//! * Colours of 16 bits are rounded to 8. Alpha is ignored: it says how to paint a pixel, not what was seen. An Exif
//!   orientation is ignored too, because the depth has none: pixels lie as they are stored.
//! * Both images have one size and are registered pixel by pixel.
//!
//! Memory is bounded before any is taken: an image of more than `max_pixels` is refused by its header.

mod color;
mod depth;
mod error;
mod jpeg;
mod mask;
mod picture;
mod tiff;

pub use error::ImageError;
pub use mask::{decode_mask, open_mask};

use std::path::Path;

use objecthood::Frame;

use crate::error::Result;
use crate::formats::read_file;
use crate::organize::{Capture, GridCamera};

/// The most pixels that are read unless the caller says otherwise: 2^24, that is 4096x4096.
///
/// A frame takes 160 to 180 bytes a pixel while it is looked at: 2.8 GB for one of this size; one of 8192x8192 pixels
/// would need 11 GB.
pub const DEFAULT_MAX_PIXELS: usize = 1 << 24;

/// What image files do not say themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSetup {
    /// The camera; its size, where given, must be that of the depth image.
    pub camera: GridCamera,
    /// Units of the depth image that make a metre, positive; `None`: float depth is in metres, integer depth refused.
    pub depth_scale: Option<f64>,
    /// The most pixels an image may have.
    pub max_pixels: usize,
}

/// Opens a depth image and the colour image registered to it.
///
/// # Errors
/// [`Error::At`](crate::Error::At) the file that is wrong: those of [`decode_images`], or it cannot be read.
pub fn open_images(color: Option<&Path>, depth: &Path, setup: &ImageSetup) -> Result<Capture> {
    let depth_m =
        read_image(depth).and_then(|bytes| depth::decode(&bytes, setup)).map_err(|e| e.at(depth))?;
    let color = color.map(|path| {
        read_image(path).and_then(|bytes| color::decode(&bytes, setup.max_pixels)).map_err(|e| e.at(path))
    });
    capture(color.transpose()?, depth_m, setup).map_err(|e| e.at(depth))
}

/// As [`open_images`], for the content of the files.
///
/// # Errors
/// [`Error::Image`](crate::Error::Image) tells what is wrong with an image or its unit,
/// [`Error::Frame`](crate::Error::Frame) what keeps them from being a frame: two sizes, no depth anywhere.
pub fn decode_images(color: Option<&[u8]>, depth: &[u8], setup: &ImageSetup) -> Result<Capture> {
    let depth_m = depth::decode(depth, setup)?;
    let color = color.map(|bytes| color::decode(bytes, setup.max_pixels)).transpose()?;
    capture(color, depth_m, setup)
}

fn capture(
    color: Option<objecthood::Raster<[u8; 3]>>,
    depth_m: objecthood::Raster<f32>,
    setup: &ImageSetup,
) -> Result<Capture> {
    let frame = Frame::new(depth_m, color, setup.camera.camera)?;
    Ok(Capture { frame, truth: None, camera_fit: None, turned: false })
}

/// The bytes of an image file.
pub(crate) fn read_image(path: &Path) -> Result<Vec<u8>> {
    read_file(path, |head| Ok(picture::probe(head).map(drop)?))
}

/// Refuses a frame of more pixels than the caller wants to have memory for.
///
/// # Errors
/// [`ImageError::TooManyPixels`].
pub(crate) fn check_pixels((width, height): (usize, usize), max_pixels: usize) -> Result<(), ImageError> {
    match width.checked_mul(height) {
        Some(pixels) if pixels <= max_pixels => Ok(()),
        _ => Err(ImageError::TooManyPixels { size: (width, height), max_pixels }),
    }
}
