//! Integral images: the sum over any upright rectangle from four values.

use std::ops::{AddAssign, Range};

use crate::raster::Raster;

/// Sums of K values a pixel over all rectangles that start at the upper left corner (Crow 1984), in f64.
///
/// Building is O(pixels), a query O(1).
pub struct IntegralImage<const K: usize> {
    stride: usize,
    /// One row and one column more than the image; the first of each is zero.
    sums: Vec<[f64; K]>,
}

impl<const K: usize> IntegralImage<K> {
    /// Sums up `value(i)` of every pixel index of `shape`.
    pub fn new<T>(shape: &Raster<T>, value: impl Fn(usize) -> [f64; K]) -> Self {
        let (width, height) = shape.size();
        let stride = width + 1;
        let mut sums = vec![[0.0; K]; stride * (height + 1)];
        for v in 0..height {
            let mut row = [0.0; K];
            for u in 0..width {
                add(&mut row, value(v * width + u));
                let mut sum = sums[v * stride + u + 1];
                add(&mut sum, row);
                sums[(v + 1) * stride + u + 1] = sum;
            }
        }
        Self { stride, sums }
    }

    /// The sums over the pixels with column in `us` and row in `vs`, which lie inside the image.
    #[inline]
    pub fn sum(&self, us: Range<usize>, vs: Range<usize>) -> [f64; K] {
        let corner = |u: usize, v: usize| &self.sums[v * self.stride + u];
        let (a, b) = (corner(us.start, vs.start), corner(us.end, vs.start));
        let (c, d) = (corner(us.start, vs.end), corner(us.end, vs.end));
        std::array::from_fn(|k| (d[k] - b[k]) - (c[k] - a[k]))
    }
}

#[inline]
fn add<const K: usize>(sum: &mut [f64; K], value: [f64; K]) {
    sum.iter_mut().zip(value).for_each(|(s, x)| s.add_assign(x));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_sum_is_the_brute_force_one(
            width in 1_usize..12, height in 1_usize..12, a in 0_usize..12, b in 0_usize..12, c in 0_usize..12, d in 0_usize..12,
        ) {
            let shape = Raster::filled(width, height, ()).unwrap();
            let value = |i: usize| [(i * i % 17) as f64, 1.0];
            let integral = IntegralImage::new(&shape, value);
            let (us, vs) = (a.min(b).min(width)..a.max(b).min(width), c.min(d).min(height)..c.max(d).min(height));
            let mut brute = [0.0; 2];
            for v in vs.clone() {
                for u in us.clone() {
                    add(&mut brute, value(v * width + u));
                }
            }
            prop_assert_eq!(integral.sum(us, vs), brute);
        }
    }
}
