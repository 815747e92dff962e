//! Masks: which pixels are looked at.

use objecthood::Raster;

use super::picture::{self, Picture, Samples};
use crate::error::Result;

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
