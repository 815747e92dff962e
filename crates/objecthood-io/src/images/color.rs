//! Colour images.

use objecthood::Raster;

use super::error::ImageError;
use super::picture::{self, Picture, Samples};
use crate::error::Result;

/// The colours of an image file, 8 bits each.
pub(crate) fn decode(bytes: &[u8], max_pixels: usize) -> Result<Raster<[u8; 3]>> {
    of_picture(picture::decode(bytes, max_pixels)?)
}

/// The colours of an image, 8 bits each.
pub(crate) fn of_picture(picture: Picture) -> Result<Raster<[u8; 3]>> {
    let Picture { size: (width, height), channels, samples } = picture;
    let colors = match samples {
        Samples::U8(samples) => pixels(&samples, channels, |sample| sample),
        Samples::U16(_) if channels <= 2 => {
            return Err(ImageError::ColorIsDepth { found: "a grey image with 16 bits" }.into());
        }
        // 65535 / 255 = 257.
        Samples::U16(samples) => pixels(&samples, channels, |sample| ((u32::from(sample) + 128) / 257) as u8),
        Samples::F32(_) => {
            return Err(ImageError::ColorIsDepth { found: "an image of floating-point numbers" }.into());
        }
    };
    Ok(Raster::from_vec(width, height, colors)?)
}

/// RGB of every pixel; grey is all three, alpha is left out.
fn pixels<T: Copy>(samples: &[T], channels: usize, to_8_bits: impl Fn(T) -> u8) -> Vec<[u8; 3]> {
    let of = |pixel: &[T]| match *pixel {
        [r, g, b, ..] => [r, g, b].map(&to_8_bits),
        [grey, ..] => [to_8_bits(grey); 3],
        [] => [0; 3],
    };
    samples.chunks_exact(channels).map(of).collect()
}
