//! TIFF images, the first page of each.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use super::check_pixels;
use super::error::ImageError;
use super::picture::{Picture, Samples};

/// Kinds of pixels that are read, in words.
const WANTED: &str = "grey or RGB with 8 or 16 bits, or grey with 32-bit floats";

/// Characters of what the decoder says.
const MAX_REASON: usize = 200;

pub(super) fn decode(bytes: &[u8], max_pixels: usize) -> Result<Picture, ImageError> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions().map_err(broken)?;
    let size = (width as usize, height as usize);
    check_pixels(size, max_pixels)?;
    let kind = decoder.colortype().map_err(broken)?;
    let channels = match kind {
        ColorType::Gray(8 | 16 | 32) => 1,
        ColorType::GrayA(8 | 16) => 2,
        ColorType::RGB(8 | 16) => 3,
        ColorType::RGBA(8 | 16) => 4,
        ColorType::CMYK(_) | ColorType::CMYKA(_) => return Err(ImageError::Cmyk),
        other => return Err(ImageError::PixelKind { found: format!("{other:?}"), wanted: WANTED }),
    };
    // A pixel has at most four samples of 16 bits. A strip may hold the whole image.
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 8 * size.0 * size.1;
    limits.intermediate_buffer_size = limits.decoding_buffer_size.saturating_add(1 << 20);
    let samples = match decoder.with_limits(limits).read_image().map_err(broken)? {
        DecodingResult::U8(samples) => Samples::U8(samples),
        DecodingResult::U16(samples) => Samples::U16(samples),
        DecodingResult::F32(samples) => Samples::F32(samples),
        _ => return Err(ImageError::PixelKind { found: format!("{kind:?} integers"), wanted: WANTED }),
    };
    let picture = Picture { size, channels, samples };
    let count = match &picture.samples {
        Samples::U8(samples) => samples.len(),
        Samples::U16(samples) => samples.len(),
        Samples::F32(samples) => samples.len(),
    };
    // As when every channel lies in a plane of its own.
    if count == size.0 * size.1 * channels {
        Ok(picture)
    } else {
        let found = format!("{kind:?} in separate planes");
        Err(ImageError::PixelKind { found, wanted: "TIFF with interleaved channels" })
    }
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn broken(error: tiff::TiffError) -> ImageError {
    // Some name every entry of a table that the file makes as long as it likes.
    let reason = error.to_string().chars().take(MAX_REASON).collect();
    ImageError::Broken { format: "TIFF", reason }
}
