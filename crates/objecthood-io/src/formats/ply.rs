//! Polygon files (PLY 1.0), of which the vertices are read as a point cloud.
//!
//! A text header names the elements of the file, how many of each there are, and their properties with their types. The
//! elements follow in the order of the header, as text, one a line, or as binary numbers of either byte order.
//!
//! | property of `vertex` | type | use |
//! |---|---|---|
//! | `x`, `y`, `z` | any | the point in the camera frame, metres; not finite = none |
//! | `red`, `green`, `blue` | whole numbers | 0 to 255 |
//! | the same | `float` or `double` | 0 to 1 |
//!
//! Properties stand in any order; others are skipped, lists too. Other elements, such as faces, are skipped, before the
//! vertices and behind them. Whatever follows the last vertex is not looked at. The format itself does not say whether the points
//! lie on a pixel grid. Where lines `obj_info num_cols` and `obj_info num_rows` do, as scanners write them, and there are so many
//! vertices, the cloud is organized; else it is a list.
//!
//! Source: Greg Turk, *The PLY Polygon File Format*, 1994; its names of types, and those of later writers with the number
//! of bits (`float32`). The range of colours that are not whole numbers is what Assimp reads.

mod binary;
mod error;
mod header;
mod points;

pub use error::PlyError;

use crate::text::Lines;
use header::{Encoding, Header, Property, Shape};
use points::Role;

use super::{Format, FrameFormat, organized};
use crate::cloud::PointCloud;
use crate::text::without_byte_order_mark;

pub(super) const FORMAT: Format = Format::Frame(FrameFormat {
    extensions: &["ply"],
    is_mine: is_ply,
    is_metric: true,
    decode: |bytes, given| organized(parse(bytes), given),
});

/// The properties that are used.
const AXES: [&str; 3] = ["x", "y", "z"];
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Whether the first word of a file is `ply`.
fn is_ply(head: &[u8]) -> bool {
    let rest = without_byte_order_mark(head).strip_prefix(b"ply");
    rest.is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// Reads the content of a PLY file.
///
/// O(bytes) time. Memory is bounded by the bytes that are there, never by what the header claims: a few for each byte.
///
/// # Errors
/// [`PlyError`]: what breaks the format, where, and what to do.
pub fn parse(bytes: &[u8]) -> Result<PointCloud, PlyError> {
    let mut lines = Lines::of(without_byte_order_mark(bytes));
    let header = Header::parse(&mut lines)?;
    let roles = roles(&header.properties)?;
    let (points_m, color) = match header.encoding {
        Encoding::Ascii => points::read(&header, &roles, lines)?,
        Encoding::LittleEndian | Encoding::BigEndian => binary::read(&header, &roles, lines.rest())?,
    };
    let is_of = |&(columns, rows): &(usize, usize)| columns.checked_mul(rows) == Some(points_m.len());
    let (width, height) = header.grid.filter(is_of).unwrap_or((points_m.len(), 1));
    Ok(PointCloud { width, height, points_m, color, label: None, viewpoint: None })
}

/// What each property is used for.
fn roles(properties: &[Property<'_>]) -> Result<Vec<Role>, PlyError> {
    let has = |name: &str| properties.iter().any(|property| property.name == name);
    if let Some(missing) = AXES.into_iter().find(|axis| !has(axis)) {
        return Err(PlyError::MissingProperty { property: missing });
    }
    if CHANNELS.into_iter().any(has)
        && let Some(missing) = CHANNELS.into_iter().find(|channel| !has(channel))
    {
        return Err(PlyError::MissingProperty { property: missing });
    }
    properties.iter().map(role).collect()
}

fn role(property: &Property<'_>) -> Result<Role, PlyError> {
    let place = |names: [&'static str; 3]| names.iter().position(|&name| name == property.name);
    let (role, name) = match (place(AXES), place(CHANNELS)) {
        (Some(axis), _) => (Role::Axis(axis), AXES[axis]),
        (_, Some(channel)) => (Role::Channel(channel), CHANNELS[channel]),
        (None, None) => return Ok(Role::Unused),
    };
    match property.shape {
        Shape::Scalar(_) => Ok(role),
        Shape::List { .. } => Err(PlyError::ListProperty { property: name }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 2\nproperty uchar blue\n\
        property float x\nproperty double y\nproperty short z\nproperty uchar red\nproperty uchar green\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n3 0.5 0.25 1 1 2\n6 -1e-1 nan 2 4 5\n3 0 1 0\n";

    fn with(from: &str, to: &str) -> Result<PointCloud, PlyError> {
        assert!(GOOD.contains(from), "{from}");
        parse(GOOD.replace(from, to).as_bytes())
    }

    /// NaN equals nothing, so that the clouds are compared as text.
    fn text(cloud: Result<PointCloud, PlyError>) -> String {
        format!("{:?}", cloud.unwrap())
    }

    #[test]
    fn vertices_are_points_with_colours() {
        let cloud = parse(GOOD.as_bytes()).unwrap();
        assert_eq!((cloud.width, cloud.height), (2, 1));
        assert_eq!(cloud.points_m[0], [0.5, 0.25, 1.0]);
        let [x, y, z] = cloud.points_m[1];
        assert!(x == -0.1 && y.is_nan() && z == 2.0);
        assert_eq!(cloud.color, Some(vec![[1, 2, 3], [4, 5, 6]]));
        assert_eq!(cloud.label, None);
    }

    #[test]
    fn what_says_the_same_is_read_alike() {
        let good = text(parse(GOOD.as_bytes()));
        let marked = format!("\u{feff}{GOOD}");
        assert_eq!(text(parse(marked.as_bytes())), good);
        for (from, to) in [
            ("\n", "\r\n"),
            ("\n", " \n\n"),
            ("comment made by hand\n", ""),
            ("comment made by hand", "obj_info a scan\ncomment\nobj_info"),
            ("format ascii 1.0", "format\tascii  1.0"),
            ("3 0 1 0\n", ""),
            ("3 0 1 0\n", "no face at all \u{fe}\n"),
            ("property list uchar int vertex_indices", "property int64 whatever"),
            ("property float x", "property float32 x"),
            ("property double y", "property float64 y"),
            ("property short z", "property int8 z"),
            ("uchar red", "uint red"),
            (
                "comment made by hand\n",
                "element camera 2\nproperty int width\nelement note 7\nelement none 0\nproperty int n\n",
            ),
        ] {
            let camera = to.contains("camera");
            let changed = GOOD.replace(from, to);
            let changed =
                if camera { changed.replace("end_header\n", "end_header\n640\n480\n") } else { changed };
            assert_eq!(text(parse(changed.as_bytes())), good, "{to}");
        }
        let latin1 = [b"ply\ncomment caf\xe9\n".as_slice(), &GOOD.as_bytes()["ply\n".len()..]].concat();
        assert_eq!(text(parse(&latin1)), good);
        let list = GOOD.replace("property float x", "property list uchar int near\nproperty float x");
        let list = list.replace("3 0.5", "3 2 7 8 0.5").replace("6 -1e-1", "6 0 -1e-1");
        assert_eq!(text(parse(list.as_bytes())), good);
    }

    #[test]
    fn colours_are_optional_and_floats_of_0_to_1() {
        let plain =
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
        let colors = "property float red\nproperty double green\nproperty float blue\n";
        let read = |header: &str, point: &str| parse(format!("{header}end_header\n{point}").as_bytes());
        assert_eq!(read(plain, "1 2 3").unwrap().color, None);
        let colored = format!("{plain}{colors}");
        assert_eq!(read(&colored, "1 2 3 0 0.5 1").unwrap().color, Some(vec![[0, 128, 255]]));
        for bad in ["255", "-0.1", "NaN"] {
            let message = read(&colored, &format!("1 2 3 0 0 {bad}")).unwrap_err().to_string();
            assert!(
                message.starts_with(&format!("line 11 of the PLY file is no vertex: blue is `{bad}`")),
                "{message}"
            );
            assert!(message.contains("a colour is 0 to 1"), "{message}");
        }
    }

    #[test]
    fn everything_that_can_be_wrong_is_told() {
        for (from, to, said) in [
            ("ply\n", "ply 1.0\n", "line 1 of the PLY header is `ply 1.0`: expected `ply` alone"),
            ("ply\n", "ply\r", r"line 1 of the PLY header is `ply\rformat ascii 1.0`"),
            (
                "format ascii 1.0\n",
                "",
                "the PLY header has no `format` line: add one, such as `format ascii 1.0`",
            ),
            (
                "ascii",
                "binary",
                "line 2 of the PLY header is `format binary 1.0`: expected `format`, one of ascii, binary_little_endian",
            ),
            ("ascii 1.0", "ascii 1.1", "line 2 of the PLY header is `format ascii 1.1`: expected `format`"),
            ("format ascii", "format utf8", "expected `format`, one of"),
            (
                "comment made by hand",
                "format ascii 1.0",
                "line 3 of the PLY header is a second `format` line",
            ),
            ("comment", "remark", "line 3 of the PLY header is `remark made by hand`: expected one of"),
            ("element vertex 2", "element vertex", "line 4 of the PLY header is `element vertex`: expected"),
            ("element vertex 2", "element vertex -2", "is `element vertex -2`: expected `element`, a name"),
            ("element vertex 2", "element vertex 2 2", "is `element vertex 2 2`"),
            ("element vertex 2", "element vertex 18446744073709551616", "expected `element`, a name and how"),
            (
                "element face 1",
                "element vertex 1",
                "line 11 of the PLY header is a second `element vertex` line",
            ),
            ("element vertex 2", "element point 2", "has no `element vertex` line"),
            ("element vertex 2\n", "", "line 4 of the PLY header is `property uchar blue`: expected an"),
            ("element vertex 2", "element vertex 0", "says 0 vertices: a cloud has at least one point"),
            ("element vertex 2", "element vertex 268435457", "says 268435457 vertices: at most 2^28"),
            ("property float x", "property float", "line 6 of the PLY header is `property float`: expected"),
            ("property float x", "property float x 3", "is `property float x 3`: expected `property`"),
            ("property float x", "property list uchar x", "expected `property list`, two types and a name"),
            ("property float x", "property half x", "line 6 of the PLY header has the type `half`: expected"),
            (
                "property float x",
                "property list float int x",
                "has the type `float`: expected a whole-number type of PLY",
            ),
            ("property float x", "property list uchar int x", "property x is a list: save it as one number"),
            ("property float x", "property float z", "line 8 of the PLY header is a second property z"),
            ("property float x", "property float u", "the vertices of the PLY file have no property x"),
            ("property uchar green\n", "", "the vertices of the PLY file have no property green"),
            ("end_header\n", "end\n", "line 13 of the PLY header is `end`"),
            (
                "3 0.5 0.25",
                "3 half 0.25",
                "line 14 of the PLY file is no vertex: x is `half`, which is no float",
            ),
            (" 1 2\n", " 1\n", "line 14 of the PLY file is no vertex: it has fewer values"),
            (" 1 2\n", " 1 2 3\n", "line 14 of the PLY file is no vertex: it has more values"),
            ("nan 2 4", "nan 2.5 4", "line 15 of the PLY file is no vertex: z is `2.5`, which is no short"),
            ("nan 2 4", "nan 32768 4", "(a whole number from -32768 to 32767)"),
            ("6 -1e-1", "256 -1e-1", "blue is `256`, which is no uchar (a whole number from 0 to 255)"),
            ("4 5\n3 0 1 0\n", "4\n", "line 15 of the PLY file is no vertex: it has fewer values"),
        ] {
            let message = with(from, to).unwrap_err().to_string();
            assert!(message.contains(said), "{to}: {message}");
            assert!(!message.contains('\n'), "{message}");
        }
        let wide = GOOD.replace("uchar blue", "int blue").replace("6 -1e-1", "256 -1e-1");
        let message = parse(wide.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("line 15 of the PLY file is no vertex: blue is `256`, but"), "{message}");
        let listed = GOOD.replace("property float x", "property list uchar int near\nproperty float x");
        for (count, said) in [("-1", "`-1` is not the length of a list"), ("99999999", "fewer values")] {
            let message = parse(listed.replace("3 0.5", &format!("3 {count} 0.5")).as_bytes()).unwrap_err();
            assert!(message.to_string().contains(said), "{message}");
        }
    }

    /// The vertices of `GOOD` with a list each, behind elements with and without lists.
    fn binary(encoding: &str, number: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
        let header = format!(
            "ply\nformat {encoding} 1.0\nobj_info num_cols 2\nobj_info num_rows 1\nelement camera 2\nproperty double k\n\
             element note 2\nproperty list uchar short words\nelement none 7\nelement vertex 2\nproperty uchar blue\n\
             property float x\nproperty list ushort int near\nproperty double y\nproperty short z\nproperty uchar red\n\
             property uchar green\nelement face 1\nproperty int a\nend_header\n"
        );
        let mut file = header.into_bytes();
        file.extend([1.0_f64, 2.0].iter().flat_map(|k| number(&k.to_le_bytes())));
        file.extend([&[1][..], &number(&7_i16.to_le_bytes()), &[0]].concat());
        for (rgb, x, y, z, near) in
            [([1, 2, 3], 0.5_f32, 0.25_f64, 1_i16, 2_u16), ([4, 5, 6], -0.1, f64::NAN, 2, 0)]
        {
            let [red, green, blue] = rgb;
            file.push(blue);
            file.extend(number(&x.to_le_bytes()));
            file.extend(number(&near.to_le_bytes()));
            (0..near).for_each(|k| file.extend(number(&i32::from(k).to_le_bytes())));
            file.extend(number(&y.to_le_bytes()));
            file.extend(number(&z.to_le_bytes()));
            file.extend([red, green]);
        }
        file
    }

    #[test]
    fn binary_files_are_read_as_text_is() {
        let good = text(parse(GOOD.as_bytes()));
        let reversed = |bytes: &[u8]| bytes.iter().rev().copied().collect();
        let files = [binary("binary_little_endian", <[u8]>::to_vec), binary("binary_big_endian", reversed)];
        for file in files {
            assert_eq!(text(parse(&file)), good);
            let data = file.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
            for end in data..file.len() {
                let error = parse(&file[..end]).unwrap_err();
                let told = matches!(error, PlyError::TooShort { .. } | PlyError::MissingVertices { .. });
                assert!(told, "cut at {end}: {error}");
            }
        }
    }

    #[test]
    fn a_cloud_is_organized_where_its_size_is_said_and_fits() {
        let size = |columns: &str, rows: &str| {
            let lines = format!("obj_info num_cols {columns}\nobj_info num_rows {rows}\n");
            let cloud = with("comment made by hand\n", &lines).unwrap();
            (cloud.width, cloud.height)
        };
        assert_eq!(size("1", "2"), (1, 2));
        for (columns, rows) in [("2", "2"), ("-1", "-2"), ("1", ""), ("18446744073709551615", "2")] {
            assert_eq!(size(columns, rows), (2, 1), "{columns} {rows}");
        }
    }

    #[test]
    fn a_file_cut_anywhere_is_told() {
        let header = GOOD.find("3 0.5").unwrap();
        let enough = GOOD.find("5\n3 0 1 0").unwrap() + 1;
        for end in 0..enough {
            let error = parse(&GOOD.as_bytes()[..end]).unwrap_err();
            let told = match error {
                PlyError::UnfinishedHeader => end < header,
                PlyError::TooShort { .. } | PlyError::MissingVertices { .. } | PlyError::BadVertex { .. } => {
                    end + 1 >= header
                }
                _ => end < header,
            };
            assert!(told, "cut at {end}: {error}");
        }
        assert!(parse(&GOOD.as_bytes()[..enough]).is_ok());
    }

    #[test]
    fn claims_beyond_the_file_are_refused_before_memory_is_taken() {
        let claims = [
            ("element vertex 2", "element vertex 268435456"),
            (
                "comment made by hand\n",
                "element a 18446744073709551615\nproperty int i\nelement b 9\nproperty int i\n",
            ),
        ];
        for (from, to) in claims {
            let error = with(from, to).unwrap_err();
            assert!(matches!(error, PlyError::TooShort { .. }), "{error}");
            assert!(error.to_string().contains("the file is truncated or the header wrong"), "{error}");
        }
        let blank = with("3 0.5", &format!("{}3 0.5", "\n".repeat(100)));
        assert_eq!(text(blank), text(parse(GOOD.as_bytes())));
        let error = with("6 -1e-1 nan 2 4 5\n3 0 1 0\n", &" ".repeat(100)).unwrap_err();
        assert_eq!(error, PlyError::MissingVertices { promised: 2, found: 1 });
    }

    #[test]
    fn only_ply_is_taken_for_ply() {
        for mine in ["ply\n", "ply\r\nformat", "ply", "\u{feff}ply\n"] {
            assert!(is_ply(mine.as_bytes()), "{mine}");
        }
        for other in ["", "pl", "plywood\n", "# ply\n", "\nply\n"] {
            assert!(!is_ply(other.as_bytes()), "{other}");
        }
    }
}
