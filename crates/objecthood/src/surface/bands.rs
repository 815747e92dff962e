//! Bands along the borders of the image in which the sensor measures nothing (ours: registering depth to colour leaves them).

use std::fmt;

use crate::raster::Raster;

/// A column or row belongs to a band without depth when less than this share of it has depth.
const LEAST_MEASURED: f64 = 0.02;
/// A band is at most this share of the image. If more is without depth, as with the sky, nothing there is in
/// reach.
const WIDEST: f64 = 0.15;
/// Narrower bands, which most registered depth has, are not reported: this share of the image.
const LEAST_TOLD: f64 = 0.03;

/// How wide the bands without depth are (px); 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bands {
    /// Columns along the left border.
    pub left: usize,
    /// Columns along the right border.
    pub right: usize,
    /// Rows along the upper border.
    pub top: usize,
    /// Rows along the lower border.
    pub bottom: usize,
}

impl Bands {
    /// The bands of a depth image. A pixel that is not above 0 has no depth. O(pixels of the bands), and no
    /// memory.
    pub fn of(depth: &Raster<f32>) -> Self {
        let (width, height) = depth.size();
        let measured = |u: usize, v: usize| depth[v * width + u] > 0.0;
        let column = |u: usize| (0..height).filter(|&v| measured(u, v)).count();
        let row = |v: usize| (0..width).filter(|&u| measured(u, v)).count();
        Self {
            left: empty_lines((0..width).map(column), height),
            right: empty_lines((0..width).rev().map(column), height),
            top: empty_lines((0..height).map(row), width),
            bottom: empty_lines((0..height).rev().map(row), width),
        }
    }

    /// The bands, if one of them is wide enough to be reported.
    pub(crate) fn told(self, (width, height): (usize, usize)) -> Option<Self> {
        let is_wide = |band: usize, length: usize| band as f64 >= LEAST_TOLD * length as f64;
        let Self { left, right, top, bottom } = self;
        (is_wide(left.max(right), width) || is_wide(top.max(bottom), height)).then_some(self)
    }
}

impl fmt::Display for Bands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { left, right, top, bottom } = *self;
        let bands = [
            (left, "columns on the left"),
            (right, "columns on the right"),
            (top, "rows at the top"),
            (bottom, "rows at the bottom"),
        ];
        let named = bands.into_iter().filter(|&(px, _)| px > 0).map(|(px, place)| format!("{px} {place}"));
        f.write_str(&named.collect::<Vec<_>>().join(", "))
    }
}

/// How many lines of pixels, each so long, are empty before the first that is not; 0 where that is more than a band. `counts`: the pixels with
/// depth of each line, from the border inwards.
fn empty_lines(counts: impl ExactSizeIterator<Item = usize>, length: usize) -> usize {
    let widest = (WIDEST * counts.len() as f64) as usize;
    let is_empty = |&count: &usize| (count as f64) < LEAST_MEASURED * length as f64;
    let empty = counts.take(widest + 1).take_while(is_empty).count();
    if empty <= widest { empty } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (usize, usize) = (640, 480);

    fn bands(has_depth: impl Fn(usize, usize) -> bool) -> Bands {
        let depth = |k: usize| if has_depth(k % 640, k / 640) { 1.0 } else { f32::NAN };
        Bands::of(&Raster::from_vec(640, 480, (0..640 * 480).map(depth).collect()).unwrap())
    }

    #[test]
    fn a_band_without_depth_is_measured_and_told() {
        assert_eq!(bands(|_, _| true), Bands::default());
        let registered = bands(|u, v| u < 600 && v >= 12);
        assert_eq!(registered, Bands { right: 40, top: 12, ..Bands::default() });
        assert_eq!(registered.told(SIZE), Some(registered));
        assert_eq!(registered.to_string(), "40 columns on the right, 12 rows at the top");
        assert_eq!(bands(|u, _| u >= 8).told(SIZE), None, "as most registered depth has it");
    }

    #[test]
    fn what_is_out_of_reach_is_no_band() {
        assert_eq!(bands(|_, v| v > 200), Bands::default());
        assert_eq!(bands(|_, _| false), Bands::default());
    }
}
