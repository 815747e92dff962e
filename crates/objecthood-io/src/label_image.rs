//! Label images: greyscale PNG, the value of a pixel is its label, 0 = none.

use std::io::Cursor;

use image::codecs::png::{PngDecoder, PngEncoder};
use image::{DynamicImage, ImageBuffer, ImageDecoder, Luma};
use objecthood::Raster;

use crate::error::{Error, Result};

/// Deflate, and so PNG, expands no further.
const MAX_EXPANSION: u64 = 1032;

/// Where a PNG says its bit depth and colour type.
const DEPTH_AND_COLOR: std::ops::Range<usize> = 24..26;

/// A 16-bit greyscale PNG of the labels.
///
/// # Errors
/// [`Error::Png`] when the image is larger than a PNG can be.
pub fn encode(labels: &Raster<u16>) -> Result<Vec<u8>> {
    let too_large = || Error::Png { reason: "more than 2^31 columns or rows".into() };
    let (Ok(width), Ok(height)) = (u32::try_from(labels.width()), u32::try_from(labels.height())) else {
        return Err(too_large());
    };
    let image =
        ImageBuffer::<Luma<u16>, _>::from_raw(width, height, labels.as_slice()).ok_or_else(too_large)?;
    let mut bytes = Vec::new();
    image.write_with_encoder(PngEncoder::new(&mut bytes)).map_err(broken)?;
    Ok(bytes)
}

/// The labels in a greyscale PNG of 8 or 16 bits. Memory is bounded by the bytes that are there.
///
/// # Errors
/// [`Error::NotGrey`] for any other kind of pixel: palettes and fewer bits too, because there a value is not what it
/// seems; [`Error::Png`] when it is no PNG or a broken one; [`Error::Frame`] when it is too large.
pub fn decode(bytes: &[u8]) -> Result<Raster<u16>> {
    let decoder = PngDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    // As stored, not as decoded: fewer bits would be stretched to 8, and so change the labels.
    let &[depth, color] = bytes.get(DEPTH_AND_COLOR).and_then(<[u8]>::first_chunk).unwrap_or(&[0, 0]);
    if color != 0 || depth < 8 {
        return Err(Error::NotGrey { found: format!("{depth} bits a sample of {}", color_name(color)) });
    }
    if decoder.total_bytes() > MAX_EXPANSION.saturating_mul(bytes.len() as u64) {
        return Err(Error::Png { reason: "too few bytes for its size".into() });
    }
    let (width, height, labels) = match DynamicImage::from_decoder(decoder).map_err(broken)? {
        DynamicImage::ImageLuma8(image) => {
            (image.width(), image.height(), image.into_raw().into_iter().map(u16::from).collect())
        }
        DynamicImage::ImageLuma16(image) => (image.width(), image.height(), image.into_raw()),
        other => return Err(Error::NotGrey { found: format!("{:?}", other.color()) }),
    };
    Ok(Raster::from_vec(width as usize, height as usize, labels)?)
}

/// The labels of a PNG in which they may be indices of a palette of 8 bits, as data sets have them; else as [`decode`].
///
/// # Errors
/// Those of [`decode`].
pub fn decode_indices(bytes: &[u8]) -> Result<Raster<u16>> {
    if bytes.get(DEPTH_AND_COLOR) != Some(&[8, 3]) {
        return decode(bytes);
    }
    let broken = |error: png::DecodingError| Error::Png { reason: error.to_string() };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    // Not the colours: the numbers of the colours.
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(broken)?;
    let size = reader.output_buffer_size().unwrap_or(usize::MAX);
    if size as u64 > MAX_EXPANSION.saturating_mul(bytes.len() as u64) {
        return Err(Error::Png { reason: "too few bytes for its size".into() });
    }
    let mut indices = vec![0; size];
    let image = reader.next_frame(&mut indices).map_err(broken)?;
    let labels = indices.into_iter().map(u16::from).collect();
    Ok(Raster::from_vec(image.width as usize, image.height as usize, labels)?)
}

fn color_name(color: u8) -> &'static str {
    match color {
        0 => "grey",
        2 => "RGB",
        3 => "a palette",
        4 => "grey with alpha",
        _ => "RGB with alpha",
    }
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn broken(error: image::ImageError) -> Error {
    Error::Png { reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png_of(image: impl Into<DynamicImage>) -> Vec<u8> {
        let mut bytes = Vec::new();
        image.into().write_with_encoder(PngEncoder::new(&mut bytes)).unwrap();
        bytes
    }

    #[test]
    fn labels_come_back() {
        let labels = Raster::from_vec(3, 2, vec![0, 1, 255, 256, 65534, 65535]).unwrap();
        let bytes = encode(&labels).unwrap();
        assert_eq!(decode(&bytes).unwrap(), labels);
        let image = image::load_from_memory(&bytes).unwrap();
        assert_eq!(image.color(), image::ColorType::L16);
        assert_eq!(image.to_luma16().get_pixel(1, 1).0, [65534]);
    }

    #[test]
    fn eight_bits_are_labels_too() {
        let image = image::GrayImage::from_raw(2, 1, vec![7, 255]).unwrap();
        assert_eq!(decode(&png_of(image)).unwrap().as_slice(), [7, 255]);
    }

    #[test]
    fn indices_of_a_palette_are_labels_where_they_may_be() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 3, 1);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(vec![9; 3 * 256]);
        encoder.write_header().unwrap().write_image_data(&[0, 7, 255]).unwrap();
        assert_eq!(decode_indices(&bytes).unwrap().as_slice(), [0, 7, 255]);
        assert!(matches!(decode(&bytes), Err(Error::NotGrey { .. })));
        (0..bytes.len())
            .for_each(|end| assert!(decode_indices(&bytes[..end]).is_err() || end + 12 > bytes.len()));
        let grey = encode(&Raster::from_vec(2, 1, vec![3, 300]).unwrap()).unwrap();
        assert_eq!(decode_indices(&grey).unwrap().as_slice(), [3, 300]);
    }

    #[test]
    fn other_images_are_refused() {
        for (depth, color, found) in [
            (1, 0, "1 bits a sample of grey"),
            (4, 0, "4 bits a sample of grey"),
            (8, 2, "8 bits a sample of RGB"),
            (8, 3, "8 bits a sample of a palette"),
            (16, 4, "16 bits a sample of grey with alpha"),
            (8, 6, "8 bits a sample of RGB with alpha"),
        ] {
            let message = decode(&hand_made(2, 2, depth, color)).unwrap_err().to_string();
            assert!(
                message.contains(found) && message.contains("save it as 16-bit greyscale PNG"),
                "{message}"
            );
        }
    }

    #[test]
    fn noise_cuts_and_claims_are_refused() {
        assert!(matches!(decode(b""), Err(Error::Png { .. })));
        assert!(matches!(decode(b"P5 1 1 255 x"), Err(Error::Png { .. })));
        let bytes = encode(&Raster::filled(50, 50, 3).unwrap()).unwrap();
        for end in 0..bytes.len() - 13 {
            assert!(decode(&bytes[..end]).is_err(), "cut at {end}");
        }
        let message = decode(&hand_made(30_000, 30_000, 16, 0)).unwrap_err().to_string();
        assert!(message.contains("too few bytes"), "{message}");
    }

    /// A PNG header of the given size, bit depth and colour type, with an empty image.
    fn hand_made(width: u32, height: u32, depth: u8, color: u8) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut chunk = |name: &[u8], data: &[u8]| {
            bytes.extend((data.len() as u32).to_be_bytes());
            let body = [name, data].concat();
            bytes.extend(&body);
            bytes.extend(crc32(&body).to_be_bytes());
        };
        let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
        chunk(b"IHDR", &[&size[..], &[depth, color, 0, 0, 0]].concat());
        if color == 3 {
            chunk(b"PLTE", &[0; 6]);
        }
        chunk(b"IDAT", &[]);
        chunk(b"IEND", &[]);
        bytes
    }

    fn crc32(bytes: &[u8]) -> u32 {
        let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
        !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
    }
}
