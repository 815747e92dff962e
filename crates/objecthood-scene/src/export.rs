//! Pictures and truth as the bytes of files.

mod json;
mod lzf;
mod mosd;
mod video;

use image::codecs::png::PngEncoder;
use image::{EncodableLayout, ImageBuffer, Luma, PixelWithColorType, Rgb};
use objecthood::Frame;
use objecthood_io::label_image;

use crate::error::{Error, Result};
use crate::render::Rendered;

pub use json::{camera_json, scene_json};
pub use mosd::{mosd_labels, mosd_labels_of, pcd};
pub use video::{video_frame, video_lists};

/// Units per metre of the depth images: a tenth of a millimetre, so that no step of a sensor is rounded away.
pub const DEPTH_SCALE: f64 = 10_000.0;

/// The colour image as PNG; black without colour.
///
/// # Errors
/// [`Error::Png`] when the image is larger than a PNG can be.
pub fn color_png(frame: &Frame) -> Result<Vec<u8>> {
    let black = || vec![0; 3 * frame.depth_m().len()];
    let bytes = frame.color().map_or_else(black, |color| color.as_slice().as_flattened().to_vec());
    png::<Rgb<u8>>(frame.size(), bytes)
}

/// The depth image as 16-bit greyscale PNG, [`DEPTH_SCALE`] units a metre; 0 = none, or beyond 6.5 m.
///
/// # Errors
/// [`Error::Png`] when the image is larger than a PNG can be.
pub fn depth_png(frame: &Frame) -> Result<Vec<u8>> {
    let units = |z: &f32| {
        let units = (f64::from(*z) * DEPTH_SCALE).round();
        if units <= f64::from(u16::MAX) { units as u16 } else { 0 }
    };
    png::<Luma<u16>>(frame.size(), frame.depth_m().as_slice().iter().map(units).collect())
}

fn png<P: PixelWithColorType>((width, height): (usize, usize), values: Vec<P::Subpixel>) -> Result<Vec<u8>>
where
    [P::Subpixel]: EncodableLayout,
{
    let too_large = || Error::Png { reason: "more than 2^32 columns or rows".into() };
    let (Ok(width), Ok(height)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(too_large());
    };
    let image = ImageBuffer::<P, _>::from_raw(width, height, values).ok_or_else(too_large)?;
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new(&mut bytes);
    image.write_with_encoder(encoder).map_err(|reason| Error::Png { reason: reason.to_string() })?;
    Ok(bytes)
}

/// The instance of every pixel with depth as label image.
///
/// # Errors
/// [`Error::Write`] when the image is larger than a PNG can be.
pub fn truth_png(rendered: &Rendered) -> Result<Vec<u8>> {
    Ok(label_image::encode(&rendered.truth.instance)?)
}

/// The surface of every pixel with depth as label image.
///
/// # Errors
/// [`Error::Write`] when the image is larger than a PNG can be.
pub fn surfaces_png(rendered: &Rendered) -> Result<Vec<u8>> {
    Ok(label_image::encode(&rendered.truth.surface)?)
}
