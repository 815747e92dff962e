//! Masks: which pixels are looked at.

use std::path::Path;

use objecthood::Raster;

use super::picture::{self, Picture, Samples};
use super::read_image;
use crate::error::Result;

/// Opens a mask, as [`decode_mask`].
///
/// # Errors
/// [`Error::At`](crate::Error::At) the path: those of [`decode_mask`], or it cannot be read.
pub fn open_mask(path: &Path, max_pixels: usize) -> Result<Raster<bool>> {
    read_image(path).and_then(|bytes| decode_mask(&bytes, max_pixels)).map_err(|error| error.at(path))
}

/// Which pixels of an image are not black; alpha is ignored.
///
/// # Errors
/// [`Error::Image`](crate::Error::Image): no image, broken, or of more than `max_pixels`.
pub fn decode_mask(bytes: &[u8], max_pixels: usize) -> Result<Raster<bool>> {
    let Picture { size: (width, height), channels, samples } = picture::decode(bytes, max_pixels)?;
    let looked_at = match samples {
        Samples::U8(samples) => pixels(&samples, channels, |sample| sample != 0),
        Samples::U16(samples) => pixels(&samples, channels, |sample| sample != 0),
        Samples::F32(samples) => pixels(&samples, channels, |sample| sample != 0.0),
    };
    Ok(Raster::from_vec(width, height, looked_at)?)
}

fn pixels<T: Copy>(samples: &[T], channels: usize, is_set: impl Fn(T) -> bool) -> Vec<bool> {
    let colors = if channels > 2 { 3 } else { 1 };
    samples.chunks_exact(channels).map(|pixel| pixel[..colors].iter().any(|&sample| is_set(sample))).collect()
}
