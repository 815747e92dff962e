//! The pixels beside a pixel.

/// The 4-neighbours of a pixel, right, left, down, up, each with the axis along which it lies.
pub(crate) fn four_neighbours(i: usize, width: usize, height: usize) -> impl Iterator<Item = (usize, usize)> {
    let (u, v) = (i % width, i / width);
    [
        (u + 1 < width).then(|| (i + 1, 0)),
        (u > 0).then(|| (i - 1, 0)),
        (v + 1 < height).then(|| (i + width, 1)),
        (v > 0).then(|| (i - width, 1)),
    ]
    .into_iter()
    .flatten()
}
