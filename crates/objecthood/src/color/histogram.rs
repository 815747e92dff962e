//! Histograms of L\*a\*b\* colours.

/// Bins of L over 0..100, and of a and of b over -64..64; colours beyond fall into the outermost bins.
const BINS: [usize; 3] = [4, 16, 16];
/// The lowest value of each axis, and its range.
const RANGES: [[f32; 2]; 3] = [[0.0, 100.0], [-64.0, 128.0], [-64.0, 128.0]];

/// The bins from the first to the last of the eight around a colour.
const AROUND: usize = BINS[1] * BINS[2] + BINS[2] + 2;

/// How often each colour occurs. A colour between the centres of two bins counts for both, by its distance: an even surface whose
/// shading crosses the limit of a bin stays alike.
#[derive(Clone, Debug)]
pub struct ColorHistogram {
    shares: Box<[f32; BINS[0] * BINS[1] * BINS[2]]>,
    count: f32,
}

impl Default for ColorHistogram {
    fn default() -> Self {
        Self::empty()
    }
}

impl ColorHistogram {
    /// Counts colours (L\*a\*b\*). O(colours + bins).
    pub fn of(colors: impl Iterator<Item = [f32; 3]>) -> Self {
        let mut histogram = Self::empty();
        colors.for_each(|color| histogram.add(color));
        histogram
    }

    /// Of no colour. O(bins).
    pub(crate) fn empty() -> Self {
        Self { shares: Box::new([0.0; BINS[0] * BINS[1] * BINS[2]]), count: 0.0 }
    }

    /// Counts a colour. O(1).
    pub(crate) fn add(&mut self, color: [f32; 3]) {
        // On each axis the lower of the two bins, and the share of the upper one.
        let place: [(usize, f32); 3] = std::array::from_fn(|axis| {
            let [lowest, range] = RANGES[axis];
            let last = (BINS[axis] - 1) as f32;
            let at = ((color[axis] - lowest) / range * BINS[axis] as f32 - 0.5).clamp(0.0, last);
            let lower = usize::from(at as u8).min(BINS[axis] - 2);
            (lower, at - lower as f32)
        });
        let [(l, upper_l), (a, upper_a), (b, upper_b)] = place;
        let first = (l * BINS[1] + a) * BINS[2] + b;
        let shares = &mut self.shares[first..first + AROUND];
        for (of_l, share_l) in [(0, 1.0 - upper_l), (BINS[1] * BINS[2], upper_l)] {
            for (of_a, share_a) in [(0, 1.0 - upper_a), (BINS[2], upper_a)] {
                let bin = of_l + of_a;
                let share = share_l * share_a;
                shares[bin] += share * (1.0 - upper_b);
                shares[bin + 1] += share * upper_b;
            }
        }
        self.count += 1.0;
    }

    /// The sum over all bins of the smaller share (Swain and Ballard 1991): 1 for the same colours, 0 for none in common, and 0 when one
    /// of the two is empty. O(bins).
    pub fn overlap(&self, other: &Self) -> f64 {
        if self.count == 0.0 || other.count == 0.0 {
            return 0.0;
        }
        let pairs = self.shares.iter().zip(other.shares.iter());
        pairs.map(|(a, b)| f64::from((a / self.count).min(b / other.count))).sum()
    }

    /// The share of its colours that another histogram shows too, even if that shows them up to `rare` times more seldom. O(bins).
    pub(crate) fn share_in(&self, other: &Self, rare: f32) -> f64 {
        if self.count == 0.0 || other.count == 0.0 {
            return 0.0;
        }
        let pairs = self.shares.iter().zip(other.shares.iter());
        pairs.map(|(a, b)| f64::from((a / self.count).min(rare * b / other.count))).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(colors: &[[f32; 3]]) -> ColorHistogram {
        ColorHistogram::of(colors.iter().copied())
    }

    #[test]
    fn the_same_colors_overlap_wholly_and_others_not_at_all() {
        let (red, blue) = ([50.0, 60.0, 40.0], [30.0, 10.0, -60.0]);
        assert!((of(&[red, blue]).overlap(&of(&[blue, red, red, blue])) - 1.0).abs() < 1e-6);
        assert!((of(&[red, blue]).overlap(&of(&[red])) - 0.5).abs() < 1e-6);
        assert_eq!(of(&[red]).overlap(&of(&[blue])), 0.0);
        assert_eq!(of(&[red]).overlap(&of(&[])), 0.0);
    }

    #[test]
    fn a_little_shading_is_no_other_color_wherever_the_limits_of_bins_are() {
        for a in -64..64 {
            let a = a as f32;
            let overlap = of(&[[50.0, a, 0.0]]).overlap(&of(&[[51.0, a + 0.5, 0.5]]));
            assert!(overlap > 0.8, "{a}: {overlap}");
        }
    }

    #[test]
    fn colors_beyond_the_range_count_in_the_outermost_bins() {
        let overlap = of(&[[100.0, 120.0, -110.0]]).overlap(&of(&[[99.0, 64.0, -64.0]]));
        assert!(overlap > 0.9, "{overlap}");
    }
}
