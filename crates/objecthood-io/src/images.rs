//! A frame in image files: one for depth, perhaps one for colour, and a camera.
//!
//! | | depth | colour | mask |
//! |---|---|---|---|
//! | PNG | 16-bit grey | 8 and 16 bits, grey, RGB, palette | any |
//! | JPEG | - | grey, RGB | any |
//! | TIFF | 16-bit and float grey | 8 and 16 bits, grey, RGB | 8 and 16 bits, grey, RGB |
//! | EXR | a channel Z, depth or Y, or the only one | - | - |
//! | NPY | rows and columns of whole or real numbers | - | - |
//!
//! * Depth is z in units of which `depth_scale` make a metre: 1000 for millimetres, 5000 in TUM's data, 10000 in
//!   YCB-Video. Integer depth has no scale of its own, so none is assumed; float depth is in metres unless a scale is
//!   given. No depth is what is zero, negative or not finite, and 65535 in an image of 16 bits: there the sensor or the
//!   file reached its end.
//! * Colours of 16 bits are rounded to 8. Alpha is ignored: it says how to paint a pixel, not what was seen. An Exif
//!   orientation is ignored too, because the depth has none: pixels lie as they are stored.
//! * Both images are registered pixel by pixel. Larger colour of the same field of view is brought to the size of the depth
//!   ([`Resized`]).
//!
//! Memory is bounded before any is taken: an image of more than `max_pixels` is refused by its header.

mod color;
mod depth;
mod error;
mod exr;
mod jpeg;
mod mask;
pub(crate) mod npy;
mod one_view;
mod picture;
mod tiff;

pub(crate) use color::{decode as color_of_image, of_picture as color_of_picture};
pub(crate) use depth::{check_unit, decode as depth_of_file, depth_of_image, of_picture as depth_of_picture};
pub use depth::{metres_of_floats, metres_of_units};
pub use error::ImageError;
pub use mask::{decode_mask, open_mask};
pub use one_view::Resized;
pub(crate) use picture::{Picture, Samples};

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use objecthood::{Frame, Raster};

use crate::capture::{Capture, Said};
use crate::error::Result;
use crate::formats::read_file;
use crate::given::Given;
use crate::source::{FrameRef, Source};

/// The files of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageFiles {
    /// Colour image, registered to the depth.
    pub color: Option<PathBuf>,
    /// Depth image.
    pub depth: PathBuf,
    /// What the frame is called, as in [`Capture::name`].
    pub name: OsString,
}

impl ImageFiles {
    /// The files of a frame that is called as its depth image is, without the ending.
    pub fn new(color: Option<PathBuf>, depth: PathBuf) -> Self {
        let name = depth.file_stem().unwrap_or(depth.as_os_str()).to_owned();
        Self { color, depth, name }
    }
}

/// Frames in image files, all read in the same way. No file is opened before its frame is read.
pub fn source_of(frames: Vec<ImageFiles>, given: &Given) -> Source {
    Source::listed(frames.into_iter().map(|files| frame_of(files, given, Said::default())).collect())
}

/// A frame in image files; what is `said` holds where nothing is given.
pub(crate) fn frame_of(files: ImageFiles, given: &Given, said: Said) -> FrameRef {
    let ImageFiles { color, depth, name } = files;
    let known = Given {
        camera: given.camera.or(said.camera),
        depth_scale: given.depth_scale.or(said.depth_scale),
        ..given.clone()
    };
    let (color_path, depth_path) = (color.clone(), depth.clone());
    let load = move || {
        let capture = open_images(color_path.as_deref(), &depth_path, &known)?;
        Ok(Capture { said, ..capture })
    };
    let load = Arc::new(load);
    FrameRef { color, is_metric: false, ..FrameRef::new(depth, name, load) }
}

/// Reads a depth image and the colour image registered to it.
///
/// # Errors
/// [`Error::At`](crate::Error::At) the file that is wrong: those of [`decode_images`], or it cannot be read.
fn open_images(color: Option<&Path>, depth: &Path, given: &Given) -> Result<Capture> {
    let depth_m =
        read_image(depth).and_then(|bytes| depth::decode(&bytes, given)).map_err(|e| e.at(depth))?;
    let color = color.map(|path| {
        read_image(path).and_then(|bytes| color::decode(&bytes, given.max_pixels)).map_err(|e| e.at(path))
    });
    capture_of(color.transpose()?, depth_m, given).map_err(|e| e.at(depth))
}

/// The frame that the content of a depth and a colour image makes.
///
/// # Errors
/// [`Error::Image`](crate::Error::Image) tells what is wrong with an image, its camera or its unit,
/// [`Error::Frame`](crate::Error::Frame) what keeps them from being a frame: two sizes, no depth anywhere.
pub fn decode_images(color: Option<&[u8]>, depth: &[u8], given: &Given) -> Result<Capture> {
    let depth_m = depth::decode(depth, given)?;
    let color = color.map(|bytes| color::decode(bytes, given.max_pixels)).transpose()?;
    capture_of(color, depth_m, given)
}

/// The frame of a depth (m) and a colour image, seen by the camera that is given. Larger colour of the same field of view is brought to the size of the
/// depth; a camera that is given for the colour image is scaled likewise.
///
/// # Errors
/// [`Error::Image`](crate::Error::Image): no camera, or that of an image of another size. [`Error::Frame`](crate::Error::Frame): colour of another
/// field of view, no depth anywhere.
pub fn capture_of(color: Option<Raster<[u8; 3]>>, depth_m: Raster<f32>, given: &Given) -> Result<Capture> {
    let (size, camera) = (depth_m.size(), given.camera.ok_or(ImageError::NoCamera)?);
    let smaller = color.as_ref().and_then(|color| one_view::resized(color, size)).transpose()?;
    let from = color.as_ref().map(Raster::size).filter(|_| smaller.is_some());
    let (camera, with_camera) = one_view::camera_of_depth(camera, size, from)?;
    let resized = from.map(|from| Resized { from, with_camera });
    Ok(Capture { resized, ..Capture::new(Frame::new(depth_m, smaller.or(color), camera)?) })
}

/// Whether a file that begins with `head` is an image of a format that is read.
pub(crate) fn is_image(head: &[u8]) -> bool {
    picture::probe(head).is_ok()
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
