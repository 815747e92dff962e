//! Sets of pixels, a bit each.

use serde::{Deserialize, Serialize};

/// A set of pixels of an image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Bits {
    size: (usize, usize),
    words_per_row: usize,
    words: Vec<u64>,
}

impl Bits {
    pub(crate) fn none(size: (usize, usize)) -> Self {
        let words_per_row = size.0.div_ceil(64);
        Self { size, words_per_row, words: vec![0; words_per_row * size.1] }
    }

    /// The pixels for which `holds`, by their index. O(n).
    pub(crate) fn of(size: (usize, usize), holds: impl Fn(usize) -> bool) -> Self {
        let mut bits = Self::none(size);
        for v in 0..size.1 {
            let words = &mut bits.words[v * bits.words_per_row..(v + 1) * bits.words_per_row];
            for (k, word) in words.iter_mut().enumerate() {
                for u in 64 * k..(64 * (k + 1)).min(size.0) {
                    *word |= u64::from(holds(v * size.0 + u)) << (u % 64);
                }
            }
        }
        bits
    }

    pub(crate) fn has(&self, pixel: usize) -> bool {
        let (u, v) = (pixel % self.size.0, pixel / self.size.0);
        self.words[v * self.words_per_row + u / 64] >> (u % 64) & 1 == 1
    }

    pub(crate) fn insert(&mut self, pixel: usize) {
        let (u, v) = (pixel % self.size.0, pixel / self.size.0);
        self.words[v * self.words_per_row + u / 64] |= 1 << (u % 64);
    }

    pub(crate) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    pub(crate) fn common(&self, other: &Self) -> usize {
        self.words.iter().zip(&other.words).map(|(a, b)| (a & b).count_ones() as usize).sum()
    }

    pub(crate) fn unite(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a |= b);
    }

    pub(crate) fn remove(&mut self, other: &Self) {
        self.words.iter_mut().zip(&other.words).for_each(|(a, b)| *a &= !b);
    }

    /// Every pixel within `radius_px` columns and rows of one of the set. O(n radius / 64).
    pub(crate) fn dilated(&self, radius_px: usize) -> Self {
        let mut wide = self.clone();
        for (row, out) in
            self.words.chunks_exact(self.words_per_row).zip(wide.words.chunks_exact_mut(self.words_per_row))
        {
            let mut shifted = [row.to_vec(), row.to_vec()];
            for _ in 0..radius_px {
                let [left, right] = &mut shifted;
                for k in 0..row.len() {
                    left[k] = (left[k] >> 1) | left.get(k + 1).map_or(0, |next| next << 63);
                }
                for k in (0..row.len()).rev() {
                    right[k] = (right[k] << 1) | if k > 0 { right[k - 1] >> 63 } else { 0 };
                }
                for (k, word) in out.iter_mut().enumerate() {
                    *word |= left[k] | right[k];
                }
            }
        }
        wide.trim();
        let mut high = wide.clone();
        let step = self.words_per_row;
        for _ in 0..radius_px {
            let before = high.words.clone();
            let (n, words) = (before.len(), &mut high.words);
            words[..n - step].iter_mut().zip(&before[step..]).for_each(|(a, b)| *a |= b);
            words[step..].iter_mut().zip(&before[..n - step]).for_each(|(a, b)| *a |= b);
        }
        high
    }

    /// Every pixel whose neighbours within `radius_px` columns and rows are all of the set; beyond the image all are.
    pub(crate) fn eroded(&self, radius_px: usize) -> Self {
        self.complement().dilated(radius_px).complement()
    }

    pub(crate) fn complement(&self) -> Self {
        let words = self.words.iter().map(|word| !word).collect();
        let mut all = Self { words, ..*self };
        all.trim();
        all
    }

    /// Removes what lies in the words beyond the last column.
    fn trim(&mut self) {
        let rest = self.size.0 % 64;
        if rest > 0 {
            for row in self.words.chunks_exact_mut(self.words_per_row) {
                if let Some(last) = row.last_mut() {
                    *last &= (1 << rest) - 1;
                }
            }
        }
    }

    /// The pixels in ascending order.
    pub(crate) fn pixels(&self) -> impl Iterator<Item = usize> + '_ {
        self.words.iter().enumerate().filter(|(_, word)| **word > 0).flat_map(move |(k, &word)| {
            let first = k / self.words_per_row * self.size.0 + 64 * (k % self.words_per_row);
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| first + bit)
        })
    }

    /// The parts that hang together by columns and rows, by their first pixel. O(pixels of the set).
    pub(crate) fn components(&self) -> Vec<Vec<usize>> {
        self.components_where(|_, _| true)
    }

    /// As [`Self::components`], with neighbours only that hang together by this test too.
    pub(crate) fn components_where(&self, hang_together: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
        let (width, height) = self.size;
        let mut left = self.clone();
        let mut components = Vec::new();
        for start in self.pixels() {
            if !left.has(start) {
                continue;
            }
            left.take(start);
            let mut pixels = vec![start];
            let mut done = 0;
            while done < pixels.len() {
                let pixel = pixels[done];
                done += 1;
                let (u, v) = (pixel % width, pixel / width);
                let around = [
                    (u > 0).then(|| pixel - 1),
                    (u + 1 < width).then(|| pixel + 1),
                    (v > 0).then(|| pixel - width),
                    (v + 1 < height).then(|| pixel + width),
                ];
                for next in around.into_iter().flatten() {
                    if left.has(next) && hang_together(pixel, next) {
                        left.take(next);
                        pixels.push(next);
                    }
                }
            }
            components.push(pixels);
        }
        components
    }

    fn take(&mut self, pixel: usize) {
        let (u, v) = (pixel % self.size.0, pixel / self.size.0);
        self.words[v * self.words_per_row + u / 64] &= !(1 << (u % 64));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As [`Bits::dilated`], pixel by pixel.
    fn dilated(bits: &Bits, radius: usize) -> Bits {
        let (width, _) = bits.size;
        let near = |i: usize, j: usize| {
            (i % width).abs_diff(j % width) <= radius && (i / width).abs_diff(j / width) <= radius
        };
        Bits::of(bits.size, |i| bits.pixels().any(|j| near(i, j)))
    }

    #[test]
    fn dilation_and_erosion_are_those_of_single_pixels() {
        for size in [(1, 1), (63, 5), (64, 4), (65, 7), (130, 6)] {
            let bits = Bits::of(size, |i| (i * i) % 37 < 2 || (i / 3) % 11 == 4);
            for radius in [0, 1, 2, 5] {
                assert_eq!(bits.dilated(radius), dilated(&bits, radius), "{size:?} {radius}");
                let eroded = dilated(&bits.complement(), radius).complement();
                assert_eq!(bits.eroded(radius), eroded, "{size:?} {radius}");
            }
            assert_eq!(bits.pixels().count(), bits.count());
            assert_eq!(bits.count() + bits.complement().count(), size.0 * size.1);
        }
    }

    #[test]
    fn components_part_the_set() {
        let bits = Bits::of((70, 4), |i| matches!(i % 70, 0..=3 | 60..=66) && i / 70 != 2);
        let components = bits.components();
        assert_eq!(components.iter().map(Vec::len).collect::<Vec<_>>(), [8, 14, 4, 7]);
    }
}
