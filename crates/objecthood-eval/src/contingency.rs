//! How many pixels the regions of two label maps have in common.

use crate::error::{Error, Result};

/// The regions of a label map: every pixel belongs to one or to none; numbered 0.. by ascending label.
pub(crate) struct Classes {
    /// The label of each region, ascending.
    pub(crate) labels: Vec<u32>,
    /// Pixels of each region, at least one.
    pub(crate) pixels: Vec<u32>,
    /// The region of each pixel, or [`Classes::NONE`].
    pub(crate) at: Vec<u32>,
}

impl Classes {
    /// Stands for no region.
    pub(crate) const NONE: u32 = u32::MAX;

    /// The regions of an image of `len` pixels of which pixel i is labelled `label_at(i)`. O(n log k) for k regions.
    pub(crate) fn of(len: usize, label_at: impl Fn(usize) -> Option<u32>) -> Self {
        let mut labels = Vec::new();
        let mut last = None;
        for i in 0..len {
            let label = label_at(i);
            if label != last {
                labels.extend(label);
                last = label;
            }
        }
        labels.sort_unstable();
        labels.dedup();

        let mut pixels = vec![0; labels.len()];
        let at = (0..len)
            .map(|i| {
                let class = label_at(i).and_then(|l| labels.binary_search(&l).ok());
                class.map_or(Self::NONE, |k| {
                    pixels[k] += 1;
                    k as u32
                })
            })
            .collect();
        Self { labels, pixels, at }
    }

    /// Number of regions.
    pub(crate) fn len(&self) -> usize {
        self.labels.len()
    }

    /// Pixels in any region.
    pub(crate) fn total_px(&self) -> u64 {
        self.pixels.iter().map(|&n| u64::from(n)).sum()
    }
}

/// Pixels in common of every region of one map (rows) and every region of another (columns).
pub(crate) struct Contingency {
    columns: usize,
    cells: Vec<u32>,
}

impl Contingency {
    /// A table of more cells is refused rather than allocated: 2^26 (256 MiB).
    const MAX_CELLS: usize = 1 << 26;

    /// Counts. Both maps are of the same image.
    pub(crate) fn of(rows: &Classes, columns: &Classes) -> Result<Self> {
        let cells = rows.len().saturating_mul(columns.len());
        if cells > Self::MAX_CELLS {
            return Err(Error::TooManyRegions { rows: rows.len(), columns: columns.len() });
        }
        let mut table = Self { columns: columns.len(), cells: vec![0; cells] };
        for (&r, &c) in rows.at.iter().zip(&columns.at) {
            if r != Classes::NONE && c != Classes::NONE {
                table.cells[r as usize * table.columns + c as usize] += 1;
            }
        }
        Ok(table)
    }

    /// The row of region `row`: pixels in common with every column.
    pub(crate) fn row(&self, row: usize) -> &[u32] {
        &self.cells[row * self.columns..][..self.columns]
    }

    /// The sum of every column.
    pub(crate) fn column_sums(&self) -> Vec<u32> {
        let mut sums = vec![0; self.columns];
        for row in self.cells.chunks_exact(self.columns.max(1)) {
            for (sum, n) in sums.iter_mut().zip(row) {
                *sum += n;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn labels() -> impl Strategy<Value = Vec<Option<u32>>> {
        prop::collection::vec(prop::option::of(prop_oneof![0_u32..4, Just(u32::MAX)]), 40)
    }

    proptest! {
        #[test]
        fn cells_are_what_counting_says(a in labels(), b in labels()) {
            let (rows, columns) = (Classes::of(40, |i| a[i]), Classes::of(40, |i| b[i]));
            prop_assert!(rows.labels.is_sorted());
            let table = Contingency::of(&rows, &columns).unwrap();
            let sums = table.column_sums();
            for (c, &column) in columns.labels.iter().enumerate() {
                let mut sum = 0;
                for (r, &row) in rows.labels.iter().enumerate() {
                    let n = (0..40).filter(|&i| a[i] == Some(row) && b[i] == Some(column)).count();
                    prop_assert_eq!(table.row(r)[c] as usize, n);
                    sum += n;
                }
                prop_assert_eq!(sums[c] as usize, sum);
                prop_assert_eq!(columns.pixels[c] as usize, b.iter().filter(|&&l| l == Some(column)).count());
            }
            prop_assert_eq!(rows.total_px() as usize, a.iter().flatten().count());
        }
    }

    #[test]
    fn a_table_beyond_the_memory_is_refused() {
        let pixels = 1 << 14;
        let each = Classes::of(pixels, |i| Some(i as u32));
        assert!(matches!(Contingency::of(&each, &each), Err(Error::TooManyRegions { .. })));
    }
}
