//! Where regions end, and how many boundary pixels of one region lie near those of another (docs/EVALUATION.md, Metrics).

use crate::contingency::Classes;

/// The boundary pixels of every region of `classes`, an image of `width` columns, as ascending pixel indices.
///
/// A pixel is on the boundary of a region if its right, lower or lower-right neighbour differs from it in being in
/// the region. In the last row only the right neighbour is asked, in the last column only the lower one, and the
/// last corner is never on a boundary. So at most four regions have a boundary at a pixel, and one pass finds all.
pub(crate) fn boundaries(classes: &Classes, width: usize) -> Vec<Vec<u32>> {
    let mut found = vec![Vec::new(); classes.len()];
    let at = &classes.at;
    let height = at.len() / width;
    for i in 0..at.len() {
        let right = i % width + 1 < width;
        let lower = i / width + 1 < height;
        let here = at[i];
        let seen = match (right, lower) {
            (true, true) => [here, at[i + 1], at[i + width], at[i + width + 1]],
            (true, false) => [here, at[i + 1], here, here],
            (false, true) => [here, at[i + width], here, here],
            (false, false) => continue,
        };
        if seen.iter().all(|&class| class == here) {
            continue;
        }
        for (k, &class) in seen.iter().enumerate() {
            if class != Classes::NONE && !seen[..k].contains(&class) {
                found[class as usize].push(i as u32);
            }
        }
    }
    found
}

/// Counts pixels within a radius of others. Reused from pair to pair, because an image has many small boundaries.
pub(crate) struct Nearness {
    width: usize,
    /// Half the length of each row of the disk x² + y² <= r², from y = -r to y = r.
    half_widths: Vec<usize>,
    /// The last round in which each pixel was near a marked one.
    near_in: Vec<u32>,
    round: u32,
}

impl Nearness {
    /// For an image of `width` x `height` pixels, with a radius of 0.3 % of its diagonal, rounded up.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        let radius = (0.003 * (height as f64).hypot(width as f64)).ceil() as usize;
        let half_widths = (0..=2 * radius).map(|row| {
            let y = row.abs_diff(radius);
            (radius * radius - y * y).isqrt()
        });
        Self { width, half_widths: half_widths.collect(), near_in: vec![0; width * height], round: 0 }
    }

    /// How many of `pixels` lie within the radius of one of `others`. O(len · radius).
    pub(crate) fn count(&mut self, pixels: &[u32], others: &[u32]) -> usize {
        self.round += 1;
        let height = self.near_in.len() / self.width;
        let radius = self.half_widths.len() / 2;
        for &other in others {
            let (u, v) = (other as usize % self.width, other as usize / self.width);
            for (row, half) in (v..).zip(&self.half_widths) {
                // `row` is radius too large, so that it does not go below zero.
                if (radius..height + radius).contains(&row) {
                    let start = (row - radius) * self.width;
                    let (left, right) = (u.saturating_sub(*half), (u + half).min(self.width - 1));
                    self.near_in[start + left..=start + right].fill(self.round);
                }
            }
        }
        pixels.iter().filter(|&&i| self.near_in[i as usize] == self.round).count()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The boundary map of score.py: shifted copies of the mask, compared, with the last row and column redone.
    fn boundary_by_definition(mask: &dyn Fn(usize, usize) -> bool, width: usize, height: usize) -> Vec<u32> {
        let e = |u, v| u + 1 < width && mask(u + 1, v);
        let s = |u, v| v + 1 < height && mask(u, v + 1);
        let se = |u, v| u + 1 < width && v + 1 < height && mask(u + 1, v + 1);
        let mut b = vec![false; width * height];
        for v in 0..height {
            for u in 0..width {
                let m = mask(u, v);
                b[v * width + u] = (m ^ e(u, v)) | (m ^ s(u, v)) | (m ^ se(u, v));
            }
        }
        for u in 0..width {
            b[(height - 1) * width + u] = mask(u, height - 1) ^ e(u, height - 1);
        }
        for v in 0..height {
            b[v * width + width - 1] = mask(width - 1, v) ^ s(width - 1, v);
        }
        b[width * height - 1] = false;
        (0..b.len()).filter(|&i| b[i]).map(|i| i as u32).collect()
    }

    fn image() -> impl Strategy<Value = (usize, usize, Vec<Option<u32>>)> {
        (1_usize..12, 1_usize..12).prop_flat_map(|(w, h)| {
            (Just(w), Just(h), prop::collection::vec(prop::option::of(0_u32..3), w * h))
        })
    }

    proptest! {
        #[test]
        fn boundaries_are_those_of_each_mask((width, height, labels) in image()) {
            let classes = Classes::of(labels.len(), |i| labels[i]);
            let all = boundaries(&classes, width);
            for (k, &label) in classes.labels.iter().enumerate() {
                let mask = |u: usize, v: usize| labels[v * width + u] == Some(label);
                prop_assert_eq!(&all[k], &boundary_by_definition(&mask, width, height));
            }
        }

        #[test]
        fn near_is_what_the_distance_says(
            width in 1_usize..40,
            height in 1_usize..40,
            // A radius of 1 would be all of a small image, so the image pretends to be larger.
            radius in 0_usize..6,
            picks in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>()), 1..30),
        ) {
            let mut nearness = Nearness::new(width, height);
            nearness.half_widths =
                (0..=2 * radius).map(|k| (radius * radius - k.abs_diff(radius).pow(2)).isqrt()).collect();
            let mut sides = [Vec::new(), Vec::new()];
            for (pick, side) in &picks {
                sides[usize::from(*side)].push(pick.index(width * height) as u32);
            }
            let near = |a: u32, b: u32| {
                let (a, b) = (a as usize, b as usize);
                let (du, dv) = ((a % width).abs_diff(b % width), (a / width).abs_diff(b / width));
                du * du + dv * dv <= radius * radius
            };
            // Twice, in both directions: nothing may be left of the round before.
            for [pixels, others] in [[0, 1], [1, 0], [0, 1]] {
                let (pixels, others) = (&sides[pixels], &sides[others]);
                let expected = pixels.iter().filter(|&&p| others.iter().any(|&o| near(p, o))).count();
                prop_assert_eq!(nearness.count(pixels, others), expected);
            }
        }
    }

    #[test]
    fn the_radius_is_three_pixels_at_vga() {
        assert_eq!(Nearness::new(640, 480).half_widths, [0, 2, 2, 3, 2, 2, 0]);
        assert_eq!(Nearness::new(1, 1).half_widths, [0, 1, 0]);
    }
}
