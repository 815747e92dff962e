//! From the bytes of a field to coordinates, colours and labels.

use super::error::PcdError;
use super::header::Kind;
use super::table::Column;

/// The points from their three coordinates.
pub(super) fn points_m(columns: [Column<'_>; 3]) -> Result<Vec<[f32; 3]>, PcdError> {
    let mut points = vec![[f32::NAN; 3]; columns[0].points()];
    for (axis, column) in columns.into_iter().enumerate() {
        let place = points.iter_mut().map(|point| &mut point[axis]);
        match kind(&column, "F4 or F8")? {
            Kind::F4 => place.zip(column.values(f32::from_le_bytes)).for_each(|(p, v)| *p = v),
            Kind::F8 => place.zip(column.values(f64::from_le_bytes)).for_each(|(p, v)| *p = v as f32),
            _ => return Err(unusable(&column, "F4 or F8")),
        }
    }
    Ok(points)
}

/// The colours from 32 bits each: R = bits 16-23, G = 8-15, B = 0-7.
pub(super) fn colors(column: Column<'_>) -> Result<Vec<[u8; 3]>, PcdError> {
    match kind(&column, "U4 or F4")? {
        Kind::U4 | Kind::I4 | Kind::F4 => Ok(column.values(|[b, g, r, _]| [r, g, b]).collect()),
        _ => Err(unusable(&column, "U4 or F4")),
    }
}

/// The labels; negative ones mean none, which is 0.
pub(super) fn labels(column: Column<'_>) -> Result<Vec<u32>, PcdError> {
    Ok(match kind(&column, "U or I")? {
        Kind::U1 => column.values(u8::from_le_bytes).map(u32::from).collect(),
        Kind::U2 => column.values(u16::from_le_bytes).map(u32::from).collect(),
        Kind::U4 => column.values(u32::from_le_bytes).collect(),
        Kind::U8 => fitting(column.values(u64::from_le_bytes))?,
        Kind::I1 => column.values(|bytes| i8::from_le_bytes(bytes).max(0) as u32).collect(),
        Kind::I2 => column.values(|bytes| i16::from_le_bytes(bytes).max(0) as u32).collect(),
        Kind::I4 => column.values(|bytes| i32::from_le_bytes(bytes).max(0) as u32).collect(),
        Kind::I8 => fitting(column.values(|bytes| i64::from_le_bytes(bytes).max(0) as u64))?,
        Kind::F4 | Kind::F8 => return Err(unusable(&column, "U or I")),
    })
}

fn fitting(labels: impl Iterator<Item = u64>) -> Result<Vec<u32>, PcdError> {
    labels.map(|label| u32::try_from(label).map_err(|_| PcdError::LabelTooLarge)).collect()
}

/// The type of a field that has one value per point.
fn kind(column: &Column<'_>, needed: &'static str) -> Result<Kind, PcdError> {
    if column.field.count == 1 { Ok(column.field.kind) } else { Err(unusable(column, needed)) }
}

fn unusable(column: &Column<'_>, needed: &'static str) -> PcdError {
    let field = column.field;
    let found = format!("{:?} with COUNT {}", field.kind, field.count);
    PcdError::UnusableField { field: field.name.to_owned(), found, needed }
}
