//! What can be wrong with a PLY file.

/// Why bytes are no usable PLY file: what is wrong, where, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlyError {
    /// The file ends within the header.
    #[error(
        "the PLY header ends without an `end_header` line: the file is truncated, copy or record it again"
    )]
    UnfinishedHeader,
    /// A header line that says nothing, or something else than may stand there.
    #[error("line {line} of the PLY header is `{content}`: expected {expected}")]
    BadLine {
        /// Line of the file, from 1.
        line: usize,
        /// How the line begins.
        content: String,
        /// What may stand there.
        expected: &'static str,
    },
    /// A property of a type that PLY does not have.
    #[error("line {line} of the PLY header has the type `{found}`: expected {expected}")]
    BadType {
        /// Line of the file, from 1.
        line: usize,
        /// What was found.
        found: String,
        /// Types that may stand there.
        expected: &'static str,
    },
    /// Two header lines of which there is one.
    #[error("line {line} of the PLY header is a second `{keyword}` line: keep one")]
    RepeatedLine {
        /// Line of the file, from 1.
        line: usize,
        /// How the line begins.
        keyword: &'static str,
    },
    /// Two properties of one name.
    #[error(
        "line {line} of the PLY header is a second property {property} of the vertices: rename or remove one"
    )]
    RepeatedProperty {
        /// Line of the file, from 1.
        line: usize,
        /// Name of the properties.
        property: String,
    },
    /// A header line is missing.
    #[error("the PLY header has no `{keyword}` line: add one, such as `{example}`")]
    MissingLine {
        /// How the missing line begins.
        keyword: &'static str,
        /// The line as it may be.
        example: &'static str,
    },
    /// A coordinate or a part of the colour is missing.
    #[error(
        "the vertices of the PLY file have no property {property}: save them with x, y and z, and with red, green and blue or without colours"
    )]
    MissingProperty {
        /// Name of the property.
        property: &'static str,
    },
    /// A coordinate or a part of the colour is a list.
    #[error("property {property} is a list: save it as one number")]
    ListProperty {
        /// Name of the property.
        property: &'static str,
    },
    /// A cloud without points.
    #[error("the PLY header says 0 vertices: a cloud has at least one point; record it again")]
    NoVertices,
    /// More points than a frame can have pixels.
    #[error("the PLY header says {vertices} vertices: at most 2^28 are read; crop or thin out the cloud")]
    TooManyVertices {
        /// Vertices.
        vertices: u64,
    },
    /// Less data than the header promises.
    #[error(
        "the PLY header promises at least {needed} bytes behind it but {found} are there: the file is truncated or the header wrong; copy or record it again"
    )]
    TooShort {
        /// Bytes promised.
        needed: usize,
        /// Bytes there.
        found: usize,
    },
    /// A line that is no vertex.
    #[error("line {line} of the PLY file is no vertex: {problem}; correct the line")]
    BadVertex {
        /// Line of the file, from 1.
        line: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Numbers that are no vertex.
    #[error(
        "vertex {vertex} of the PLY file is none: {problem}; the file is damaged, copy or record it again"
    )]
    BadBinaryVertex {
        /// Which vertex, from 0.
        vertex: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// Fewer vertices than the header says.
    #[error(
        "the PLY header says {promised} vertices but {found} of them are there: the file is truncated or the header wrong; copy or record it again"
    )]
    MissingVertices {
        /// Vertices by the header.
        promised: usize,
        /// Vertices there.
        found: usize,
    },
}
