//! Bytes of an image file -> samples as they are stored, whatever they mean.

use std::io::Cursor;

use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder, Limits};

use super::error::ImageError;
use super::{check_pixels, exr, jpeg, npy, tiff};

/// An image as it is stored.
#[derive(Debug)]
pub(crate) struct Picture {
    /// Columns and rows.
    pub(crate) size: (usize, usize),
    /// Samples of a pixel: 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha.
    pub(crate) channels: usize,
    /// Row by row, `channels` for every pixel.
    pub(crate) samples: Samples,
}

/// The kinds of samples that are read.
#[derive(Debug)]
pub(crate) enum Samples {
    U8(Vec<u8>),
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// The formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Jpeg,
    Tiff,
    Exr,
    Npy,
}

/// The format of an image that begins with `head`.
pub(super) fn probe(head: &[u8]) -> Result<Format, ImageError> {
    const SIGNATURES: [(&[u8], Format); 8] = [
        (b"\x89PNG\r\n\x1a\n", Format::Png),
        (b"\xff\xd8\xff", Format::Jpeg),
        (b"II*\0", Format::Tiff),
        (b"MM\0*", Format::Tiff),
        (b"II+\0", Format::Tiff),
        (b"MM\0+", Format::Tiff),
        (b"\x76\x2f\x31\x01", Format::Exr),
        (crate::npy::MARK, Format::Npy),
    ];
    if head.is_empty() {
        return Err(ImageError::Empty);
    }
    let mine = SIGNATURES.iter().find(|(signature, _)| head.starts_with(signature));
    mine.map(|&(_, format)| format).ok_or(ImageError::UnknownFormat)
}

/// Decodes an image of at most `max_pixels`.
pub(super) fn decode(bytes: &[u8], max_pixels: usize) -> Result<Picture, ImageError> {
    match probe(bytes)? {
        Format::Png => {
            check_pixels(png_size(bytes), max_pixels)?;
            let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits(max_pixels));
            from_decoder("PNG", decoder, max_pixels)
        }
        Format::Jpeg => {
            jpeg::check(bytes)?;
            from_decoder("JPEG", JpegDecoder::new(Cursor::new(bytes)), max_pixels)
        }
        Format::Tiff => tiff::decode(bytes, max_pixels),
        Format::Exr => exr::decode(bytes, max_pixels),
        Format::Npy => npy::decode(bytes, max_pixels),
    }
}

/// Columns and rows of a PNG, which stand at one place. The decoder would make room for a row before it told them.
fn png_size(bytes: &[u8]) -> (usize, usize) {
    let side = |at: usize| {
        let bytes = bytes.get(at..).and_then(<[u8]>::first_chunk);
        bytes.map_or(0, |&side| u32::from_be_bytes(side) as usize)
    };
    (side(16), side(20))
}

/// Room for the largest image that is allowed, 16-bit RGB and alpha, and for what a small one has beside its pixels.
fn limits(max_pixels: usize) -> Limits {
    let mut limits = Limits::default();
    limits.max_alloc = Some((8 * max_pixels as u64).saturating_add(1 << 24));
    limits
}

fn from_decoder<D: ImageDecoder>(
    format: &'static str,
    decoder: image::ImageResult<D>,
    max_pixels: usize,
) -> Result<Picture, ImageError> {
    let broken = |e: image::ImageError| ImageError::Broken { format, reason: e.to_string() };
    let decoder = decoder.map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let size = (width as usize, height as usize);
    check_pixels(size, max_pixels)?;

    let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let channels = usize::from(image.color().channel_count());
    let samples = match image {
        DynamicImage::ImageLuma8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageLumaA8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageRgb8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageRgba8(image) => Samples::U8(image.into_raw()),
        DynamicImage::ImageLuma16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageLumaA16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageRgb16(image) => Samples::U16(image.into_raw()),
        DynamicImage::ImageRgba16(image) => Samples::U16(image.into_raw()),
        other => {
            let found = format!("{:?}", other.color());
            return Err(ImageError::PixelKind { found, wanted: "grey or RGB with 8 or 16 bits" });
        }
    };
    Ok(Picture { size, channels, samples })
}
