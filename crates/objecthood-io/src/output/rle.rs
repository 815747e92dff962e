//! Masks as run lengths, as COCO has them: columns from left to right, each from top to bottom; the lengths of runs, beginning with pixels
//! that do not belong to the mask.
//!
//! `counts` is the compressed form of pycocotools: each length, from the fourth on its difference to the one two before, in groups of five
//! bits from the lowest on, a sixth bit that says whether more follow, and 48 added to make it a letter.

use objecthood::Raster;
use serde::Serialize;

/// A mask as run lengths.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Rle {
    /// Rows and columns, in this order.
    pub size: [usize; 2],
    /// The lengths, compressed.
    pub counts: String,
}

/// The masks of the labels 1 to `count`. O(n + runs) for n pixels.
pub fn of_labels(labels: &Raster<u16>, count: usize) -> Vec<Rle> {
    let (width, height) = labels.size();
    let (size, total) = ([height, width], width * height);
    let mut masks = vec![Runs::default(); count];
    let mut at = 0;
    let mut start = 0;
    let mut before = 0;
    let mut close = |label: u16, start: usize, end: usize| {
        if let Some(runs) = usize::from(label).checked_sub(1).and_then(|k| masks.get_mut(k)) {
            runs.push(start, end);
        }
    };
    for u in 0..width {
        for v in 0..height {
            let label = labels.as_slice()[v * width + u];
            if label != before {
                close(before, start, at);
                (start, before) = (at, label);
            }
            at += 1;
        }
    }
    close(before, start, at);
    masks.into_iter().map(|runs| Rle { size, counts: runs.finish(total) }).collect()
}

/// The lengths of a mask so far.
#[derive(Clone, Default)]
struct Runs {
    lengths: Vec<usize>,
    /// Pixels that they cover.
    end: usize,
}

impl Runs {
    /// Adds a run of pixels of the mask.
    fn push(&mut self, start: usize, end: usize) {
        self.lengths.extend([start - self.end, end - start]);
        self.end = end;
    }

    /// The compressed lengths, when the image has `total` pixels.
    fn finish(mut self, total: usize) -> String {
        if self.end < total {
            self.lengths.push(total - self.end);
        }
        compress(&self.lengths)
    }
}

fn compress(lengths: &[usize]) -> String {
    let mut text = String::new();
    for (k, &length) in lengths.iter().enumerate() {
        // Neighbouring columns are alike, so these differences are small.
        let mut rest = length as i64 - if k > 2 { lengths[k - 2] as i64 } else { 0 };
        loop {
            let low = (rest & 0x1f) as u8;
            rest >>= 5;
            let is_last = rest == if low & 0x10 == 0 { 0 } else { -1 };
            text.push(char::from(48 + low + if is_last { 0 } else { 0x20 }));
            if is_last {
                break;
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The lengths back from their letters, written from the description of the format.
    fn expand(counts: &str) -> Vec<i64> {
        let mut lengths: Vec<i64> = Vec::new();
        let (mut value, mut shift) = (0_i64, 0);
        for letter in counts.bytes().map(|b| i64::from(b) - 48) {
            value |= (letter & 0x1f) << shift;
            shift += 5;
            if letter & 0x20 != 0 {
                continue;
            }
            if letter & 0x10 != 0 {
                value -= 1 << shift;
            }
            let k = lengths.len();
            lengths.push(value + if k > 2 { lengths[k - 2] } else { 0 });
            (value, shift) = (0, 0);
        }
        lengths
    }

    fn mask_of(rle: &Rle) -> Vec<bool> {
        let [height, width] = rle.size;
        let lengths = expand(&rle.counts);
        let columns: Vec<bool> = lengths
            .iter()
            .enumerate()
            .flat_map(|(k, &n)| std::iter::repeat_n(k % 2 == 1, n as usize))
            .collect();
        assert_eq!(columns.len(), width * height);
        (0..width * height).map(|i| columns[i % width * height + i / width]).collect()
    }

    proptest! {
        #[test]
        fn masks_come_back(width in 1_usize..40, height in 1_usize..40, seed in 0_u64..1000, block in 1_usize..9) {
            let label = |i: usize| ((i % width / block * 7 + i / width / block * 13 + seed as usize) % 4) as u16;
            let labels = Raster::from_vec(width, height, (0..width * height).map(label).collect()).unwrap();
            for (k, rle) in of_labels(&labels, 4).iter().enumerate() {
                let expected: Vec<bool> = labels.as_slice().iter().map(|&l| usize::from(l) == k + 1).collect();
                prop_assert_eq!(mask_of(rle), expected);
            }
        }
    }

    /// As `pycocotools.mask.encode` writes these masks (version 2.0.11).
    #[test]
    fn letters_are_those_of_pycocotools() {
        let whole = Raster::filled(3, 2, 1).unwrap();
        assert_eq!(
            of_labels(&whole, 2),
            [Rle { size: [2, 3], counts: "06".into() }, Rle { size: [2, 3], counts: "6".into() }]
        );
        let inside = |i: usize| u16::from((1..3).contains(&(i % 4)) && (1..4).contains(&(i / 4)));
        let square = Raster::from_vec(4, 5, (0..20).map(inside).collect()).unwrap();
        assert_eq!(of_labels(&square, 1)[0].counts, "63204");
    }
}
