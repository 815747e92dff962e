//! Point Cloud Data (PCD) files of version 0.7, as the Point Cloud Library writes them.
//!
//! A text header names the fields of a point with their types; the points follow as text (`ascii`), as one record
//! after the other (`binary`), or as one whole field after the other under LZF (`binary_compressed`). All numbers are
//! little-endian. Version 0.6 differs in nothing that matters here.
//!
//! | field | type | use |
//! |---|---|---|
//! | `x`, `y`, `z` | F4 or F8 | the point in the camera frame, metres; not finite = none |
//! | `rgb` or `rgba` | U4, I4, or F4 with the same 32 bits | R = bits 16-23, G = 8-15, B = 0-7 |
//! | `label` | any U or I | the segment that the point belongs to; negative = none = 0 |
//!
//! Fields stand in any order; others are skipped, whatever their type and COUNT. Whatever follows the last point is ignored, as the Point Cloud Library
//! does. In `ascii` the declared type says how the colour is printed, again as there: an F4 as the float whose bits
//! hold the colour (`4.2108e+06`), a U4 as an integer.
//!
//! VIEWPOINT, tx ty tz qw qx qy qz, is where the sensor was. The documentation leaves open whether the points are in its frame
//! or it is in theirs, and programs do both: normals and range images of the Point Cloud Library take the points to be
//! in the world, `pcl_transform_from_viewpoint` in the frame of the sensor. So [`organize`](crate::organize) decides by the
//! points.
//!
//! Source: *The PCD (Point Cloud Data) file format*, documentation of the Point Cloud Library; for what it leaves open,
//! the behaviour of that library's reader.

mod ascii;
mod columns;
mod error;
mod header;
mod lzf;
mod table;

pub use error::PcdError;

use header::{Field, Header};
use table::Table;

use super::{Format, FrameFormat, organized};
use crate::cloud::PointCloud;
use crate::text::without_byte_order_mark;

pub(super) const FORMAT: Format = Format::Frame(FrameFormat {
    extensions: &["pcd"],
    is_mine: is_pcd,
    is_metric: true,
    decode: |bytes, given| organized(parse(bytes), given),
});

/// Whether a file begins with a comment or its VERSION. A ROS 1 bag begins with `#` too.
fn is_pcd(head: &[u8]) -> bool {
    let head = without_byte_order_mark(head).trim_ascii_start();
    head.starts_with(b"VERSION") || (head.starts_with(b"#") && !head.starts_with(b"#ROSBAG"))
}

/// Reads the content of a PCD file.
///
/// O(bytes) time. Memory is bounded by the bytes that are there, never by what the header claims: at most about 90
/// bytes for each byte of a `binary_compressed` file (LZF expands no further) and a few for the others.
///
/// # Errors
/// [`PcdError`]: what breaks the format, where, and what to do.
pub fn parse(bytes: &[u8]) -> Result<PointCloud, PcdError> {
    let (header, data) = Header::parse(without_byte_order_mark(bytes))?;
    let roles = Roles::of(&header.fields)?;
    let table = Table::read(&header, data, |field| roles.uses(field))?;

    Ok(PointCloud {
        width: header.width,
        height: header.height,
        points_m: columns::points_m(roles.xyz.map(|field| table.column(field)))?,
        color: roles.color.map(|field| columns::colors(table.column(field))).transpose()?,
        label: roles.label.map(|field| columns::labels(table.column(field))).transpose()?,
        viewpoint: header.viewpoint,
    })
}

/// Whether the points of a file that begins with `head` have labels; `None` when its header is not whole, or wrong.
pub fn has_labels(head: &[u8]) -> Option<bool> {
    let (header, _) = Header::parse(without_byte_order_mark(head)).ok()?;
    Some(header.fields.iter().any(|field| field.name == "label"))
}

/// Which fields are used.
struct Roles<'a> {
    xyz: [&'a Field<'a>; 3],
    color: Option<&'a Field<'a>>,
    label: Option<&'a Field<'a>>,
}

impl<'a> Roles<'a> {
    fn of(fields: &'a [Field<'a>]) -> Result<Self, PcdError> {
        let find = |name: &str| fields.iter().find(|field| field.name == name);
        let need = |name: &'static str| find(name).ok_or(PcdError::MissingField { field: name });
        let color = match (find("rgb"), find("rgba")) {
            (Some(_), Some(_)) => return Err(PcdError::TwoColors),
            (rgb, rgba) => rgb.or(rgba),
        };
        Ok(Self { xyz: [need("x")?, need("y")?, need("z")?], color, label: find("label") })
    }

    fn uses(&self, field: &Field<'_>) -> bool {
        let used = self.xyz.into_iter().chain(self.color).chain(self.label);
        used.into_iter().any(|one| one.name == field.name)
    }
}
