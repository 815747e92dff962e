//! What can be wrong with a PCD file.

/// Why bytes are no usable PCD file: what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PcdError {
    /// The file ends within the header.
    #[error("the PCD header ends without a DATA line: the file is truncated, copy or record it again")]
    UnfinishedHeader,
    /// A line that does not belong into a header.
    #[error(
        "line {line} of the PCD header is `{content}`: expected one of VERSION FIELDS SIZE TYPE COUNT WIDTH HEIGHT VIEWPOINT POINTS DATA; is it a PCD file?"
    )]
    UnknownLine {
        /// Line of the file, from 1.
        line: usize,
        /// How the line begins.
        content: String,
    },
    /// Two header lines of the same kind.
    #[error("line {line} of the PCD header is a second {keyword} line: keep one")]
    RepeatedLine {
        /// Line of the file, from 1.
        line: usize,
        /// First word of the line.
        keyword: &'static str,
    },
    /// A header line is missing.
    #[error("the PCD header has no {keyword} line: add it")]
    MissingLine {
        /// First word of the missing line.
        keyword: &'static str,
    },
    /// A header line with a value that it cannot have.
    #[error("line {line} of the PCD header has {keyword} `{value}`: expected {expected}")]
    BadValue {
        /// Line of the file, from 1.
        line: usize,
        /// First word of the line.
        keyword: &'static str,
        /// What was found.
        value: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// SIZE, TYPE or COUNT that does not match FIELDS.
    #[error(
        "the PCD header names {fields} FIELDS but has {entries} entries in {keyword}: give one per field"
    )]
    ListLength {
        /// First word of the line.
        keyword: &'static str,
        /// Its entries.
        entries: usize,
        /// Fields named.
        fields: usize,
    },
    /// A TYPE that does not come in that SIZE.
    #[error(
        "field {field} has TYPE {kind} with SIZE {size}: F has size 4 or 8, U and I have 1, 2, 4 or 8; correct the header"
    )]
    TypeSize {
        /// Name of the field.
        field: String,
        /// Its TYPE.
        kind: String,
        /// Its SIZE in bytes.
        size: usize,
    },
    /// A field of a type that its meaning does not allow.
    #[error("field {field} is {found}: it must be {needed} with COUNT 1; save the cloud so")]
    UnusableField {
        /// Name of the field.
        field: String,
        /// TYPE, SIZE and COUNT found.
        found: String,
        /// TYPE and SIZE needed.
        needed: &'static str,
    },
    /// A coordinate is missing.
    #[error("the PCD file has no field {field}: save the cloud with fields x, y and z")]
    MissingField {
        /// Name of the field.
        field: &'static str,
    },
    /// Two fields of one name.
    #[error("the PCD header names field {field} twice: rename or remove one")]
    DuplicateField {
        /// Name of the fields.
        field: String,
    },
    /// Both `rgb` and `rgba`.
    #[error("the PCD file has both a field rgb and a field rgba: save it with one of them")]
    TwoColors,
    /// A cloud without points.
    #[error(
        "the PCD header says WIDTH {width} and HEIGHT {height}: a cloud has at least one point; record it again"
    )]
    NoPoints {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// POINTS is not WIDTH times HEIGHT.
    #[error(
        "the PCD header says POINTS {points} but WIDTH {width} times HEIGHT {height}: correct the wrong one"
    )]
    PointCount {
        /// Columns.
        width: u64,
        /// Rows.
        height: u64,
        /// Points.
        points: u64,
    },
    /// More points than a frame can have pixels.
    #[error("the PCD header says {points} points: at most 2^28 are read; crop or thin out the cloud")]
    TooManyPoints {
        /// Points.
        points: u64,
    },
    /// Less data than the header promises.
    #[error(
        "the PCD header promises at least {needed} bytes of points but {found} are there: the file is truncated or the header wrong; copy or record it again"
    )]
    TooShort {
        /// Bytes promised.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// Compressed data that stand for another number of bytes than the header.
    #[error(
        "the compressed points are said to unpack to {claimed} bytes but the PCD header needs {needed}: the file is damaged, copy or record it again"
    )]
    UnpackedSize {
        /// Bytes by the compressed data.
        claimed: usize,
        /// Bytes by the header.
        needed: usize,
    },
    /// Compressed data that cannot be unpacked.
    #[error(
        "the compressed points are damaged at their byte {at} ({problem}): copy or record the file again"
    )]
    Lzf {
        /// Byte of the compressed data.
        at: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// A text line that is no point.
    #[error("line {line} of the PCD file is no point: {problem}; correct or remove the point")]
    BadPoint {
        /// Line of the file, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Fewer text lines than POINTS.
    #[error(
        "the PCD header says {promised} points but {found} lines of points are there: the file is truncated or the header wrong; copy or record it again"
    )]
    MissingPoints {
        /// Points by the header.
        promised: usize,
        /// Lines there.
        found: usize,
    },
    /// A label that no label image can hold.
    #[error("field label holds a value above 4294967295: number the labels anew")]
    LabelTooLarge,
}
