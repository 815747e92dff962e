//! The edges between 8-neighbours, and their directions.

use std::ops::Range;

/// Steps along columns and rows to the four neighbours after a pixel in scan order: right, down, down-right, down-left.
pub(crate) const STEPS: [(isize, usize); 4] = [(1, 0), (0, 1), (1, 1), (-1, 1)];

/// An edge between two 8-neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelEdge {
    /// Dissimilarity, eq. 1.
    pub(crate) weight: f32,
    /// Index of the pixel that comes first in scan order.
    pub(crate) p: u32,
    /// Index of the other pixel.
    pub(crate) q: u32,
}

/// Splits the weights of a row of pixels by direction.
pub(crate) fn by_direction(row: &[f32]) -> [&[f32]; 4] {
    let (level, below) = row.split_at(row.len() / 2);
    let ((right, down), (down_right, down_left)) =
        (level.split_at(level.len() / 2), below.split_at(below.len() / 2));
    [right, down, down_right, down_left]
}

/// The columns from which a step of `du` columns stays in the image, and the columns to which it leads.
pub(crate) fn columns(du: isize, width: usize) -> (Range<usize>, Range<usize>) {
    match du {
        1 => (0..width - 1, 1..width),
        -1 => (1..width, 0..width - 1),
        _ => (0..width, 0..width),
    }
}
