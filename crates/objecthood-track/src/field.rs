//! The part of the image in which the sensor measures depth (ours: registering depth to colour leaves bands without any).

/// A column or row belongs to a band without depth when less than this share of it has depth.
const LEAST_MEASURED: f64 = 0.02;
/// A band is at most this share of the image: where more is without depth, such as before the sky, nothing is in reach.
const WIDEST: f64 = 0.15;
/// The edge of depth beside a band is ragged by so many pixels (px at VGA size).
const RAGGED_PX: f64 = 4.0;

/// The first and last columns and rows that count as the border of the image, from where things enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Field {
    /// O(n).
    pub(crate) fn of(inverse: &[f32], size: (usize, usize)) -> Self {
        let (width, height) = size;
        let (mut columns, mut rows) = (vec![0_usize; width], vec![0_usize; height]);
        for (v, row) in inverse.chunks_exact(width.max(1)).enumerate() {
            for (u, _) in row.iter().enumerate().filter(|&(_, &inverse)| inverse > 0.0) {
                columns[u] += 1;
                rows[v] += 1;
            }
        }
        let ragged = ((RAGGED_PX * width as f64 / 640.0 + 0.5) as usize).max(1);
        let within = |counts: &[usize], length: usize| {
            let least = LEAST_MEASURED * length as f64;
            let band = |empty: usize| match empty as f64 <= WIDEST * counts.len() as f64 {
                true if empty > 0 => (empty + ragged).min(counts.len() / 4),
                _ => 0,
            };
            let is_empty = |count: &&usize| (**count as f64) < least;
            let first = band(counts.iter().take_while(is_empty).count());
            let last = band(counts.iter().rev().take_while(is_empty).count());
            (first, counts.len() - 1 - last)
        };
        Self { columns: within(&columns, height), rows: within(&rows, width) }
    }

    /// Whether a pixel lies in the part of the image that has depth.
    pub(crate) fn has(&self, u: usize, v: usize) -> bool {
        let within = |(first, last): (usize, usize), x: usize| (first..=last).contains(&x);
        within(self.columns, u) && within(self.rows, v)
    }

    /// Whether a pixel lies at most so far from the border, or beyond it.
    pub(crate) fn is_border(&self, u: usize, v: usize, reach_px: usize) -> bool {
        let at = |(first, last): (usize, usize), x: usize| x <= first + reach_px || x + reach_px >= last;
        at(self.columns, u) || at(self.rows, v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_without_depth_is_no_part_of_the_field() {
        let size = (640, 480);
        let at = |holds: &dyn Fn(usize, usize) -> bool| -> Field {
            let inverse: Vec<f32> =
                (0..640 * 480).map(|k| if holds(k % 640, k / 640) { 1.0 } else { 0.0 }).collect();
            Field::of(&inverse, size)
        };
        let whole = at(&|_, _| true);
        assert!(whole.is_border(0, 9, 0) && !whole.is_border(1, 9, 0) && whole.is_border(1, 9, 1));
        assert!(whole.is_border(639, 9, 0) && whole.is_border(9, 479, 0));
        let registered = at(&|u, _| u < 600);
        assert!(registered.is_border(596, 9, 0) && !registered.is_border(590, 9, 0));
        let before_the_sky = at(&|_, v| v > 200);
        assert!(!before_the_sky.is_border(300, 201, 0));
        assert_eq!(at(&|_, _| false), whole);
    }
}
