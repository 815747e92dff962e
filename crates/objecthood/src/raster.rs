//! A rectangular grid of values, one per pixel.

use crate::buffers::Buffer;
use crate::error::{Error, Result};

/// `width * height` values in row-major order: pixel (u, v) has index `v * width + u`.
///
/// Pixel centres lie at integer coordinates; u counts columns to the right, v rows downwards.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster<T> {
    width: usize,
    height: usize,
    data: Buffer<T>,
}

impl<T> Raster<T> {
    /// The most pixels a raster may have: 2^28, so that pixel and edge indices fit 32 bits.
    pub const MAX_PIXELS: usize = 1 << 28;

    /// Wraps `data`, which holds the rows one after the other.
    ///
    /// # Errors
    /// [`Error::BadSize`] when a side is zero, the size exceeds [`Self::MAX_PIXELS`] or `data` has another length.
    pub fn from_vec(width: usize, height: usize, data: Vec<T>) -> Result<Self> {
        let pixels = width.checked_mul(height).filter(|&n| n > 0 && n <= Self::MAX_PIXELS);
        if pixels != Some(data.len()) {
            return Err(Error::BadSize { width, height, values: data.len() });
        }
        Ok(Self { width, height, data: data.into() })
    }

    /// As [`Self::from_vec`], in reused memory.
    ///
    /// # Panics
    /// When the size is not that of the buffer. No stage of the methods does that.
    pub(crate) fn of_buffer(width: usize, height: usize, data: Buffer<T>) -> Self {
        assert_eq!(data.len(), width * height, "one value a pixel");
        Self { width, height, data }
    }

    /// A raster of the same size with these values.
    ///
    /// # Panics
    /// When `data` does not hold one value a pixel. No stage of the methods does that.
    pub(crate) fn with_data<U>(&self, data: Buffer<U>) -> Raster<U> {
        assert_eq!(data.len(), self.data.len(), "one value a pixel");
        Raster { width: self.width, height: self.height, data }
    }

    /// Applies `f` to every value.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Raster<U> {
        self.with_data(self.data.iter().map(f).collect::<Vec<_>>().into())
    }

    /// Number of columns.
    #[inline]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    #[inline]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Number of columns and rows.
    #[inline]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Number of pixels; never zero.
    #[inline]
    #[expect(clippy::len_without_is_empty, reason = "a raster is never empty")]
    pub fn len(&self) -> usize {
        self.data.len()
    }

    /// All values, row by row.
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        &self.data
    }

    /// All values, row by row, mutable.
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// All values, row by row.
    pub fn into_vec(self) -> Vec<T> {
        self.data.into_vec()
    }

    /// The value at column `u` and row `v`, or `None` outside.
    pub fn get(&self, u: usize, v: usize) -> Option<&T> {
        if u < self.width && v < self.height { self.data.get(v * self.width + u) } else { None }
    }
}

impl<T: Clone> Raster<T> {
    /// A raster that holds `value` everywhere.
    ///
    /// # Errors
    /// [`Error::BadSize`] when a side is zero or the size exceeds [`Self::MAX_PIXELS`].
    pub fn filled(width: usize, height: usize, value: T) -> Result<Self> {
        match width.checked_mul(height) {
            Some(n) if n > 0 && n <= Self::MAX_PIXELS => Self::from_vec(width, height, vec![value; n]),
            _ => Err(Error::BadSize { width, height, values: 0 }),
        }
    }
}

impl<T> std::ops::Index<usize> for Raster<T> {
    type Output = T;

    /// The value of the pixel with row-major index `i`.
    #[inline]
    fn index(&self, i: usize) -> &T {
        &self.data[i]
    }
}

/// An upright rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelBox {
    /// Leftmost column.
    pub u: usize,
    /// Topmost row.
    pub v: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

impl PixelBox {
    /// The smallest upright rectangle around these pixels. There is at least one pixel.
    pub(crate) fn around(pixels: impl Iterator<Item = usize>, width: usize) -> Self {
        let (mut left, mut right, mut top, mut bottom) = (usize::MAX, 0, usize::MAX, 0);
        let mut row = 0..0;
        for i in pixels {
            // Most pixels lie in the row of the previous one, so a division is rare.
            if !row.contains(&i) {
                let v = i / width;
                row = v * width..(v + 1) * width;
                top = top.min(v);
                bottom = bottom.max(v);
            }
            left = left.min(i - row.start);
            right = right.max(i - row.start);
        }
        Self { u: left, v: top, width: right - left + 1, height: bottom - top + 1 }
    }
}

/// The indices of the marks that are not 0, in ascending order. Fast when few are set: stretches of zeros are skipped.
pub(crate) fn marked(marks: &[i32]) -> impl Iterator<Item = usize> + '_ {
    // Marks that are skipped together when none of them is set.
    const STRETCH: usize = 16;
    let stretches = marks.chunks(STRETCH).enumerate();
    let busy = stretches.filter(|(_, stretch)| stretch.iter().fold(0, |any, mark| any | mark) != 0);
    busy.flat_map(|(k, stretch)| (k * STRETCH..).zip(stretch).filter(|(_, mark)| **mark != 0).map(|(u, _)| u))
}

/// `count` values of a row from `u` on. When `count` is 0, `u` may lie beyond the row.
#[inline]
pub(crate) fn part<T>(row: &[T], u: usize, count: usize) -> &[T] {
    &row[u.min(row.len())..][..count]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn marked_places_are_those_that_are_not_zero(
            marks in prop::collection::vec(prop_oneof![20 => Just(0), 1 => -2_i32..3], 0..100),
        ) {
            let expected: Vec<usize> = (0..marks.len()).filter(|&u| marks[u] != 0).collect();
            prop_assert_eq!(marked(&marks).collect::<Vec<_>>(), expected);
        }
    }

    proptest! {
        #[test]
        fn a_box_of_pixels_is_that_of_their_places(
            pixels in prop::collection::vec(0_usize..60, 1..20),
            width in 1_usize..9,
        ) {
            let PixelBox { u, v, width: wide, height: tall } = PixelBox::around(pixels.iter().copied(), width);
            let around = |place: fn(usize, usize) -> usize| {
                let places = || pixels.iter().map(|&i| place(i, width));
                (places().min().unwrap(), places().max().unwrap() + 1)
            };
            prop_assert_eq!((u, u + wide), around(|i, width| i % width));
            prop_assert_eq!((v, v + tall), around(|i, width| i / width));
        }
    }

    #[test]
    fn a_raster_has_one_value_a_pixel() {
        assert!(Raster::from_vec(2, 3, vec![0; 6]).is_ok());
        assert!(Raster::from_vec(2, 3, vec![0; 5]).is_err());
        assert!(Raster::<u8>::from_vec(0, 3, vec![]).is_err());
        assert!(Raster::<u8>::from_vec(usize::MAX, 3, vec![]).is_err());
        assert!(Raster::filled(1 << 20, 1 << 20, 0_u8).is_err());
    }

    #[test]
    fn get_refuses_what_lies_outside() {
        let r = Raster::from_vec(2, 2, vec![1, 2, 3, 4]).unwrap();
        assert_eq!(r.get(1, 0), Some(&2));
        assert_eq!(r.get(2, 0), None);
        assert_eq!(r.get(0, 2), None);
        assert_eq!(r.get(1, usize::MAX), None);
    }
}
