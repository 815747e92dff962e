//! Frames through a pipe: what a program sends to `objecthood segment - --format frames`, and what it is answered.
//!
//! A frame is four parts, one behind the other; numbers are little-endian:
//!
//! | bytes | content |
//! |---|---|
//! | 16 | `OHF1`, then the lengths of the other parts as three 32-bit numbers |
//! | at most 65536 | [`Header`] as JSON |
//! | at most 4 for each pixel that is allowed, and 65536 | depth |
//! | the same | colour, none for a frame without |
//!
//! Rows follow each other without padding. The lengths are known before the content is looked at, so a frame whose content
//! is wrong is answered by an error, and the next is read. After a length that is out of bounds nothing can be: it ends the
//! stream. docs/PIPE.md is the same for users, with a client.
//!
//! Memory is taken as bytes arrive, never by what a length claims.

mod answer;

use std::io::{self, Read};

use objecthood::Camera;
use serde::Deserialize;

pub use answer::{Answer, LabelRun, label_runs};

use crate::capture::{Capture, Said};
use crate::error::Result;
use crate::given::Given;
use crate::images::{
    Picture, Samples, capture_of, check_pixels, color_of_image, color_of_picture, depth_of_file,
    depth_of_picture,
};
use crate::organize::GridCamera;

const MARK: &[u8; 4] = b"OHF1";
/// The most bytes of a header, and of what an image file has beside its pixels.
const MOST_BESIDE: u64 = 1 << 16;
/// The most bytes of a pixel: a depth of 32 bits.
const MOST_OF_PIXEL: u64 = 4;

/// What a frame says of itself.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Columns of the images (px); image files may leave it out.
    #[serde(default)]
    pub width: usize,
    /// Rows of the images (px); image files may leave it out.
    #[serde(default)]
    pub height: usize,
    /// How the depth is stored.
    pub depth: DepthKind,
    /// How the colour is stored; needed where there is some.
    #[serde(default)]
    pub color: Option<ColorKind>,
    /// Units of the depth that make a metre, as in [`Given`]; needed for whole numbers.
    #[serde(default)]
    pub depth_scale: Option<f64>,
    /// fx, fy, cx, cy (px).
    #[serde(default)]
    pub camera: Option<[f64; 4]>,
    /// What the frame is called; repeated in the answer.
    #[serde(default)]
    pub name: Option<String>,
    /// When it was measured (ns); repeated in the answer.
    #[serde(default)]
    pub stamp_ns: Option<i64>,
}

/// How depth is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DepthKind {
    /// 16-bit whole numbers.
    Uint16,
    /// 32-bit floating-point numbers.
    Float32,
    /// An image file of depth, as [`images`](crate::images) reads them.
    Image,
}

/// How colour is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ColorKind {
    /// Red, green, blue, a byte each.
    Rgb8,
    /// An image file of colour.
    Image,
}

/// Why the stream cannot be read on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipeError {
    /// The system does not give the bytes.
    #[error("the frames cannot be read ({0})")]
    Read(io::Error),
    /// The stream ends within a frame.
    #[error("the stream ends within frame {number}: its last {missing} bytes are missing")]
    Cut {
        /// Number of the frame, from 0.
        number: usize,
        /// Bytes of the part that was read.
        missing: u64,
    },
    /// A frame that does not begin as one.
    #[error(
        "frame {number} does not begin with OHF1: send 16 bytes of OHF1 and three lengths, then header, depth and colour of these lengths"
    )]
    NoMark {
        /// Number of the frame, from 0.
        number: usize,
    },
    /// A part that is too long.
    #[error("the {part} of frame {number} would have {bytes} bytes; at most {most} are read")]
    TooLong {
        /// Number of the frame, from 0.
        number: usize,
        /// Which part.
        part: &'static str,
        /// Its length.
        bytes: u32,
        /// What is allowed.
        most: u64,
    },
}

/// Why one frame is no frame, while the next may be.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PipeFrameError {
    /// The header is not JSON, or not with these fields.
    #[error("the header of the frame is wrong: {0}")]
    Header(serde_json::Error),
    /// A part has another length than the header says.
    #[error("the {part} has {found} bytes, but {width}x{height} pixels of this kind have {wanted}")]
    Length {
        /// Which part.
        part: &'static str,
        /// Its bytes.
        found: usize,
        /// Columns (px).
        width: usize,
        /// Rows (px).
        height: usize,
        /// The bytes that the pixels would have.
        wanted: usize,
    },
    /// Colours of an unknown kind.
    #[error(
        "there are colours, but the header does not say how they are stored: add \"color\": \"rgb8\" or \"image\""
    )]
    NoColorKind,
}

/// A frame that has arrived; its content has not been looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PipeFrame {
    header: Vec<u8>,
    depth: Vec<u8>,
    color: Vec<u8>,
}

impl PipeFrame {
    /// Reads the next frame, which is `number` of the stream, of at most `max_pixels`. `None`: the stream ended before it.
    ///
    /// # Errors
    /// [`PipeError`]: nothing can be read behind it.
    pub fn read(reader: &mut impl Read, number: usize, max_pixels: usize) -> Result<Option<Self>, PipeError> {
        let mut lead = Vec::new();
        reader.take(16).read_to_end(&mut lead).map_err(PipeError::Read)?;
        if lead.is_empty() {
            return Ok(None);
        }
        if !lead.starts_with(MARK) {
            return Err(PipeError::NoMark { number });
        }
        let Some(lengths) = lead[4..].first_chunk::<12>() else {
            return Err(PipeError::Cut { number, missing: 16 - lead.len() as u64 });
        };
        let length = |k: usize| u32::from_le_bytes(std::array::from_fn(|i| lengths[4 * k + i]));
        let of_image = MOST_OF_PIXEL.saturating_mul(max_pixels as u64).saturating_add(MOST_BESIDE);
        let parts = [
            ("header", length(0), MOST_BESIDE),
            ("depth", length(1), of_image),
            ("colour", length(2), of_image),
        ];
        if let Some(&(part, bytes, most)) = parts.iter().find(|&&(_, bytes, most)| u64::from(bytes) > most) {
            return Err(PipeError::TooLong { number, part, bytes, most });
        }
        let mut read = |k: usize| {
            let bytes = u64::from(length(k));
            let mut part = Vec::new();
            reader.take(bytes).read_to_end(&mut part).map_err(PipeError::Read)?;
            match bytes - part.len() as u64 {
                0 => Ok(part),
                missing => Err(PipeError::Cut { number, missing }),
            }
        };
        Ok(Some(Self { header: read(0)?, depth: read(1)?, color: read(2)? }))
    }

    /// What the frame says of itself.
    ///
    /// # Errors
    /// [`PipeFrameError::Header`].
    pub fn header(&self) -> Result<Header, PipeFrameError> {
        serde_json::from_slice(&self.header).map_err(PipeFrameError::Header)
    }

    /// The frame itself. `header` is its own; what is given counts more.
    ///
    /// # Errors
    /// [`Error::Pipe`](crate::Error::Pipe), and those of [`decode_images`](crate::images::decode_images).
    pub fn capture(&self, header: &Header, given: &Given) -> Result<Capture> {
        let size = (header.width, header.height);
        let of_header = header.camera.map(|[fx, fy, cx, cy]| Camera::new(fx, fy, cx, cy)).transpose()?;
        let of_header = of_header.map(|camera| GridCamera { camera, size: None });
        let said = Said { camera: of_header, depth_scale: header.depth_scale, ..Said::default() };
        let known = Given {
            camera: given.camera.or(said.camera),
            depth_scale: given.depth_scale.or(said.depth_scale),
            ..given.clone()
        };
        let grey = |samples| Picture { size, channels: 1, samples };
        let depth_m = match header.depth {
            DepthKind::Uint16 => {
                let samples = numbers(&self.depth, "depth", size, given.max_pixels, 1, u16::from_le_bytes)?;
                depth_of_picture(grey(Samples::U16(samples)), &known)?
            }
            DepthKind::Float32 => {
                let samples = numbers(&self.depth, "depth", size, given.max_pixels, 1, f32::from_le_bytes)?;
                depth_of_picture(grey(Samples::F32(samples)), &known)?
            }
            DepthKind::Image => depth_of_file(&self.depth, &known)?,
        };
        let color = match (self.color.is_empty(), header.color) {
            (true, _) => None,
            (false, None) => return Err(PipeFrameError::NoColorKind.into()),
            (false, Some(ColorKind::Rgb8)) => {
                let samples = numbers(&self.color, "colour", size, given.max_pixels, 3, u8::from_le_bytes)?;
                Some(color_of_picture(Picture { size, channels: 3, samples: Samples::U8(samples) })?)
            }
            (false, Some(ColorKind::Image)) => Some(color_of_image(&self.color, given.max_pixels)?),
        };
        let capture = capture_of(color, depth_m, &known)?;
        Ok(Capture { said, stamp_ns: header.stamp_ns, ..capture })
    }
}

/// The numbers of an image of this size with `channels` for each pixel.
fn numbers<T, const N: usize>(
    bytes: &[u8],
    part: &'static str,
    (width, height): (usize, usize),
    max_pixels: usize,
    channels: usize,
    of: impl Fn([u8; N]) -> T,
) -> Result<Vec<T>> {
    check_pixels((width, height), max_pixels)?;
    let wanted = width * height * channels * N;
    if bytes.len() != wanted {
        return Err(PipeFrameError::Length { part, found: bytes.len(), width, height, wanted }.into());
    }
    Ok(bytes.as_chunks::<N>().0.iter().map(|&bytes| of(bytes)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = r#"{"width": 2, "height": 1, "depth": "uint16", "depth_scale": 1000, "color": "rgb8",
        "camera": [2, 2, 0.5, 0], "name": "a", "stamp_ns": 7}"#;

    fn sent(header: &str, depth: &[u8], color: &[u8]) -> Vec<u8> {
        let lengths = [header.len(), depth.len(), color.len()].map(|length| (length as u32).to_le_bytes());
        [MARK, lengths.as_flattened(), header.as_bytes(), depth, color].concat()
    }

    fn good() -> Vec<u8> {
        sent(HEADER, &[0xe8, 3, 0, 0], &[1, 2, 3, 4, 5, 6])
    }

    fn received(mut bytes: &[u8]) -> Result<Option<PipeFrame>, PipeError> {
        PipeFrame::read(&mut bytes, 0, 100)
    }

    fn told(header: &str, depth: &[u8], color: &[u8]) -> String {
        let frame = received(&sent(header, depth, color)).unwrap().unwrap();
        let capture = frame
            .header()
            .map_err(crate::Error::from)
            .and_then(|header| frame.capture(&header, &Given { max_pixels: 100, ..Given::default() }));
        capture.unwrap_err().to_string()
    }

    #[test]
    fn frames_follow_each_other() {
        let two = [good(), good()].concat();
        let mut rest = two.as_slice();
        for number in 0..2 {
            let frame = PipeFrame::read(&mut rest, number, 100).unwrap().unwrap();
            let header = frame.header().unwrap();
            let capture = frame.capture(&header, &Given::default()).unwrap();
            assert_eq!(header.name.as_deref(), Some("a"));
            assert_eq!(capture.stamp_ns, Some(7));
            assert_eq!(capture.frame.depth_m().as_slice()[0], 1.0);
            assert!(capture.frame.depth_m().as_slice()[1].is_nan());
            assert_eq!(capture.frame.color().unwrap().as_slice(), [[1, 2, 3], [4, 5, 6]]);
            assert_eq!(capture.frame.camera().fx_px, 2.0);
        }
        assert!(PipeFrame::read(&mut rest, 2, 100).unwrap().is_none());
    }

    #[test]
    fn what_is_given_counts_more() {
        let frame = received(&good()).unwrap().unwrap();
        let given = Given {
            camera: Some("3,3,0.5,0".parse().unwrap()),
            depth_scale: Some(500.0),
            ..Given::default()
        };
        let capture = frame.capture(&frame.header().unwrap(), &given).unwrap();
        assert_eq!((capture.frame.camera().fx_px, capture.frame.depth_m().as_slice()[0]), (3.0, 2.0));
    }

    #[test]
    fn a_stream_cut_anywhere_is_told() {
        let good = good();
        for end in 1..good.len() {
            let error = received(&good[..end]).unwrap_err();
            assert!(
                matches!(error, PipeError::Cut { .. } | PipeError::NoMark { .. }),
                "cut at {end}: {error}"
            );
        }
    }

    #[test]
    fn lengths_are_bounded() {
        for (part, at) in [("header", 4), ("depth", 8), ("colour", 12)] {
            for length in [1_u32 << 31, u32::MAX, 70_000] {
                let mut bytes = good();
                bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
                let message = received(&bytes).unwrap_err().to_string();
                assert!(
                    message.contains(&format!("the {part} of frame 0 would have {length} bytes")),
                    "{message}"
                );
            }
        }
    }

    #[test]
    fn a_wrong_frame_is_told() {
        let with = |from: &str, to: &str| {
            assert!(HEADER.contains(from), "{from}");
            told(&HEADER.replace(from, to), &[0xe8, 3, 0, 0], &[1, 2, 3, 4, 5, 6])
        };
        for (message, said) in [
            (told("{", &[], &[]), "the header of the frame is wrong: EOF"),
            (with("uint16", "int8"), "unknown variant `int8`"),
            (with("name", "nam"), "unknown field `nam`"),
            (
                with("\"width\": 2", "\"width\": 3"),
                "the depth has 4 bytes, but 3x1 pixels of this kind have 6",
            ),
            (
                with("\"width\": 2", "\"width\": 18446744073709551615"),
                "are more than the 100 that may be read",
            ),
            (with("uint16", "float32"), "the depth has 4 bytes, but 2x1 pixels of this kind have 8"),
            (with("\"color\": \"rgb8\",", ""), "does not say how they are stored"),
            (with("uint16", "image"), "not that of a PNG"),
            (with("\"depth_scale\": 1000,", ""), "the unit of integer depth is not known"),
            (with("\"camera\": [2, 2, 0.5, 0],", ""), "do not say which camera"),
            (with("[2, 2, 0.5, 0]", "[0, 2, 0.5, 0]"), "fx"),
            (
                told(HEADER, &[0xe8, 3, 0, 0], &[1]),
                "the colour has 1 bytes, but 2x1 pixels of this kind have 6",
            ),
        ] {
            assert!(message.contains(said) && !message.contains('\n'), "expected `{said}`: {message}");
        }
    }
}
