//! How far the colour image is shifted against the depth: edges of depth are moved over the colour until it changes most along them.

use objecthood::Frame;
use serde::Serialize;

use super::{Cause, Certainty, Finding};

/// Shifts that are tried, to either side (px).
const MOST_PX: i32 = 16;

/// Neighbours whose depths differ by more than this share are an edge.
const EDGE: f32 = 0.04;

/// Neighbours may have this much between them without depth, as a share of the row: the shadow beside an edge.
const SHADOW: f64 = 0.025;

/// Every so many rows are looked at.
const ROW_STEP: usize = 2;

/// Changes of colour (sum of three channels) count up to this.
const MOST_CHANGE: u32 = 120;

/// With fewer edges nothing is said.
const FEWEST: u64 = 300;

/// Where edges fit, colour must change by this share more than it does anywhere near, to tell a shift at all; and for that to be sure.
const TELLS: f64 = 0.15;
const IS_SURE: f64 = 0.5;

/// Real cameras are registered within this (px at 640 columns): a calibration is off by 2 to 4, a Kinect's by 4.
const USUAL_PX: f64 = 4.5;

/// That width.
const USUAL_OF_PX: f64 = 640.0;

/// A shift has to explain this share of what could be gained.
const GAIN: f64 = 0.7;

/// Number of shifts.
const COUNT: usize = 2 * MOST_PX as usize + 1;

/// Change of colour at the edges of the frames so far, by shift: along the rows and along the columns.
#[derive(Debug, Default)]
pub(super) struct Registration {
    along: [Curve; 2],
}

#[derive(Clone, Copy, Debug)]
struct Curve {
    /// Sum of changes of colour at each shift, and how many there are.
    sums: [(u64, u64); COUNT],
}

impl Default for Curve {
    fn default() -> Self {
        Self { sums: [(0, 0); COUNT] }
    }
}

/// How far the colour lies from the depth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shift {
    /// To the right and down, where the edges tell (px).
    pub shift_px: [Option<i32>; 2],
    /// Whether that is more than cameras are off.
    pub is_unusual: bool,
    /// Whether the edges tell it clearly.
    pub is_clear: bool,
}

impl Registration {
    /// Looks at the edges of a frame with colour. O(n) for n pixels.
    pub(super) fn look(&mut self, frame: &Frame) {
        let Some(color) = frame.color() else { return };
        let (width, height) = frame.size();
        let [rows, columns] = &mut self.along;
        for v in (0..height).step_by(ROW_STEP) {
            rows.look(
                width,
                |u| frame.depth_m().as_slice()[v * width + u],
                |u| color.as_slice()[v * width + u],
            );
        }
        for u in (0..width).step_by(ROW_STEP) {
            columns.look(
                height,
                |v| frame.depth_m().as_slice()[v * width + u],
                |v| color.as_slice()[v * width + u],
            );
        }
    }

    /// Where the colour of images of this width lies; `None` where edges do not tell.
    pub(super) fn shift(&self, width: usize) -> Option<Shift> {
        let best = self.along.each_ref().map(Curve::best);
        if best.iter().all(Option::is_none) {
            return None;
        }
        let usual_px = USUAL_PX * width as f64 / USUAL_OF_PX;
        let is_off = |best: &&Best| f64::from(best.shift_px.abs()) > usual_px.max(2.5) && best.gain > GAIN;
        let off: Vec<&Best> = best.iter().flatten().filter(is_off).collect();
        Some(Shift {
            shift_px: best.each_ref().map(|best| best.as_ref().map(|best| best.shift_px)),
            is_unusual: !off.is_empty(),
            is_clear: off.iter().any(|best| best.contrast > IS_SURE),
        })
    }
}

impl Shift {
    /// The finding that the colour is shifted, if it is.
    pub(super) fn finding(&self) -> Option<Finding> {
        let [right, down] = self.shift_px.map(|px| px.unwrap_or(0));
        let certainty = if self.is_clear { Certainty::Sure } else { Certainty::Suspect };
        let reason = format!(
            "edges of the colour image lie {right} px to the right of those of the depth and {down} px below them: the images are not registered to each other"
        );
        self.is_unusual.then(|| Finding::new(certainty, Cause::Registration, reason))
    }
}

/// The shift at which colour changes most.
struct Best {
    shift_px: i32,
    /// How much more it changes there than in the middle of all shifts, as a share.
    contrast: f64,
    /// How much of that would be gained from no shift on.
    gain: f64,
}

impl Curve {
    /// Looks at one row or column of pixels.
    fn look(&mut self, length: usize, depth: impl Fn(usize) -> f32, color: impl Fn(usize) -> [u8; 3]) {
        let shadow = (SHADOW * length as f64) as usize + 1;
        let (mut before, mut z_before) = (0, f32::NAN);
        for at in 0..length {
            let z = depth(at);
            if z.is_nan() {
                continue;
            }
            // Nothing is more than a depth that is missing.
            if (z - z_before).abs() > EDGE * z.max(z_before) && at - before <= shadow {
                self.add(if z < z_before { at } else { before }, length, &color);
            }
            (before, z_before) = (at, z);
        }
    }

    fn add(&mut self, edge: usize, length: usize, color: impl Fn(usize) -> [u8; 3]) {
        for (shift, (sum, count)) in (-MOST_PX..).zip(&mut self.sums) {
            let at = edge as i64 + i64::from(shift);
            if at < 1 || at + 1 >= length as i64 {
                continue;
            }
            let (left, right) = (color(at as usize - 1), color(at as usize + 1));
            let change: u32 = left.iter().zip(right).map(|(&a, b)| u32::from(a.abs_diff(b))).sum();
            *sum += u64::from(change.min(MOST_CHANGE));
            *count += 1;
        }
    }

    fn best(&self) -> Option<Best> {
        if self.sums[MOST_PX as usize].1 < FEWEST {
            return None;
        }
        let means = self.sums.map(|(sum, count)| sum as f64 / count.max(1) as f64);
        // An edge of a picture is three pixels wide.
        let smooth: Vec<f64> = means.windows(3).map(|three| three.iter().sum::<f64>() / 3.0).collect();
        let (k, most) = smooth.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut sorted = smooth.clone();
        sorted.sort_by(f64::total_cmp);
        let usual = sorted[sorted.len() / 2];
        let contrast = (most - usual) / usual.max(1.0);
        let gain = (most - smooth[MOST_PX as usize - 1]) / (most - usual).max(f64::MIN_POSITIVE);
        (contrast > TELLS).then_some(Best { shift_px: k as i32 + 1 - MOST_PX, contrast, gain })
    }
}

#[cfg(test)]
mod tests {
    use objecthood::{Camera, Raster};

    use super::*;

    /// Boxes before a wall, their colour seen `shift` px further right.
    fn boxes(shift: usize) -> Frame {
        let is_box = |u: usize, v: usize| u / 40 % 2 == 1 && v / 30 % 2 == 1;
        let (width, height) = (320, 240);
        let pixels = || (0..width * height).map(|i| (i % width, i / width));
        let depth = pixels().map(|(u, v)| if is_box(u, v) { 1.0 } else { 1.5 }).collect();
        let paint = |(u, v): (usize, usize)| {
            if is_box((u + width - shift) % width, v) {
                [180, 40, 40]
            } else {
                [60 + (u * v % 7) as u8, 90, 90]
            }
        };
        let color = Raster::from_vec(width, height, pixels().map(paint).collect()).unwrap();
        let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
        Frame::new(Raster::from_vec(width, height, depth).unwrap(), Some(color), camera).unwrap()
    }

    #[test]
    fn a_shift_is_told_and_small_ones_are_usual() {
        for (shift, is_told) in [(0, false), (2, false), (4, true), (8, true), (12, true)] {
            let mut registration = Registration::default();
            registration.look(&boxes(shift));
            let told = registration.shift(320).unwrap();
            assert!((told.shift_px[0].unwrap() - shift as i32).abs() <= 1, "{shift}: {told:?}");
            assert_eq!(told.finding().is_some(), is_told, "{shift}: {told:?}");
        }
    }

    #[test]
    fn without_edges_nothing_is_told() {
        let camera = Camera::new(262.5, 262.5, 159.5, 119.5).unwrap();
        let frame = Frame::new(
            Raster::filled(320, 240, 1.0).unwrap(),
            Some(Raster::filled(320, 240, [7; 3]).unwrap()),
            camera,
        );
        let mut registration = Registration::default();
        registration.look(&frame.unwrap());
        assert_eq!(registration.shift(320), None);
    }
}
