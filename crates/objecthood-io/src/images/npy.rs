//! Depth in arrays of NumPy.

use std::io::Read;

use super::check_pixels;
use super::error::ImageError;
use super::picture::{Picture, Samples};
use crate::npy::{Array, NpyError};

/// The image that an array of rows and columns is.
///
/// Whole numbers become 16-bit ones: what is below 0 is 0, and what is above 65535 is that, which means none as well.
pub(crate) fn picture_of<R: Read>(array: Array<R>, max_pixels: usize) -> Result<Picture, ImageError> {
    let (&[height, width] | &[height, width, 1]) = array.shape.as_slice() else {
        let found = format!("an array of {} sides", array.shape.len());
        return Err(ImageError::PixelKind { found, wanted: "an array of rows and columns" });
    };
    let size = (width, height);
    check_pixels(size, max_pixels)?;
    let samples = if array.is_bytes() {
        return Err(ImageError::DepthEightBit);
    } else if array.is_whole() {
        let mut samples = Vec::new();
        let to_16_bits = |whole: i64| whole.clamp(0, u16::MAX.into()) as u16;
        array.read(|number| samples.push(to_16_bits(number.as_i64()))).map_err(broken)?;
        Samples::U16(samples)
    } else {
        let mut samples = Vec::new();
        array.read(|number| samples.push(number.as_f64() as f32)).map_err(broken)?;
        Samples::F32(samples)
    };
    Ok(Picture { size, channels: 1, samples })
}

/// The image in an NPY file.
pub(super) fn decode(bytes: &[u8], max_pixels: usize) -> Result<Picture, ImageError> {
    picture_of(Array::open(bytes).map_err(broken)?, max_pixels)
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn broken(error: NpyError) -> ImageError {
    ImageError::Broken { format: "NPY", reason: error.to_string() }
}
