//! The pixels on which the search for surfaces works (docs/CONTEXT.md 1.1.1, step 1).

/// A pixel of the grid.
pub(super) struct Sample {
    /// Its row-major index.
    pub(super) pixel: usize,
    /// Column and row.
    pub(super) at: [f64; 2],
    /// Disparity (quanta).
    pub(super) disparity: f64,
}
