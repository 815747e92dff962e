//! The spread of samples of a facet: their first and second moments, which give the plane through them in any frame.

/// A position and its disparity (quanta).
pub(crate) type Sample = ([f64; 2], f64);

/// Means of some samples, and means of products of their deviations.
pub(crate) struct Spread {
    place: [f64; 2],
    disparity: f64,
    /// x x, x y, y y, x d and y d.
    products: [f64; 5],
}

/// A [`Spread`] in a frame that is turned, scaled and shifted: means of s, t, d and of their products about the origin.
pub(crate) struct Turned {
    /// Mean s, t and d.
    pub(crate) mean: [f64; 3],
    /// Means of s s, s t, t t, s d and t d.
    pub(crate) products: [f64; 5],
}

impl Spread {
    pub(crate) fn of(samples: &[Sample]) -> Self {
        let n = samples.len() as f64;
        let sum = samples.iter().fold([0.0; 3], |[x, y, sum], &([u, v], d)| [x + u, y + v, sum + d]);
        let [x, y, disparity] = sum.map(|sum| sum / n);
        let mut products = [0.0; 5];
        for &([u, v], d) in samples {
            let (u, v, d) = (u - x, v - y, d - disparity);
            products.iter_mut().zip([u * u, u * v, v * v, u * d, v * d]).for_each(|(sum, x)| *sum += x);
        }
        Self { place: [x, y], disparity, products: products.map(|sum| sum / n) }
    }

    /// The spread in a frame with its origin at `middle` and the first axis along `axis`; disparities are counted from `origin`. O(1).
    pub(crate) fn turned(&self, middle: [f64; 2], [a, b]: [f64; 2], origin: f64) -> Turned {
        let [x, y] = [0, 1].map(|k| self.place[k] - middle[k]);
        let (s, t, d) = (x * a + y * b, y * a - x * b, self.disparity - origin);
        let [xx, xy, yy, xd, yd] = self.products;
        let products = [
            a * a * xx + 2.0 * a * b * xy + b * b * yy + s * s,
            a * b * (yy - xx) + (a * a - b * b) * xy + s * t,
            a * a * yy - 2.0 * a * b * xy + b * b * xx + t * t,
            a * xd + b * yd + s * d,
            a * yd - b * xd + t * d,
        ];
        Turned { mean: [s, t, d], products }
    }
}
