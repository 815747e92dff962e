//! The points as bytes, whatever their encoding: one little-endian number per value, at a known place.

use std::borrow::Cow;

use super::ascii;
use super::error::PcdError;
use super::header::{Encoding, Field, Header};
use super::lzf;

/// The bytes of all points.
pub(super) struct Table<'a> {
    bytes: Cow<'a, [u8]>,
    points: usize,
    layout: Layout,
}

#[derive(Clone, Copy)]
enum Layout {
    /// One point after the other, each of so many bytes.
    Records { stride: usize },
    /// One whole field after the other.
    Planes,
}

/// The values of one field.
#[derive(Clone, Copy)]
pub(super) struct Column<'a> {
    pub(super) field: &'a Field<'a>,
    bytes: &'a [u8],
    step: usize,
    points: usize,
}

impl<'a> Table<'a> {
    /// Takes the points out of the bytes after the header. Text is decoded only where `is_used` says so.
    pub(super) fn read(
        header: &Header<'_>,
        data: &'a [u8],
        is_used: impl Fn(&Field<'_>) -> bool,
    ) -> Result<Self, PcdError> {
        let records = Layout::Records { stride: header.stride() };
        let (bytes, layout) = match header.encoding {
            Encoding::Ascii => (Cow::Owned(ascii::records(header, data, is_used)?), records),
            Encoding::Binary => (Cow::Borrowed(first(data, unpacked_size(header))?), records),
            Encoding::Compressed => (Cow::Owned(decompress(data, unpacked_size(header))?), Layout::Planes),
        };
        Ok(Self { bytes, points: header.points(), layout })
    }

    /// The values of a field of the header that the table was read with.
    pub(super) fn column(&'a self, field: &'a Field<'a>) -> Column<'a> {
        let (start, step) = match self.layout {
            Layout::Records { stride } => (field.offset, stride),
            Layout::Planes => (field.offset * self.points, field.size()),
        };
        Column { field, bytes: &self.bytes[start..], step, points: self.points }
    }
}

impl<'a> Column<'a> {
    /// Number of points.
    pub(super) fn points(&self) -> usize {
        self.points
    }

    /// The first value of every point, of N bytes, decoded.
    pub(super) fn values<const N: usize, T>(
        self,
        decode: impl Fn([u8; N]) -> T + 'a,
    ) -> impl Iterator<Item = T> + 'a {
        let values = self.bytes.chunks(self.step).take(self.points);
        // The table has the bytes of all; nothing is left out, so a list of them knows its length.
        values.map(move |bytes| decode(bytes.first_chunk().copied().unwrap_or([0; N])))
    }
}

fn unpacked_size(header: &Header<'_>) -> usize {
    header.stride().saturating_mul(header.points())
}

/// The first `needed` bytes.
fn first(data: &[u8], needed: usize) -> Result<&[u8], PcdError> {
    data.get(..needed).ok_or(PcdError::TooShort { needed, found: data.len() })
}

/// Two sizes, packed and unpacked, then the packed bytes.
fn decompress(data: &[u8], needed: usize) -> Result<Vec<u8>, PcdError> {
    const SIZES: usize = 8;
    let &[a, b, c, d, e, f, g, h] =
        data.first_chunk::<SIZES>().ok_or(PcdError::TooShort { needed: SIZES, found: data.len() })?;
    let packed = u32::from_le_bytes([a, b, c, d]) as usize;
    let claimed = u32::from_le_bytes([e, f, g, h]) as usize;
    let packed = &first(data, packed.saturating_add(SIZES))?[SIZES..];
    if claimed != needed {
        return Err(PcdError::UnpackedSize { claimed, needed });
    }
    lzf::decompress(packed, needed).map_err(|lzf::Damage { at, problem }| PcdError::Lzf { at, problem })
}
