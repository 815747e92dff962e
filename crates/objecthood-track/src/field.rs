//! The part of the image in which the sensor measures depth (ours: registering depth to colour leaves bands without any).

use objecthood::Frame;
use objecthood::surface::bands::Bands;
use serde::{Deserialize, Serialize};

/// The edge of depth beside a band is ragged by this many pixels (px at VGA size).
const RAGGED_PX: f64 = 4.0;

/// A field is at least as wide as the fields of the frames of this time (s) before: where the sky is behind it, a
/// thing that comes in from above seems to end a band without depth.
const REMEMBERED_S: f64 = 1.0;

/// The first and last columns and rows that count as the border of the image, where things enter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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

    /// The smallest field that contains both.
    fn united(self, other: Self) -> Self {
        let wider = |a: (usize, usize), b: (usize, usize)| (a.0.min(b.0), a.1.max(b.1));
        Self { columns: wider(self.columns, other.columns), rows: wider(self.rows, other.rows) }
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

/// The fields of the last frames.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Fields {
    /// The widest field of this period and of the one before, and when this one began (s).
    now: Option<(Field, f64)>,
    before: Option<Field>,
}

impl Fields {
    /// The field of a frame, widened by those before. One frame with a hole at its border widens it for two periods
    /// at most.
    pub(crate) fn widen(&mut self, field: Field, stamp_s: f64) -> Field {
        let (wide, since_s) = match self.now {
            Some((known, since_s)) if stamp_s - since_s < REMEMBERED_S => (known.united(field), since_s),
            known => {
                self.before = known.map(|(known, _)| known);
                (field, stamp_s)
            }
        };
        self.now = Some((wide, since_s));
        self.before.map_or(wide, |before| wide.united(before))
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
        let with_a_thing = at(&|u, v| v > 200 || v > 3 && u.abs_diff(300) < 20);
        assert!(with_a_thing.is_border(300, 4, 0));
        let mut fields = Fields::default();
        fields.widen(before_the_sky, 0.0);
        assert!(!fields.widen(with_a_thing, 0.9).is_border(300, 4, 0));
        fields.widen(registered, 2.0);
        assert_eq!(fields.widen(registered, 3.1), registered, "one frame does not open it for ever");
    }
}
