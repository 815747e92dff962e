//! Messages of images -> depth and colour.

use objecthood::Raster;

use super::error::RecordingError;
use super::fields::{Fields, Wire};
use super::messages::{CompressedImage, Header, Image};
use super::rvl;
use crate::error::Result;
use crate::images::{check_pixels, color_of_image, depth_of_image, metres_of_floats, metres_of_units};
use crate::text::preview;

/// A type of messages that hold images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Raw,
    Compressed,
}

/// What an image shows, as far as its first message tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Shows {
    Depth,
    Color,
    /// One channel of 8 bits: often infrared.
    Grey,
    /// One of 16 bits without a name: RealSense's depth, and infrared of other cameras.
    Deep,
}

/// An encoding or a format as one reads it, in lower case.
fn word(text: &[u8]) -> Vec<u8> {
    text.to_ascii_lowercase()
}

/// What an image message shows.
pub(super) fn shows(kind: Kind, message: &[u8], wire: Wire) -> Result<(Shows, Header), String> {
    let of = |encoding: &[u8]| match encoding {
        b"16uc1" | b"32fc1" => Shows::Depth,
        b"mono16" | b"16sc1" => Shows::Deep,
        b"mono8" | b"8uc1" => Shows::Grey,
        _ => Shows::Color,
    };
    Ok(match kind {
        Kind::Raw => {
            let Image { header, encoding, .. } = Image::read(message, wire)?;
            (of(&word(encoding)), header)
        }
        Kind::Compressed => {
            let CompressedImage { header, format, .. } = CompressedImage::read(message, wire)?;
            let format = word(format);
            let is_depth = format.windows(15).any(|part| part == b"compresseddepth");
            let encoding = format.split(|&byte| byte == b';').next().unwrap_or_default();
            (if is_depth { Shows::Depth } else { of(encoding.trim_ascii()) }, header)
        }
    })
}

/// How images of a topic are read.
pub(super) struct Reading<'a> {
    pub(super) topic: &'a str,
    pub(super) kind: Kind,
    pub(super) wire: Wire,
    pub(super) max_pixels: usize,
}

impl Reading<'_> {
    fn damaged(&self, problem: impl Into<String>) -> RecordingError {
        RecordingError::Message { topic: preview(self.topic.as_bytes()), problem: problem.into() }
    }

    fn encoding(&self, encoding: &[u8], wanted: &'static str) -> RecordingError {
        let (topic, encoding) = (preview(self.topic.as_bytes()), preview(encoding));
        RecordingError::Encoding { topic, encoding, wanted }
    }

    /// The depth of every pixel (m) and when it was measured. Whole numbers have `depth_scale` units a metre, floats are metres.
    pub(super) fn depth(&self, message: &[u8], depth_scale: f64) -> Result<(Raster<f32>, Header)> {
        match self.kind {
            Kind::Raw => {
                let image = Image::read(message, self.wire).map_err(|problem| self.damaged(problem))?;
                let depth_m = match &word(image.encoding)[..] {
                    b"16uc1" | b"mono16" | b"16sc1" => {
                        metres_of_units(self.samples(&image, u16::from_le_bytes)?, depth_scale)
                    }
                    b"32fc1" => metres_of_floats(self.samples(&image, f32::from_le_bytes)?, 1.0),
                    _ => return Err(self.encoding(image.encoding, "16UC1 or 32FC1").into()),
                };
                Ok((Raster::from_vec(image.size.0, image.size.1, depth_m)?, image.header))
            }
            Kind::Compressed => {
                let image =
                    CompressedImage::read(message, self.wire).map_err(|problem| self.damaged(problem))?;
                Ok((self.compressed_depth(&image, depth_scale)?, image.header))
            }
        }
    }

    /// The colour of every pixel.
    pub(super) fn color(&self, message: &[u8]) -> Result<Raster<[u8; 3]>> {
        if self.kind == Kind::Compressed {
            let image = CompressedImage::read(message, self.wire).map_err(|problem| self.damaged(problem))?;
            return color_of_image(image.data, self.max_pixels);
        }
        let image = Image::read(message, self.wire).map_err(|problem| self.damaged(problem))?;
        let colors = match &word(image.encoding)[..] {
            b"rgb8" => self.samples(&image, |rgb: [u8; 3]| rgb)?,
            b"bgr8" | b"8uc3" => self.samples(&image, |[b, g, r]: [u8; 3]| [r, g, b])?,
            b"rgba8" => self.samples(&image, |[r, g, b, _]: [u8; 4]| [r, g, b])?,
            b"bgra8" | b"8uc4" => self.samples(&image, |[b, g, r, _]: [u8; 4]| [r, g, b])?,
            b"mono8" | b"8uc1" => self.samples(&image, |[grey]: [u8; 1]| [grey; 3])?,
            b"yuv422_yuy2" | b"yuyv" => {
                self.samples(&image, |[y0, u, y1, v]: [u8; 4]| [rgb_of(y0, u, v), rgb_of(y1, u, v)])?.concat()
            }
            b"yuv422" | b"uyvy" => {
                self.samples(&image, |[u, y0, v, y1]: [u8; 4]| [rgb_of(y0, u, v), rgb_of(y1, u, v)])?.concat()
            }
            _ => return Err(self.encoding(image.encoding, "rgb8 or bgr8").into()),
        };
        Ok(Raster::from_vec(image.size.0, image.size.1, colors)?)
    }

    /// The samples of a raw image, row by row, of `BYTES` bytes each; bytes are put in little-endian order.
    fn samples<const BYTES: usize, T>(
        &self,
        image: &Image<'_>,
        of: impl Fn([u8; BYTES]) -> T,
    ) -> Result<Vec<T>> {
        let (width, height) = image.size;
        check_pixels(image.size, self.max_pixels)?;
        let bytes_a_pixel = match &word(image.encoding)[..] {
            b"yuv422_yuy2" | b"yuyv" | b"yuv422" | b"uyvy" if width % 2 == 0 => 2,
            b"yuv422_yuy2" | b"yuyv" | b"yuv422" | b"uyvy" => {
                return Err(self.damaged("an odd width of pairs").into());
            }
            _ => BYTES,
        };
        let (row, last) = (width * bytes_a_pixel, image.step.saturating_mul(height.saturating_sub(1)));
        // The last row may lack what fills up the others, and RealSense writes some bytes more.
        if image.step < row || last.saturating_add(row) > image.data.len() || row == 0 || height == 0 {
            let (bytes, step) = (image.data.len(), image.step);
            return Err(self
                .damaged(format!("{bytes} bytes in rows of {step} are no {width}x{height} pixels"))
                .into());
        }
        let is_big_endian =
            image.is_big_endian && matches!(&word(image.encoding)[..], b"16uc1" | b"mono16" | b"32fc1");
        let mut samples = Vec::with_capacity(row / BYTES * height);
        for bytes in image.data.chunks(image.step).take(height) {
            let (pixels, _) = bytes[..row].as_chunks::<BYTES>();
            if is_big_endian {
                samples.extend(pixels.iter().map(|&(mut pixel)| {
                    pixel.reverse();
                    of(pixel)
                }));
            } else {
                samples.extend(pixels.iter().map(|&pixel| of(pixel)));
            }
        }
        Ok(samples)
    }

    /// The depth of `compressed_depth_image_transport`: a head of twelve bytes, then PNG, or the size and RVL. Floats are stored as
    /// inverse depth, whose quantum and offset the head tells: z = a / (stored - b).
    fn compressed_depth(&self, image: &CompressedImage<'_>, depth_scale: f64) -> Result<Raster<f32>> {
        /// Bytes of the head.
        const HEAD: usize = 12;
        let format = word(image.format);
        let is_transport = format.windows(15).any(|part| part == b"compresseddepth");
        if !is_transport {
            return depth_of_image(image.data, |raw| metres_of_units(raw, depth_scale), self.max_pixels);
        }
        let wrong = |problem: String| self.damaged(problem);
        let fields = &mut Fields::packed(image.data);
        fields.raw(4).map_err(wrong)?;
        let (a, b) = (fields.f32().map_err(wrong)?, fields.f32().map_err(wrong)?);
        let is_float = format.starts_with(b"32fc1");
        let metres = |raw: Vec<u16>| match is_float {
            true => raw
                .into_iter()
                .map(|raw| if raw == 0 { f32::NAN } else { a / (f32::from(raw) - b) })
                .collect(),
            false => metres_of_units(raw, depth_scale),
        };
        if !format.ends_with(b"rvl") {
            return depth_of_image(&image.data[HEAD..], metres, self.max_pixels);
        }
        let (width, height) = (fields.length().map_err(wrong)?, fields.length().map_err(wrong)?);
        check_pixels((width, height), self.max_pixels)?;
        let raw = rvl::decode(&image.data[HEAD + 8..], width * height);
        let raw = raw.ok_or_else(|| self.damaged("its RVL data are no image of the size that they say"))?;
        Ok(Raster::from_vec(width, height, metres(raw))?)
    }
}

/// The colour of a pixel in YUV of ITU-R BT.601, as cameras write it.
fn rgb_of(y: u8, u: u8, v: u8) -> [u8; 3] {
    let (y, u, v) = (1.164 * (f32::from(y) - 16.0), f32::from(u) - 128.0, f32::from(v) - 128.0);
    [y + 1.596 * v, y - 0.813 * v - 0.391 * u, y + 2.018 * u].map(|part| part.round() as u8)
}
