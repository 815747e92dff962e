//! The text header: what the fields are, how many points, how they are stored.

use std::str::FromStr;

use objecthood::Raster;

use super::error::PcdError;
use crate::capture::Pose;
use crate::text::preview;

/// The header lines there are; DATA ends the header.
const KEYWORDS: [&str; 10] =
    ["VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA"];

/// A number type of PCD: its TYPE and SIZE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    F4,
    F8,
    U1,
    U2,
    U4,
    U8,
    I1,
    I2,
    I4,
    I8,
}

impl Kind {
    fn new(kind: &str, size: usize) -> Option<Self> {
        Some(match (kind, size) {
            ("F", 4) => Self::F4,
            ("F", 8) => Self::F8,
            ("U", 1) => Self::U1,
            ("U", 2) => Self::U2,
            ("U", 4) => Self::U4,
            ("U", 8) => Self::U8,
            ("I", 1) => Self::I1,
            ("I", 2) => Self::I2,
            ("I", 4) => Self::I4,
            ("I", 8) => Self::I8,
            _ => return None,
        })
    }

    /// What a value is, for whoever does not know the types of PCD.
    pub(super) fn meaning(self) -> String {
        let whole = |least: i128, most: i128| format!("a whole number from {least} to {most}");
        match self {
            Self::F4 | Self::F8 => "a number".to_owned(),
            Self::U1 => whole(0, u8::MAX.into()),
            Self::U2 => whole(0, u16::MAX.into()),
            Self::U4 => whole(0, u32::MAX.into()),
            Self::U8 => whole(0, u64::MAX.into()),
            Self::I1 => whole(i8::MIN.into(), i8::MAX.into()),
            Self::I2 => whole(i16::MIN.into(), i16::MAX.into()),
            Self::I4 => whole(i32::MIN.into(), i32::MAX.into()),
            Self::I8 => whole(i64::MIN.into(), i64::MAX.into()),
        }
    }

    /// Bytes of one value.
    pub(super) fn size(self) -> usize {
        match self {
            Self::U1 | Self::I1 => 1,
            Self::U2 | Self::I2 => 2,
            Self::F4 | Self::U4 | Self::I4 => 4,
            Self::F8 | Self::U8 | Self::I8 => 8,
        }
    }
}

/// One field of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field<'a> {
    pub(super) name: &'a str,
    pub(super) kind: Kind,
    /// Values per point.
    pub(super) count: usize,
    /// Bytes of the fields before it in a point.
    pub(super) offset: usize,
}

impl Field<'_> {
    /// Bytes per point.
    pub(super) fn size(&self) -> usize {
        self.kind.size().saturating_mul(self.count)
    }
}

/// How the points are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary,
    Compressed,
}

/// A consistent header. Its sizes in bytes may still be beyond every file; they saturate rather than overflow.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header<'a> {
    pub(super) fields: Vec<Field<'a>>,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) encoding: Encoding,
    /// Where the sensor was, unless it was in the origin.
    pub(super) viewpoint: Option<Pose>,
    /// Lines of the file up to and including DATA.
    pub(super) lines: usize,
}

impl<'a> Header<'a> {
    /// Splits a file into header and data.
    pub(super) fn parse(bytes: &'a [u8]) -> Result<(Self, &'a [u8]), PcdError> {
        let lines = Lines::collect(bytes)?;
        lines.one_of("VERSION", &[("0.7", ()), (".7", ()), ("0.6", ()), (".6", ())], "0.7 (or 0.6)")?;
        let fields = lines.fields()?;
        let (width, height) = lines.size()?;
        let encodings = [
            ("ascii", Encoding::Ascii),
            ("binary", Encoding::Binary),
            ("binary_compressed", Encoding::Compressed),
        ];
        let viewpoint = lines.viewpoint()?;
        let encoding = lines.one_of("DATA", &encodings, "ascii, binary or binary_compressed")?;
        Ok((Self { fields, width, height, encoding, viewpoint, lines: lines.count }, lines.data))
    }

    /// Number of points.
    pub(super) fn points(&self) -> usize {
        self.width * self.height
    }

    /// Bytes of one point.
    pub(super) fn stride(&self) -> usize {
        self.fields.iter().fold(0, |sum, field| sum.saturating_add(field.size()))
    }
}

/// One header line.
struct Line<'a> {
    number: usize,
    keyword: &'static str,
    values: &'a str,
}

impl Line<'_> {
    fn bad(&self, value: &str, expected: &'static str) -> PcdError {
        let value = preview(value.as_bytes());
        PcdError::BadValue { line: self.number, keyword: self.keyword, value, expected }
    }

    fn numbers<T: FromStr>(&self, expected: &'static str) -> Result<Vec<T>, PcdError> {
        let number = |word: &str| word.parse().map_err(|_| self.bad(word, expected));
        self.values.split_ascii_whitespace().map(number).collect()
    }
}

/// The header lines as they stand in the file, each kind at most once.
struct Lines<'a> {
    lines: Vec<Line<'a>>,
    count: usize,
    data: &'a [u8],
}

impl<'a> Lines<'a> {
    fn collect(bytes: &'a [u8]) -> Result<Self, PcdError> {
        let mut found = Self { lines: Vec::new(), count: 0, data: bytes };
        while !found.data.is_empty() {
            let end = found.data.iter().position(|&b| b == b'\n');
            let (line, rest) =
                end.map_or((found.data, &[][..]), |n| (&found.data[..n], &found.data[n + 1..]));
            found.count += 1;
            found.data = rest;

            let line = line.trim_ascii();
            if line.is_empty() || line.starts_with(b"#") {
                continue;
            }
            if found.add(line)? == "DATA" {
                return Ok(found);
            }
        }
        Err(PcdError::UnfinishedHeader)
    }

    fn add(&mut self, line: &'a [u8]) -> Result<&'static str, PcdError> {
        let number = self.count;
        let unknown = || PcdError::UnknownLine { line: number, content: preview(line) };
        let text = str::from_utf8(line).map_err(|_| unknown())?;
        let (word, values) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
        let keyword = *KEYWORDS.iter().find(|&&keyword| keyword == word).ok_or_else(unknown)?;
        if self.find(keyword).is_some() {
            return Err(PcdError::RepeatedLine { line: number, keyword });
        }
        self.lines.push(Line { number, keyword, values: values.trim_ascii() });
        Ok(keyword)
    }

    fn find(&self, keyword: &str) -> Option<&Line<'a>> {
        self.lines.iter().find(|line| line.keyword == keyword)
    }

    fn get(&self, keyword: &'static str) -> Result<&Line<'a>, PcdError> {
        self.find(keyword).ok_or(PcdError::MissingLine { keyword })
    }

    fn one_of<T: Copy>(
        &self,
        keyword: &'static str,
        choices: &[(&str, T)],
        expected: &'static str,
    ) -> Result<T, PcdError> {
        let line = self.get(keyword)?;
        let choice = choices.iter().find(|(word, _)| *word == line.values);
        choice.map(|&(_, value)| value).ok_or_else(|| line.bad(line.values, expected))
    }

    fn number(&self, keyword: &'static str) -> Result<u64, PcdError> {
        let line = self.get(keyword)?;
        line.values.parse().map_err(|_| line.bad(line.values, "one whole number"))
    }

    /// Columns and rows.
    fn size(&self) -> Result<(usize, usize), PcdError> {
        let (width, height) = (self.number("WIDTH")?, self.number("HEIGHT")?);
        let points = self.number("POINTS")?;
        if width == 0 || height == 0 {
            return Err(PcdError::NoPoints { width, height });
        }
        if width.checked_mul(height) != Some(points) {
            return Err(PcdError::PointCount { width, height, points });
        }
        if points > Raster::<f32>::MAX_PIXELS as u64 {
            return Err(PcdError::TooManyPoints { points });
        }
        // Neither is greater than their product, which is small.
        Ok((width as usize, height as usize))
    }

    /// Where the sensor was. A rotation without a length, as some programs write, is none.
    fn viewpoint(&self) -> Result<Option<Pose>, PcdError> {
        const SEVEN: &str = "seven numbers, a position and a quaternion: tx ty tz qw qx qy qz";
        let Some(line) = self.find("VIEWPOINT") else { return Ok(None) };
        let numbers: Vec<f64> = line.numbers(SEVEN)?;
        let &[tx, ty, tz, qw, qx, qy, qz] = numbers.as_slice() else {
            return Err(line.bad(line.values, SEVEN));
        };
        let length = [qw, qx, qy, qz].iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(numbers.iter().all(|number| number.is_finite()) && length.is_finite()) {
            return Err(line.bad(line.values, SEVEN));
        }
        let rotation_xyzw =
            if length > 0.0 { [qx, qy, qz, qw].map(|part| part / length) } else { [0.0, 0.0, 0.0, 1.0] };
        let pose = Pose { position_m: [tx, ty, tz], rotation_xyzw };
        Ok((pose != Pose::ORIGIN).then_some(pose))
    }

    fn fields(&self) -> Result<Vec<Field<'a>>, PcdError> {
        let names: Vec<&'a str> = self.get("FIELDS")?.values.split_ascii_whitespace().collect();
        let sizes: Vec<usize> = self.get("SIZE")?.numbers("one size in bytes per field")?;
        let kinds: Vec<&str> = self.get("TYPE")?.values.split_ascii_whitespace().collect();
        let counts = match self.find("COUNT") {
            Some(line) => line.numbers("one number of values per field")?,
            None => vec![1; names.len()],
        };
        for (keyword, entries) in [("SIZE", sizes.len()), ("TYPE", kinds.len()), ("COUNT", counts.len())] {
            if entries != names.len() {
                return Err(PcdError::ListLength { keyword, entries, fields: names.len() });
            }
        }
        if let (Some(line), true) = (self.find("COUNT"), counts.contains(&0)) {
            return Err(line.bad("0", "at least one value per field"));
        }
        check_names(&names)?;

        let mut offset = 0_usize;
        let mut fields = Vec::with_capacity(names.len());
        for (((name, kind), size), count) in names.into_iter().zip(kinds).zip(sizes).zip(counts) {
            let contradiction = || PcdError::TypeSize {
                field: preview(name.as_bytes()),
                kind: preview(kind.as_bytes()),
                size,
            };
            let kind = Kind::new(kind, size).ok_or_else(contradiction)?;
            let field = Field { name, kind, count, offset };
            offset = offset.saturating_add(field.size());
            fields.push(field);
        }
        Ok(fields)
    }
}

/// No name twice, save `_`, with which the Point Cloud Library names padding.
fn check_names(names: &[&str]) -> Result<(), PcdError> {
    let mut sorted: Vec<&str> = names.iter().copied().filter(|&name| name != "_").collect();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(PcdError::DuplicateField { field: preview(pair[0].as_bytes()) }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "# .PCD v0.7\nVERSION 0.7\nFIELDS label x y z rgba\nSIZE 4 4 4 4 4\nTYPE U F F F U\n\
        COUNT 1 1 1 1 1\nWIDTH 3\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6\nDATA binary\n";

    fn parse(text: &str) -> Result<Header<'_>, PcdError> {
        Header::parse(text.as_bytes()).map(|(header, _)| header)
    }

    #[test]
    fn fields_lie_one_after_the_other() {
        let header = parse(GOOD).unwrap();
        assert_eq!(
            header.fields.iter().map(|f| (f.name, f.offset)).collect::<Vec<_>>(),
            [("label", 0), ("x", 4), ("y", 8), ("z", 12), ("rgba", 16)]
        );
        assert_eq!((header.stride(), header.points(), header.lines), (20, 6, 11));
    }

    #[test]
    fn line_ends_comments_and_order_do_not_matter() {
        let good = parse(GOOD).unwrap();
        for same in [
            GOOD.replace('\n', "\r\n"),
            GOOD.replace("COUNT 1 1 1 1 1\n", ""),
            GOOD.replace("VIEWPOINT 0 0 0 1 0 0 0\n", "\n# comment\n"),
            GOOD.replace("VERSION 0.7", "VERSION .7"),
            GOOD.replace("VERSION 0.7", "VERSION 0.6"),
            GOOD.replace("WIDTH 3\nHEIGHT 2", "HEIGHT  2 \nWIDTH\t3"),
        ] {
            let header = parse(&same).unwrap();
            assert_eq!(Header { lines: good.lines, ..header }, good, "{same}");
        }
    }

    #[test]
    fn the_viewpoint_is_a_position_and_a_rotation() {
        let viewpoint = |numbers: &str| parse(&GOOD.replace("0 0 0 1 0 0 0", numbers)).unwrap().viewpoint;
        assert_eq!(viewpoint("0 0 0 1 0 0 0"), None);
        assert_eq!(viewpoint("0 0 0 0 0 0 0"), None);
        let turned = Pose { position_m: [1.0, 0.0, -2.0], rotation_xyzw: [1.0, 0.0, 0.0, 0.0] };
        assert_eq!(viewpoint("1 0 -2 0 2 0 0"), Some(turned));
    }

    #[test]
    fn the_data_begin_after_the_line_end() {
        for (end, data) in [("DATA binary\r\n\n#", "\n#"), ("DATA binary\n", ""), ("DATA binary", "")] {
            let text = GOOD.replace("DATA binary\n", end);
            assert_eq!(Header::parse(text.as_bytes()).unwrap().1, data.as_bytes());
        }
    }

    #[test]
    fn every_contradiction_is_told() {
        for (from, to, said) in [
            ("VERSION 0.7", "VERSION 0.5", "line 2 of the PCD header has VERSION `0.5`: expected 0.7"),
            ("VERSION 0.7\n", "", "no VERSION line"),
            ("FIELDS", "FIELD", "line 3 of the PCD header is `FIELD label x y z rgba`"),
            ("COUNT 1 1 1 1 1", "SIZE 4", "line 6 of the PCD header is a second SIZE line"),
            ("SIZE 4 4 4 4 4", "SIZE 4 4 4 4", "names 5 FIELDS but has 4 entries in SIZE"),
            ("TYPE U F F F U", "TYPE U F F F U F", "6 entries in TYPE"),
            ("COUNT 1 1 1 1 1", "COUNT", "0 entries in COUNT"),
            ("COUNT 1 1 1 1 1", "COUNT 1 1 1 1 0", "at least one value per field"),
            ("SIZE 4 4 4 4 4", "SIZE 4 4 4 4 -4", "SIZE `-4`"),
            ("SIZE 4 4 4 4 4", "SIZE 4 2 4 4 4", "field x has TYPE F with SIZE 2"),
            ("SIZE 4 4 4 4 4", "SIZE 3 4 4 4 4", "field label has TYPE U with SIZE 3"),
            ("TYPE U F F F U", "TYPE U D F F U", "field x has TYPE D"),
            ("FIELDS label x y z rgba", "FIELDS label x y z z", "names field z twice"),
            ("WIDTH 3", "WIDTH 0", "WIDTH 0 and HEIGHT 2"),
            ("WIDTH 3", "WIDTH -3", "WIDTH `-3`: expected one whole number"),
            ("WIDTH 3", "WIDTH 3 3", "WIDTH `3 3`"),
            ("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0 0 1 0 0", "expected seven numbers"),
            ("VIEWPOINT 0 0 0 1 0 0 0", "VIEWPOINT 0 0 nan 1 0 0 0", "expected seven numbers"),
            ("POINTS 6", "POINTS 7", "POINTS 7 but WIDTH 3 times HEIGHT 2"),
            ("POINTS 6\n", "", "no POINTS line"),
            ("DATA binary", "DATA bin", "expected ascii, binary or binary_compressed"),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let message = parse(&GOOD.replace(from, to)).unwrap_err().to_string();
            assert!(message.contains(said), "{to}: {message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn claims_beyond_every_image_are_refused() {
        let huge = GOOD.replace("WIDTH 3", "WIDTH 4294967295").replace("HEIGHT 2", "HEIGHT 4294967295");
        let huge = huge.replace("POINTS 6", "POINTS 18446744065119617025");
        assert!(matches!(parse(&huge), Err(PcdError::TooManyPoints { .. })));
        let overflow = GOOD.replace("WIDTH 3", "WIDTH 18446744073709551615");
        assert!(matches!(parse(&overflow), Err(PcdError::PointCount { .. })));
        let wide = GOOD.replace("COUNT 1 1 1 1 1", "COUNT 18446744073709551615 1 1 1 18446744073709551615");
        assert_eq!(parse(&wide).unwrap().stride(), usize::MAX);
    }

    #[test]
    fn padding_may_have_one_name() {
        let padded = GOOD.replace("FIELDS label x y z rgba", "FIELDS _ x y z _");
        assert_eq!(parse(&padded).unwrap().fields.len(), 5);
    }

    #[test]
    fn a_header_cut_anywhere_is_told() {
        for end in 0..GOOD.len() - "ary\n".len() {
            assert!(Header::parse(&GOOD.as_bytes()[..end]).is_err(), "cut at {end}");
        }
    }
}
