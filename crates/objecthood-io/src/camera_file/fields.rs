//! The fields of a camera file, by name. Whatever is wrong with one is said with its name.

use objecthood::Camera;
use serde_json::{Map, Value};

use super::wrong;
use crate::error::Result;

/// The fields of a file, or of a part of one.
pub(super) type Fields = Map<String, Value>;

/// The field that has one of these names.
///
/// # Errors
/// There are two.
pub(super) fn optional<'a>(
    fields: &'a Fields,
    names: &[&'static str],
) -> Result<Option<(&'static str, &'a Value)>> {
    let mut found = names.iter().filter_map(|&name| Some((name, fields.get(name)?)));
    match (found.next(), found.next()) {
        (Some((first, _)), Some((second, _))) => Err(wrong(format!("it has both `{first}` and `{second}`"))),
        (first, _) => Ok(first),
    }
}

/// The number in the field that has one of these names.
///
/// # Errors
/// There is none, there are two, or it is no number.
pub(super) fn number(fields: &Fields, names: &[&'static str]) -> Result<f64> {
    let field = optional(fields, names)?;
    let (name, value) = field.ok_or_else(|| wrong(format!("missing field `{}`", names[0])))?;
    value.as_f64().ok_or_else(|| wrong(format!("`{name}` is {value}, which is not a number")))
}

/// Columns and rows of the image, if the file has them.
///
/// # Errors
/// One is missing, or is no number of pixels.
pub(super) fn size(fields: &Fields) -> Result<Option<(usize, usize)>> {
    let side = |names: &[&'static str]| {
        optional(fields, names)?.map(|(name, value)| pixels(name, value)).transpose()
    };
    let width = side(&["width", "img_width", "image_width"])?;
    let height = side(&["height", "img_height", "image_height"])?;
    match (width, height) {
        (None, None) => Ok(None),
        (Some(width), Some(height)) => Ok(Some((width, height))),
        _ => Err(wrong("of `width` and `height` one is missing")),
    }
}

/// More pixels a side than any image has; a float holds every number up to it.
const MOST_PX: f64 = (1_u32 << 31) as f64;

/// Programs that keep all numbers as floats write 640.0.
fn pixels(name: &str, value: &Value) -> Result<usize> {
    let is_count = |pixels: &f64| (1.0..=MOST_PX).contains(pixels) && pixels.fract() == 0.0;
    let pixels = value.as_f64().filter(is_count).map(|pixels| pixels as usize);
    pixels.ok_or_else(|| wrong(format!("`{name}` is {value}, which is not a number of pixels")))
}

/// The field `depth_scale`, if the file has it: a positive number in the unit of its format.
///
/// # Errors
/// It is none.
pub(super) fn depth_scale(fields: &Fields) -> Result<Option<f64>> {
    if !fields.contains_key("depth_scale") {
        return Ok(None);
    }
    match number(fields, &["depth_scale"])? {
        positive if positive > 0.0 => Ok(Some(positive)),
        other => Err(wrong(format!("depth_scale {other} is not positive"))),
    }
}

/// The camera of a 3x3 matrix in a field: nine numbers in one list, or in three.
///
/// # Errors
/// As [`camera`], or these are no nine numbers.
pub(super) fn matrix(name: &str, value: &Value) -> Result<Camera> {
    let no_matrix = || wrong(format!("`{name}` is not nine numbers"));
    let rows = value.as_array().ok_or_else(no_matrix)?;
    let mut numbers = Vec::with_capacity(9);
    for row in rows.iter().take(10) {
        let row = row.as_array().map_or(std::slice::from_ref(row), Vec::as_slice);
        for value in row.iter().take(10) {
            numbers.push(value.as_f64().ok_or_else(no_matrix)?);
        }
    }
    let nine = <[f64; 9]>::try_from(numbers).map_err(|_| no_matrix())?;
    camera(&format!("`{name}`"), nine)
}

/// A matrix may have this share of its focal length as skew: rounding leaves it.
const MOST_SKEW: f64 = 1e-6;

/// The camera of a matrix of nine numbers, row by row, or column by column as Open3D writes them: the zeros tell which.
///
/// # Errors
/// The matrix is not that of a pinhole camera without skew; those of [`Camera::check`].
pub(super) fn camera(name: &str, nine: [f64; 9]) -> Result<Camera> {
    let no_camera = || wrong(format!("{name} is no matrix fx 0 cx, 0 fy cy, 0 0 1 of a camera"));
    // Drivers publish this until the camera is calibrated.
    if nine == [0.0; 9] {
        return Err(wrong(format!(
            "{name} is all zeros, so the camera is not calibrated: calibrate it, or ask its maker"
        )));
    }
    let [fx, skew, cx, zero, fy, cy, left, middle, one] = nine;
    let is_skewed = [skew, zero].iter().any(|skew| skew.abs() > MOST_SKEW * fx.abs());
    if is_skewed || one != 1.0 {
        return Err(no_camera());
    }
    let [cx, cy] = match ([cx, cy], [left, middle]) {
        (by_rows, [0.0, 0.0]) => by_rows,
        ([0.0, 0.0], by_columns) => by_columns,
        _ => return Err(no_camera()),
    };
    Ok(Camera::new(fx, fy, cx, cy)?)
}
