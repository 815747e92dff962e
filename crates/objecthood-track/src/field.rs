//! The part of the image in which the sensor measures depth (ours: registering depth to colour leaves bands without any).

use objecthood::Frame;
use objecthood::surface::bands::Bands;

/// The edge of depth beside a band is ragged by this many pixels (px at VGA size).
const RAGGED_PX: f64 = 4.0;

/// The first and last columns and rows that count as the border of the image, where things enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Field {
    /// O(n).
    pub(crate) fn of(frame: &Frame) -> Self {
        let (width, height) = frame.size();
        let Bands { left, right, top, bottom } = Bands::of(frame.depth_m());
        let ragged = ((RAGGED_PX * width as f64 / 640.0 + 0.5) as usize).max(1);
        let within = |[first, last]: [usize; 2], length: usize| {
            let border = |band: usize| if band > 0 { (band + ragged).min(length / 4) } else { 0 };
            (border(first), length - 1 - border(last))
        };
        Self { columns: within([left, right], width), rows: within([top, bottom], height) }
    }

    /// Whether a pixel lies in the part of the image that has depth.
    pub(crate) fn has(&self, u: usize, v: usize) -> bool {
        let within = |(first, last): (usize, usize), x: usize| (first..=last).contains(&x);
        within(self.columns, u) && within(self.rows, v)
    }

    /// Whether a pixel lies at most this far from the border, or beyond it.
    pub(crate) fn is_border(&self, u: usize, v: usize, reach_px: usize) -> bool {
        let at = |(first, last): (usize, usize), x: usize| x <= first + reach_px || x + reach_px >= last;
        at(self.columns, u) || at(self.rows, v)
    }
}

#[cfg(test)]
mod tests {
    use objecthood::{Camera, Raster};

    use super::*;

    #[test]
    fn a_band_without_depth_is_no_part_of_the_field() {
        let at = |holds: &dyn Fn(usize, usize) -> bool| -> Field {
            let depth = |k: usize| if holds(k % 640, k / 640) { 1.0 } else { f32::NAN };
            let depth = Raster::from_vec(640, 480, (0..640 * 480).map(depth).collect()).unwrap();
            Field::of(&Frame::new(depth, None, Camera::new(525.0, 525.0, 319.5, 239.5).unwrap()).unwrap())
        };
        let whole = at(&|_, _| true);
        assert!(whole.is_border(0, 9, 0) && !whole.is_border(1, 9, 0) && whole.is_border(1, 9, 1));
        assert!(whole.is_border(639, 9, 0) && whole.is_border(9, 479, 0));
        let registered = at(&|u, _| u < 600);
        assert!(registered.is_border(596, 9, 0) && !registered.is_border(590, 9, 0));
        let before_the_sky = at(&|_, v| v > 200);
        assert!(!before_the_sky.is_border(300, 201, 0));
    }
}
