//! Lines of sight: the pixels on the line between two pixels.

/// The pixels nearest to the line between two pixels, without its ends: one pixel for each step along the longer side.
pub(super) struct Line {
    /// Column and row of the last pixel plus half a pixel, in units of 2^-32 px.
    at: [i64; 2],
    /// Step from one pixel to the next, rounded up, so that an exact half is rounded to the greater column or row.
    step: [i64; 2],
    /// Number of pixels left.
    pub(super) steps: usize,
}

impl Line {
    pub(super) fn between([from, to]: [[i64; 2]; 2]) -> Self {
        let reach = [0, 1].map(|k| to[k] - from[k]);
        let steps = reach[0].abs().max(reach[1].abs()).max(1);
        Self {
            at: from.map(|x| (x << 32) + (1 << 31)),
            step: reach.map(|reach| -((-reach << 32).div_euclid(steps))),
            steps: steps as usize - 1,
        }
    }
}

impl Iterator for Line {
    type Item = [usize; 2];

    fn next(&mut self) -> Option<[usize; 2]> {
        self.steps = self.steps.checked_sub(1)?;
        self.at = [0, 1].map(|k| self.at[k] + self.step[k]);
        Some(self.at.map(|x| (x >> 32) as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_through_the_nearest_pixels() {
        let from = [17_i64, 9];
        for to in (0..40 * 40).map(|k| [k % 40, k / 40]) {
            let reach = [0, 1].map(|k| (to[k] - from[k]) as f64);
            let steps = reach[0].abs().max(reach[1].abs());
            let nearest =
                |t: usize| [0, 1].map(|k| (from[k] as f64 + reach[k] * t as f64 / steps).round() as usize);
            let expected: Vec<_> = (1..steps as usize).map(nearest).collect();
            assert_eq!(Line::between([from, to]).collect::<Vec<_>>(), expected, "to {to:?}");
        }
    }
}
