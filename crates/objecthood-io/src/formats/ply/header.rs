//! The text header: how many vertices there are, and which properties they have.

use std::collections::BTreeSet;

use objecthood::Raster;

use super::error::PlyError;
use crate::text::Lines;
use crate::text::preview;

/// The element that holds the points.
const VERTEX: &str = "vertex";

/// Lines that stand in a header once, as messages name them.
const FORMAT: &str = "format";
const ELEMENT_VERTEX: &str = "element vertex";

/// A number type of PLY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Float,
    Double,
}

impl Kind {
    fn new(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Char,
            "uchar" | "uint8" => Self::UChar,
            "short" | "int16" => Self::Short,
            "ushort" | "uint16" => Self::UShort,
            "int" | "int32" => Self::Int,
            "uint" | "uint32" => Self::UInt,
            "float" | "float32" => Self::Float,
            "double" | "float64" => Self::Double,
            _ => return None,
        })
    }

    /// Whether its values are whole numbers.
    pub(super) fn is_whole(self) -> bool {
        !matches!(self, Self::Float | Self::Double)
    }

    /// The number that a word spells; `None` if it is not of this type. Every value of every type is an `f64` too.
    pub(super) fn number(self, word: &str) -> Option<f64> {
        match self {
            Self::Char => word.parse::<i8>().ok().map(f64::from),
            Self::UChar => word.parse::<u8>().ok().map(f64::from),
            Self::Short => word.parse::<i16>().ok().map(f64::from),
            Self::UShort => word.parse::<u16>().ok().map(f64::from),
            Self::Int => word.parse::<i32>().ok().map(f64::from),
            Self::UInt => word.parse::<u32>().ok().map(f64::from),
            Self::Float => word.parse::<f32>().ok().map(f64::from),
            Self::Double => word.parse().ok(),
        }
    }

    /// Bytes of a value in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The type and what a value of it is, for whoever does not know the types of PLY.
    pub(super) fn meaning(self) -> &'static str {
        match self {
            Self::Char => "char (a whole number from -128 to 127)",
            Self::UChar => "uchar (a whole number from 0 to 255)",
            Self::Short => "short (a whole number from -32768 to 32767)",
            Self::UShort => "ushort (a whole number from 0 to 65535)",
            Self::Int => "int (a whole number from -2147483648 to 2147483647)",
            Self::UInt => "uint (a whole number from 0 to 4294967295)",
            Self::Float => "float (a number)",
            Self::Double => "double (a number)",
        }
    }
}

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As text, an element on a line.
    Ascii,
    LittleEndian,
    BigEndian,
}

impl Encoding {
    fn new(name: &str) -> Option<Self> {
        Some(match name {
            "ascii" => Self::Ascii,
            "binary_little_endian" => Self::LittleEndian,
            "binary_big_endian" => Self::BigEndian,
            _ => return None,
        })
    }
}

/// How many numbers a property has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// One.
    Scalar(Kind),
    /// Its first number, a whole one, says how many follow.
    List { length: Kind, value: Kind },
}

/// One property of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Property<'a> {
    pub(super) name: &'a str,
    pub(super) shape: Shape,
}

/// Elements that stand before the vertices.
#[derive(Debug)]
pub(super) struct Others {
    /// How many there are.
    pub(super) count: usize,
    /// The properties of each.
    pub(super) shapes: Vec<Shape>,
}

/// What the header says of the vertices, and of what stands before them.
#[derive(Debug)]
pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    /// Number of vertices.
    pub(super) vertices: usize,
    /// Their properties, in the order of the values.
    pub(super) properties: Vec<Property<'a>>,
    pub(super) before: Vec<Others>,
    /// Columns and rows of the image that the vertices are the pixels of, if that is said.
    pub(super) grid: Option<(usize, usize)>,
}

impl Header<'_> {
    /// In a text, lines before the first vertex. What has no property has no line.
    pub(super) fn lines_before(&self) -> usize {
        let with_lines = self.before.iter().filter(|others| !others.shapes.is_empty());
        with_lines.fold(0, |lines, others| lines.saturating_add(others.count))
    }
}

/// The element that a `property` line belongs to.
enum Element {
    Vertex,
    /// An element before the vertices, the last of them.
    Before,
    Behind,
}

/// What was read so far.
#[derive(Default)]
struct Reading<'a> {
    encoding: Option<Encoding>,
    element: Option<Element>,
    vertices: Option<u64>,
    properties: Vec<Property<'a>>,
    names: BTreeSet<&'a str>,
    before: Vec<Others>,
    columns: Option<usize>,
    rows: Option<usize>,
}

impl<'a> Header<'a> {
    /// Takes the header off the lines of a file.
    pub(super) fn parse(lines: &mut Lines<'a>) -> Result<Self, PlyError> {
        let (number, line) = lines.next().ok_or(PlyError::UnfinishedHeader)?;
        if line != b"ply" {
            let expected = "`ply` alone on a line that ends with a line feed";
            return Err(bad_line(number, line, expected));
        }
        let mut reading = Reading::default();
        for (number, line) in lines {
            if reading.take(number, line)? {
                return reading.finish();
            }
        }
        Err(PlyError::UnfinishedHeader)
    }
}

impl<'a> Reading<'a> {
    /// Takes a line; says whether it is the last one.
    fn take(&mut self, number: usize, line: &'a [u8]) -> Result<bool, PlyError> {
        const KEYWORDS: &str = "one of `format`, `comment`, `obj_info`, `element`, `property` and `end_header`; is it a PLY file?";
        let first = line.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        // Comments are in any encoding.
        if first == b"comment" {
            return Ok(false);
        }
        if first == b"obj_info" {
            self.info(line);
            return Ok(false);
        }
        let bad = |expected| bad_line(number, line, expected);
        let text = str::from_utf8(line).map_err(|_| bad(KEYWORDS))?;
        let mut words = text.split_ascii_whitespace().skip(1);
        // One word more than any line has.
        let words: [Option<&'a str>; 5] = std::array::from_fn(|_| words.next());
        match first {
            b"format" => {
                const ENCODING: &str =
                    "`format`, one of ascii, binary_little_endian and binary_big_endian, and `1.0`";
                let [Some(encoding), Some("1.0"), None, ..] = words else { return Err(bad(ENCODING)) };
                let encoding = Encoding::new(encoding).ok_or_else(|| bad(ENCODING))?;
                if self.encoding.replace(encoding).is_some() {
                    return Err(PlyError::RepeatedLine { line: number, keyword: FORMAT });
                }
            }
            b"element" => {
                const ELEMENT: &str = "`element`, a name and how many there are";
                let [Some(name), Some(count), None, ..] = words else { return Err(bad(ELEMENT)) };
                self.element = Some(self.element(number, name, count.parse().map_err(|_| bad(ELEMENT))?)?);
            }
            b"property" => match self.element {
                None => return Err(bad("an `element` line before it")),
                Some(Element::Vertex) => {
                    let property = property(number, line, words)?;
                    if !self.names.insert(property.name) {
                        let property = preview(property.name.as_bytes());
                        return Err(PlyError::RepeatedProperty { line: number, property });
                    }
                    self.properties.push(property);
                }
                Some(Element::Before) => {
                    let shape = property(number, line, words)?.shape;
                    self.before.iter_mut().last().into_iter().for_each(|others| others.shapes.push(shape));
                }
                Some(Element::Behind) => {}
            },
            b"end_header" => return Ok(true),
            _ => return Err(bad(KEYWORDS)),
        }
        Ok(false)
    }

    fn element(&mut self, line: usize, name: &str, count: u64) -> Result<Element, PlyError> {
        match (name == VERTEX, self.vertices) {
            (true, Some(_)) => Err(PlyError::RepeatedLine { line, keyword: ELEMENT_VERTEX }),
            (true, None) => {
                self.vertices = Some(count);
                Ok(Element::Vertex)
            }
            (false, None) => {
                let count = usize::try_from(count).unwrap_or(usize::MAX);
                self.before.push(Others { count, shapes: Vec::new() });
                Ok(Element::Before)
            }
            (false, Some(_)) => Ok(Element::Behind),
        }
    }

    /// Notes the size of the image, which scanners write so. Whatever else such lines say is for people.
    fn info(&mut self, line: &[u8]) {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).skip(1);
        let (name, number) = (words.next(), words.next());
        let number = || str::from_utf8(number?).ok()?.parse().ok();
        match name {
            Some(b"num_cols") => self.columns = number(),
            Some(b"num_rows") => self.rows = number(),
            _ => {}
        }
    }

    fn finish(self) -> Result<Header<'a>, PlyError> {
        let missing = PlyError::MissingLine { keyword: FORMAT, example: "format ascii 1.0" };
        let encoding = self.encoding.ok_or(missing)?;
        let missing = PlyError::MissingLine { keyword: ELEMENT_VERTEX, example: "element vertex 1000" };
        let vertices = self.vertices.ok_or(missing)?;
        if vertices == 0 {
            return Err(PlyError::NoVertices);
        }
        if vertices > Raster::<f32>::MAX_PIXELS as u64 {
            return Err(PlyError::TooManyVertices { vertices });
        }
        let grid = self.columns.zip(self.rows);
        let Self { properties, before, .. } = self;
        Ok(Header { encoding, vertices: vertices as usize, properties, before, grid })
    }
}

/// What a `property` line says.
fn property<'a>(number: usize, line: &[u8], words: [Option<&'a str>; 5]) -> Result<Property<'a>, PlyError> {
    const ANY: &str = "a type of PLY: char, uchar, short, ushort, int, uint, float or double";
    const WHOLE: &str = "a whole-number type of PLY: char, uchar, short, ushort, int or uint";
    let kind = |word: &str, expected, allowed: fn(Kind) -> bool| {
        let unknown = || PlyError::BadType { line: number, found: preview(word.as_bytes()), expected };
        Kind::new(word).filter(|&kind| allowed(kind)).ok_or_else(unknown)
    };
    let (name, shape) = match words {
        [Some("list"), Some(length), Some(value), Some(name), None] => {
            let length = kind(length, WHOLE, Kind::is_whole)?;
            (name, Shape::List { length, value: kind(value, ANY, |_| true)? })
        }
        [Some("list"), ..] => {
            return Err(bad_line(number, line, "`property list`, two types and a name"));
        }
        [Some(word), Some(name), None, ..] => (name, Shape::Scalar(kind(word, ANY, |_| true)?)),
        _ => return Err(bad_line(number, line, "`property`, a type and a name")),
    };
    Ok(Property { name, shape })
}

fn bad_line(line: usize, content: &[u8], expected: &'static str) -> PlyError {
    PlyError::BadLine { line, content: preview(content), expected }
}
