//! `sensor_msgs/PointCloud2` -> points.

use super::fields::{Fields, Problem, Wire};
use super::messages::Header;
use crate::cloud::PointCloud;

/// A field of a point: its place in the bytes of a point, and the type by its number in `sensor_msgs/PointField`.
#[derive(Clone, Copy)]
struct Field {
    offset: usize,
    kind: u8,
}

/// Types of `PointField`.
const FLOAT32: u8 = 7;
const FLOAT64: u8 = 8;

/// The points of a message, and its header. The fields x, y and z are metres; rgb or rgba is 0xRRGGBB, as the Point Cloud Library
/// packs it.
///
/// # Errors
/// What is wrong with the message. Memory is bounded by its bytes.
pub(super) fn decode(message: &[u8], wire: Wire) -> Result<(PointCloud, Header), Problem> {
    let fields = &mut Fields::of(message, wire)?;
    let header = Header::read(fields, wire)?;
    let (height, width) = (fields.length()?, fields.length()?);
    let mut axes = [None; 3];
    let mut rgb = None;
    for _ in 0..fields.length()? {
        let name = fields.text()?;
        let field = Field { offset: fields.length()?, kind: fields.u8()? };
        fields.u32()?;
        match name {
            b"x" => axes[0] = Some(field),
            b"y" => axes[1] = Some(field),
            b"z" => axes[2] = Some(field),
            b"rgb" | b"rgba" => rgb = Some(field),
            _ => {}
        }
    }
    let is_big_endian = fields.u8()? != 0;
    let (point_step, row_step) = (fields.length()?, fields.length()?);
    let data = fields.bytes()?;
    let [Some(x), Some(y), Some(z)] = axes else { return Err("its points have no x, y and z".to_owned()) };

    let row = width.checked_mul(point_step).filter(|&row| row <= row_step);
    let needed = row.and_then(|row| row_step.checked_mul(height.checked_sub(1)?)?.checked_add(row));
    if point_step == 0 || width == 0 || needed.is_none_or(|needed| needed > data.len()) {
        return Err(format!("{} bytes are no {width}x{height} points of {point_step} bytes", data.len()));
    }
    let points =
        || (0..width * height).map(|i| &data[i / width * row_step + i % width * point_step..][..point_step]);
    let number = |point: &[u8], field: Field| number(point, field, is_big_endian);
    let mut points_m = Vec::with_capacity(width * height);
    for point in points() {
        let part =
            |field| number(point, field).ok_or("x, y and z are no floating-point numbers of its points");
        points_m.push([part(x)?, part(y)?, part(z)?]);
    }
    let color = rgb.map(|Field { offset, .. }| {
        let of = |point: &[u8]| match point.get(offset..).and_then(<[u8]>::first_chunk) {
            Some(&[_, r, g, b]) if is_big_endian => Some([r, g, b]),
            Some(&[b, g, r, _]) => Some([r, g, b]),
            None => None,
        };
        points().map(of).collect::<Option<Vec<_>>>().ok_or("its colours leave its points")
    });
    let color = color.transpose()?;
    Ok((PointCloud { width, height, points_m, color, label: None, viewpoint: None }, header))
}

fn number(point: &[u8], field: Field, is_big_endian: bool) -> Option<f32> {
    let bytes = point.get(field.offset..)?;
    match field.kind {
        FLOAT32 => {
            let &bytes = bytes.first_chunk()?;
            Some(if is_big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
        }
        FLOAT64 => {
            let &bytes = bytes.first_chunk()?;
            Some(if is_big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) } as f32)
        }
        _ => None,
    }
}
