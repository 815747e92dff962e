//! Arrays of NumPy: the NPY format, versions 1 to 3.
//!
//! A text header says the kind of number and the shape; the numbers follow, row by row. They are read one after the other, so memory is
//! that of what the caller keeps.
//!
//! Source: NumPy Enhancement Proposal 1, and `numpy.lib.format`.

use std::io::{self, Read};

use crate::text::preview;

/// What an NPY file begins with.
pub(crate) const MARK: &[u8] = b"\x93NUMPY";
/// The most bytes of a header; those of arrays of numbers have some hundred.
const MOST_HEADER_BYTES: u32 = 1 << 16;

/// Why bytes are no usable array.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The system, or the archive around it, does not give the bytes.
    #[error("its bytes cannot be read ({0}): copy or write it again")]
    Read(io::Error),
    /// The bytes before the numbers are not those of NumPy.
    #[error("it does not begin as numpy.save writes: {problem}")]
    Header {
        /// What is wrong.
        problem: String,
    },
    /// Numbers of a kind that is not read.
    #[error("its numbers are `{found}`, which are not read: save it as uint8, uint16, float32 or float64")]
    Kind {
        /// How NumPy calls them.
        found: String,
    },
    /// Column by column.
    #[error("it is stored column by column: save numpy.ascontiguousarray of it")]
    FortranOrder,
    /// Fewer numbers than the shape says.
    #[error("it ends after {found} of {promised} numbers: copy or write it again")]
    Cut {
        /// Numbers by the header.
        promised: usize,
        /// Numbers there.
        found: usize,
    },
}

/// A number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Whole(i64),
    Real(f64),
}

impl Number {
    pub(crate) fn as_f64(self) -> f64 {
        match self {
            Self::Whole(number) => number as f64,
            Self::Real(number) => number,
        }
    }

    /// The whole number that is nearest to zero from it.
    pub(crate) fn as_i64(self) -> i64 {
        match self {
            Self::Whole(number) => number,
            Self::Real(number) => number as i64,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Unsigned,
    Signed,
    Real,
}

/// An array of which the numbers are still to be read.
#[derive(Debug)]
pub(crate) struct Array<R> {
    /// Its sides, the slowest first.
    pub(crate) shape: Vec<usize>,
    kind: Kind,
    /// Bytes of a number.
    bytes: usize,
    is_big: bool,
    reader: R,
}

impl<R: Read> Array<R> {
    /// Reads the header.
    pub(crate) fn open(mut reader: R) -> Result<Self, NpyError> {
        let header = |problem: &str| NpyError::Header { problem: problem.to_owned() };
        let mut lead = [0; 8];
        reader.read_exact(&mut lead).map_err(NpyError::Read)?;
        if !lead.starts_with(MARK) {
            return Err(header("it is no NPY file"));
        }
        let length = match lead[6] {
            1 => {
                let mut length = [0; 2];
                reader.read_exact(&mut length).map_err(NpyError::Read)?;
                u16::from_le_bytes(length).into()
            }
            2 | 3 => {
                let mut length = [0; 4];
                reader.read_exact(&mut length).map_err(NpyError::Read)?;
                u32::from_le_bytes(length)
            }
            _ => return Err(header("its version is not 1, 2 or 3")),
        };
        if length > MOST_HEADER_BYTES {
            return Err(header("its header is too long"));
        }
        let mut text = Vec::new();
        reader.by_ref().take(length.into()).read_to_end(&mut text).map_err(NpyError::Read)?;
        let text = String::from_utf8(text).map_err(|_| header("its header is no text"))?;
        let field = |name: &str| {
            let rest = text.split_once(&format!("'{name}':")).map(|(_, rest)| rest.trim_start());
            rest.ok_or_else(|| header(&format!("its header has no {name}")))
        };
        let (kind, bytes, is_big) = kind(field("descr")?)?;
        if !field("fortran_order")?.starts_with("False") {
            return Err(NpyError::FortranOrder);
        }
        let shape = shape(field("shape")?).ok_or_else(|| header("its shape is none"))?;
        Ok(Self { shape, kind, bytes, is_big, reader })
    }

    /// Whether its numbers are whole.
    pub(crate) fn is_whole(&self) -> bool {
        self.kind != Kind::Real
    }

    /// Whether its numbers are bytes.
    pub(crate) fn is_bytes(&self) -> bool {
        (self.kind, self.bytes) == (Kind::Unsigned, 1)
    }

    /// Reads the numbers. The shape is to be bounded before.
    pub(crate) fn read(mut self, mut each: impl FnMut(Number)) -> Result<(), NpyError> {
        let promised = self.shape.iter().fold(1_usize, |product, &side| product.saturating_mul(side));
        let mut found = 0;
        let mut chunk = Vec::new();
        while found < promised {
            let numbers = (promised - found).min(1 << 13);
            chunk.clear();
            let wanted = (numbers * self.bytes) as u64;
            self.reader.by_ref().take(wanted).read_to_end(&mut chunk).map_err(NpyError::Read)?;
            for bytes in chunk.chunks_exact(self.bytes) {
                each(number(bytes, self.kind, self.is_big));
                found += 1;
            }
            if chunk.len() as u64 != wanted {
                return Err(NpyError::Cut { promised, found });
            }
        }
        Ok(())
    }
}

/// The number of these bytes; whole ones that are too large become the greatest.
fn number(bytes: &[u8], kind: Kind, is_big: bool) -> Number {
    let mut wide = [0; 8];
    wide.iter_mut().zip(bytes).for_each(|(wide, &byte)| *wide = byte);
    if is_big {
        wide[..bytes.len()].reverse();
    }
    let bits = u64::from_le_bytes(wide);
    let unused = 64 - 8 * bytes.len() as u32;
    match (kind, bytes.len()) {
        (Kind::Unsigned, _) => Number::Whole(i64::try_from(bits).unwrap_or(i64::MAX)),
        (Kind::Signed, _) => Number::Whole((bits << unused) as i64 >> unused),
        (Kind::Real, 4) => Number::Real(f32::from_bits(bits as u32).into()),
        (Kind::Real, _) => Number::Real(f64::from_bits(bits)),
    }
}

/// Kind, bytes and byte order of the numbers, as in `'<f4'`.
fn kind(text: &str) -> Result<(Kind, usize, bool), NpyError> {
    let found = text.strip_prefix('\'').and_then(|text| text.split_once('\'')).map(|(found, _)| found);
    let unread = || NpyError::Kind { found: preview(found.unwrap_or(text).as_bytes()) };
    let found = found.ok_or_else(unread)?;
    let mut signs = found.chars();
    let (order, kind, bytes) = (signs.next(), signs.next(), signs.as_str());
    let is_big = match order {
        Some('<' | '|') => false,
        Some('>') => true,
        _ => return Err(unread()),
    };
    let (kind, bytes) = match (kind, bytes) {
        (Some('u'), "1" | "2" | "4" | "8") => (Kind::Unsigned, bytes),
        (Some('i'), "1" | "2" | "4" | "8") => (Kind::Signed, bytes),
        (Some('f'), "4" | "8") => (Kind::Real, bytes),
        _ => return Err(unread()),
    };
    Ok((kind, bytes.parse().map_err(|_| unread())?, is_big))
}

/// The sides, as in `(480, 640)`.
fn shape(text: &str) -> Option<Vec<usize>> {
    let (sides, _) = text.strip_prefix('(')?.split_once(')')?;
    sides.split(',').map(str::trim).filter(|side| !side.is_empty()).map(|side| side.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of version 1 with this kind, shape and bytes.
    fn file(kind: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
        [MARK, &[1, 0], &(text.len() as u16).to_le_bytes(), text.as_bytes(), bytes].concat()
    }

    fn read(file: &[u8]) -> Result<Vec<Number>, NpyError> {
        let mut numbers = Vec::new();
        Array::open(file)?.read(|number| numbers.push(number))?;
        Ok(numbers)
    }

    #[test]
    fn every_kind_of_number_is_read() {
        use Number::{Real, Whole};
        for (kind, bytes, numbers) in [
            ("|u1", &[1, 255][..], [Whole(1), Whole(255)]),
            ("|i1", &[1, 255], [Whole(1), Whole(-1)]),
            ("<u2", &[1, 2, 0, 255], [Whole(0x201), Whole(0xff00)]),
            (">u2", &[1, 2, 0, 255], [Whole(0x102), Whole(255)]),
            ("<i4", &[1, 0, 0, 0, 0xfe, 255, 255, 255], [Whole(1), Whole(-2)]),
            (
                "<u8",
                &[1, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255],
                [Whole(1), Whole(i64::MAX)],
            ),
            (">f4", &[0x3f, 0x80, 0, 0, 0xbf, 0, 0, 0], [Real(1.0), Real(-0.5)]),
            ("<f8", &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0], [Real(1.0), Real(0.0)]),
        ] {
            assert_eq!(read(&file(kind, "(2,)", bytes)).unwrap(), numbers, "{kind}");
        }
        let empty = file("<u2", "(480, 640)", &[]);
        let array = Array::open(&empty[..]).unwrap();
        assert_eq!(
            (array.shape.as_slice(), array.is_whole(), array.is_bytes()),
            (&[480, 640][..], true, false)
        );
    }

    #[test]
    fn what_is_wrong_is_told() {
        let told = |file: &[u8]| read(file).unwrap_err().to_string();
        for (kind, said) in
            [("<f2", "`<f2`"), ("<c8", "`<c8`"), ("O", "`O`"), ("|S3", "`|S3`"), ("=f4", "`=f4`")]
        {
            assert!(told(&file(kind, "(1,)", &[0; 8])).contains(said), "{kind}");
        }
        let good = file("<u2", "(2, 3)", &[0; 12]);
        let with = |from: &str, to: &str| {
            let at = good.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
            let mut bytes = good.clone();
            bytes.splice(at..at + from.len(), to.bytes());
            told(&bytes)
        };
        assert!(with("False", "True ").contains("column by column"));
        assert!(with("(2, 3)", "(2, x)").contains("its shape is none"));
        assert!(with("shape", "shale").contains("has no shape"));
        assert!(with("NUMPY\x01", "NUMPY\x07").contains("version"));
        assert!(told(b"PK\x03\x04aaaaaaaa").contains("no NPY file"));
        assert!(told(&good[..good.len() - 3]).contains("it ends after 4 of 6 numbers"));
        assert!(told(&file("<u2", "(4294967296, 4294967296)", &[0; 12])).contains("it ends after 6 of"));
        (0..good.len()).for_each(|end| assert!(read(&good[..end]).is_err(), "cut at {end}"));
    }
}
