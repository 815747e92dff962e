//! Binary morphology with square windows.

/// A mask of pixels, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mask {
    pub(super) width: usize,
    pub(super) pixels: Vec<bool>,
}

impl Mask {
    /// Every pixel with one of the mask at most `radius_px` away along rows and columns. O(n).
    pub(super) fn dilated(&self, radius_px: usize) -> Self {
        self.spread(radius_px, true)
    }

    /// Dilated, then eroded as much: gaps up to 2 `radius_px` are closed. O(n).
    pub(super) fn closed(&self, radius_px: usize) -> Self {
        self.dilated(radius_px).spread(radius_px, false)
    }

    /// Where a pixel of this `value` is near, that value; elsewhere the other.
    fn spread(&self, radius_px: usize, value: bool) -> Self {
        let Self { width, .. } = *self;
        let height = self.pixels.len() / width;
        let mut along_rows = vec![!value; self.pixels.len()];
        for v in 0..height {
            mark_near(
                width,
                radius_px,
                |u| self.pixels[v * width + u] == value,
                |u| along_rows[v * width + u] = value,
            );
        }
        let mut pixels = vec![!value; self.pixels.len()];
        for u in 0..width {
            mark_near(
                height,
                radius_px,
                |v| along_rows[v * width + u] == value,
                |v| pixels[v * width + u] = value,
            );
        }
        Self { width, pixels }
    }
}

/// Marks every place of 0..len that is at most `radius` from one that `is_set`.
fn mark_near(len: usize, radius: usize, is_set: impl Fn(usize) -> bool, mut mark: impl FnMut(usize)) {
    let mut unmarked_from = 0;
    for k in (0..len).filter(|&k| is_set(k)) {
        let end = (k + radius + 1).min(len);
        (unmarked_from.max(k.saturating_sub(radius))..end).for_each(&mut mark);
        unmarked_from = end;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The definition, pixel by pixel.
    fn naive(mask: &Mask, radius: usize, value: bool) -> Vec<bool> {
        let (width, height) = (mask.width, mask.pixels.len() / mask.width);
        let near = |i: usize, j: usize| {
            (i % width).abs_diff(j % width) <= radius && (i / width).abs_diff(j / width) <= radius
        };
        let n = width * height;
        (0..n)
            .map(|i| if (0..n).any(|j| near(i, j) && mask.pixels[j] == value) { value } else { !value })
            .collect()
    }

    proptest! {
        #[test]
        fn it_is_the_definition(pixels in prop::collection::vec(prop::bool::weighted(0.15), 70), radius in 0_usize..4) {
            let mask = Mask { width: 7, pixels };
            prop_assert_eq!(&mask.dilated(radius).pixels, &naive(&mask, radius, true));
            let closed = mask.closed(radius);
            let eroded = naive(&mask.dilated(radius), radius, false);
            prop_assert_eq!(&closed.pixels, &eroded);
            prop_assert!(closed.pixels.iter().zip(&mask.pixels).all(|(&after, &before)| after || !before));
        }
    }
}
