//! NPY: points in an array of NumPy.
//!
//! | shape | what it is |
//! |---|---|
//! | N, 3 | a list of points: x, y, z (m) |
//! | H, W, 3 | an organized cloud |
//! | N, 6 or H, W, 6 | the same with red, green, blue: of 0 to 1 if none is greater, else of 0 to 255 |
//!
//! Numbers are real; points that are not finite, or lie in the origin, are missing. Depth images are arrays of two sides, and are
//! [images](crate::images).

use std::io::Read;

use super::{Format, FrameFormat, organized};
use crate::cloud::PointCloud;
use crate::images::check_pixels;
use crate::npy::{Array, MARK, NpyError};

/// No endings: in a folder most such files are depth images, or arrays of something else. A file that is named is read.
pub(super) const FORMAT: Format = Format::Frame(FrameFormat {
    extensions: &[],
    is_mine: |head| head.starts_with(MARK),
    is_metric: true,
    decode: |bytes, given| {
        let cloud = Array::open(bytes).map_err(PointsError::Array);
        organized(cloud.and_then(|array| cloud_of(array, given.max_pixels)), given)
    },
});

/// Why an array is no point cloud.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PointsError {
    /// An array that cannot be read.
    #[error("the array of NumPy: {0}")]
    Array(NpyError),
    /// An array of another shape.
    #[error(
        "the array has the shape {found:?}, but points are (N, 3), (N, 6), (H, W, 3) or (H, W, 6): give a depth image with --depth"
    )]
    Shape {
        /// Its sides, at most four of them.
        found: Vec<usize>,
    },
    /// Points in whole numbers, of which the unit is not known.
    #[error("the points are whole numbers, of which the unit is not known: save metres as float32")]
    Whole,
    /// More points than the caller wants to have memory for.
    #[error(transparent)]
    TooMany(#[from] crate::images::ImageError),
    /// What follows x, y and z is no colour.
    #[error(
        "columns 4 to 6 have {found}, but colours are 0 to 255: save columns 1 to 3 alone if they are normals"
    )]
    Color {
        /// A number that is no colour.
        found: f32,
    },
}

/// The points of an array, of which there may be `max_pixels`.
///
/// # Errors
/// [`PointsError`].
pub(super) fn cloud_of<R: Read>(array: Array<R>, max_pixels: usize) -> Result<PointCloud, PointsError> {
    let (width, height, parts) = match *array.shape.as_slice() {
        [points, parts @ (3 | 6)] => (points, 1, parts),
        [height, width, parts @ (3 | 6)] => (width, height, parts),
        ref other => return Err(PointsError::Shape { found: other.iter().copied().take(4).collect() }),
    };
    check_pixels((width, height), max_pixels)?;
    if array.is_whole() {
        return Err(PointsError::Whole);
    }
    let mut numbers = Vec::new();
    array.read(|number| numbers.push(number.as_f64() as f32)).map_err(PointsError::Array)?;
    let rows = || numbers.chunks_exact(parts);
    let points_m = rows().map(|row| [row[0], row[1], row[2]]).collect();
    let color = (parts == 6).then(|| colors(rows().map(|row| [row[3], row[4], row[5]]))).transpose()?;
    Ok(PointCloud { width, height, points_m, color, label: None, viewpoint: None })
}

/// Colours of 0 to 1, or of 0 to 255. Those of missing points may be missing too, and become black.
fn colors(rows: impl Iterator<Item = [f32; 3]> + Clone) -> Result<Vec<[u8; 3]>, PointsError> {
    let finite = || rows.clone().flatten().filter(|channel| channel.is_finite());
    if let Some(found) = finite().find(|channel| !(0.0..=255.0).contains(channel)) {
        return Err(PointsError::Color { found });
    }
    let scale = if finite().all(|channel| channel <= 1.0) { 255.0 } else { 1.0 };
    Ok(rows.map(|row| row.map(|channel| (channel * scale).round() as u8)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(shape: &str, numbers: &[f32]) -> Result<PointCloud, PointsError> {
        let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        let file = [MARK, &[1, 0], &(text.len() as u16).to_le_bytes(), text.as_bytes(), &numbers].concat();
        cloud_of(Array::open(&file[..]).map_err(PointsError::Array)?, 100)
    }

    #[test]
    fn shapes_and_colours_are_told_apart() {
        let list = read("(2, 3)", &[0.0, 0.0, 1.0, 0.5, 0.0, 2.0]).unwrap();
        assert_eq!((list.width, list.height, list.points_m[1], list.color), (2, 1, [0.5, 0.0, 2.0], None));
        let grid = read("(2, 1, 6)", &[0.0, 0.0, 1.0, 0.0, 0.5, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0]).unwrap();
        assert_eq!((grid.width, grid.height), (1, 2));
        assert_eq!(grid.color.unwrap(), [[0, 128, 255], [255, 255, 0]]);
        let bytes = read("(1, 6)", &[0.0, 0.0, 1.0, 0.0, 1.0, 255.0]).unwrap();
        assert_eq!(bytes.color.unwrap(), [[0, 1, 255]]);
    }

    #[test]
    fn what_is_no_cloud_is_told() {
        let told = |shape: &str, numbers: &[f32]| read(shape, numbers).unwrap_err().to_string();
        assert!(told("(2, 2)", &[0.0; 4]).contains("give a depth image with --depth"));
        assert!(told("(1, 6)", &[0.0, 0.0, 1.0, 0.0, 0.0, -1.0]).contains("if they are normals"));
        assert!(told("(1, 3)", &[0.0; 2]).contains("it ends after 2 of 3 numbers"));
        assert!(told("(101, 3)", &[0.0; 3]).contains("101"));
    }
}
