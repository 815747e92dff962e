//! Ramps: edges that are smeared over several pixels, along one row or column (docs/CONTEXT.md 0.7).

use std::ops::Range;

use crate::surface::disparity::DisparitySpace;

/// A ramp spans at least this many quanta. Smaller steps are shallower than the surfaces of things.
const LEAST_CHANGE_QUANTA: f32 = 12.0;
/// A ramp starts where the slope is at least this (quanta/px at a focal length of 525 px).
const LEAST_SLOPE: f64 = 1.5;
/// It reaches at most this far from its steepest place (px at a focal length of 525 px) ...
const REACH_PX: usize = 10;
/// ... and ends where its slope falls below this share of the steepest, or rises again.
const END_SHARE: f32 = 0.1;
/// A rise of the slope, as a share and in quanta/px, that counts as rounding.
const RISE: (f32, f32) = (0.05, 0.1);
/// Pixels at either end from which the surface there is continued (px at a focal length of 525 px).
const END_PX: usize = 4;
/// A surface that goes on beyond the end with more than this share of the ramp's mean slope is a steep face, and no ramp.
const FACE_SHARE: f32 = 0.67;
/// A slope beyond the end that exceeds this share of the ramp's mean slope belongs to the ramp, and is not
/// continued.
const CONTINUED_SHARE: f32 = 0.33;
/// Colours at both ends that differ by less than this (sum over the three channels, of 765) do not tell where the edge is.
const LEAST_CONTRAST: f32 = 120.0;
/// The cost of each pixel between the edge and the middle of the depth; a pixel of the wrong colour costs 1.
const AWAY_COST: f32 = 0.2;

/// A row or column of an image.
pub(super) struct Line<'a> {
    /// Disparity (quanta); `NaN` where there is none.
    pub disparity: &'a [f32],
    /// Colour, if the frame has any.
    pub color: Option<&'a [[u8; 3]]>,
}

/// Lengths in pixels of this image.
pub(super) struct Limits {
    least_slope: f32,
    reach_px: usize,
    end_px: usize,
}

/// The value that a pixel on a ramp gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Restored {
    /// Disparity (quanta) of the surface at one end of the ramp; `NaN` for a pixel on no ramp.
    pub disparity: f32,
    /// Length of the ramp (px); infinite for a pixel on no ramp.
    pub length_px: f32,
}

impl Restored {
    /// A pixel on no ramp.
    pub(super) const NONE: Self = Self { disparity: f32::NAN, length_px: f32::INFINITY };
}

impl Limits {
    pub(super) fn of(space: &DisparitySpace) -> Self {
        Self {
            least_slope: space.slope_per_px(LEAST_SLOPE) as f32,
            reach_px: space.length_px(REACH_PX),
            end_px: space.length_px(END_PX),
        }
    }
}

impl Line<'_> {
    /// Restores the steps of a line: the pixels of every ramp take the surface before or after it. O(pixels · reach).
    pub(super) fn restore(&self, restored: &mut [Restored], limits: &Limits) {
        let last = self.disparity.len().saturating_sub(1);
        let mut at = 0;
        while at < last {
            if !self.is_steepest(at, limits) {
                at += 1;
                continue;
            }
            let (first, end) = self.ends(at, limits);
            if let Some([before, after]) = self.slopes_beyond(first, end, limits) {
                let edge = self.edge(first, end, limits);
                let length_px = (end - first) as f32;
                for (p, restored) in (first + 1..end).zip(&mut restored[first + 1..end]) {
                    let disparity = if p < edge {
                        self.disparity[first] + before * (p - first) as f32
                    } else {
                        self.disparity[end] - after * (end - p) as f32
                    };
                    *restored = Restored { disparity, length_px };
                }
            }
            at = end;
        }
    }

    /// Change from a pixel to the next (quanta).
    fn slope(&self, at: usize) -> f32 {
        self.disparity[at + 1] - self.disparity[at]
    }

    /// Whether the line is steep here, and not steeper on either side.
    fn is_steepest(&self, at: usize, limits: &Limits) -> bool {
        let slope = self.slope(at);
        let is_steeper = |other: usize| self.slope(other) * slope.signum() > slope.abs();
        let has_steeper =
            || (at > 0 && is_steeper(at - 1)) || (at + 2 < self.disparity.len() && is_steeper(at + 1));
        slope.abs() >= limits.least_slope && !has_steeper()
    }

    /// The first and the last pixel of the ramp whose steepest place this is.
    fn ends(&self, at: usize, limits: &Limits) -> (usize, usize) {
        let steepest = self.slope(at);
        let goes_on = |from: usize, to: usize| {
            let [from, to] = [from, to].map(|k| self.slope(k) * steepest.signum());
            to <= from * (1.0 + RISE.0) + RISE.1 && to > END_SHARE * steepest.abs()
        };
        let (mut first, mut end) = (at, at + 1);
        while first > 0 && at - first < limits.reach_px && goes_on(first, first - 1) {
            first -= 1;
        }
        while end + 1 < self.disparity.len() && end - at < limits.reach_px && goes_on(end - 1, end) {
            end += 1;
        }
        (first, end)
    }

    /// The slopes (quanta/px) with which the surfaces at both ends go on under the ramp; `None` when this is no ramp.
    fn slopes_beyond(&self, first: usize, end: usize, limits: &Limits) -> Option<[f32; 2]> {
        let change = self.disparity[end] - self.disparity[first];
        // One step of one pixel is an edge as it should be.
        if change.abs() < LEAST_CHANGE_QUANTA || end - first < 2 {
            return None;
        }
        let mean = change / (end - first) as f32;
        let over = |a: usize, b: usize| (self.disparity[b] - self.disparity[a]) / limits.end_px as f32;
        let before = first.checked_sub(limits.end_px).map_or(0.0, |from| over(from, first));
        let has_after = end + limits.end_px < self.disparity.len();
        let after = if has_after { over(end, end + limits.end_px) } else { 0.0 };
        let is_face = [before, after].iter().any(|slope| slope / mean > FACE_SHARE);
        let continued = |slope: f32| if (slope / mean).abs() <= CONTINUED_SHARE { slope } else { 0.0 };
        (!is_face).then(|| [before, after].map(continued))
    }

    /// The first pixel of a ramp that shows the surface behind the edge: where colour changes, or else at the
    /// middle of the depth.
    fn edge(&self, first: usize, end: usize, limits: &Limits) -> usize {
        let half = self.half(first, end);
        let Some(color) = self.color else { return half };
        let mean = |range: Range<usize>| {
            let weight = 1.0 / range.len() as f32;
            range.fold([0.0_f32; 3], |sum, p| {
                std::array::from_fn(|c| sum[c] + weight * f32::from(color[p][c]))
            })
        };
        let ends = [
            mean((first + 1).saturating_sub(limits.end_px)..first + 1),
            mean(end..(end + limits.end_px).min(color.len())),
        ];
        let apart = |a: &[f32; 3], b: &[f32; 3]| (0..3).map(|c| (a[c] - b[c]).abs()).sum::<f32>();
        let contrast = apart(&ends[0], &ends[1]);
        if contrast < LEAST_CONTRAST {
            return half;
        }
        let cost = |edge: usize| {
            let off = |p: usize| apart(&color[p].map(f32::from), &ends[usize::from(p >= edge)]);
            (first + 1..end).map(off).sum::<f32>() / contrast + AWAY_COST * edge.abs_diff(half) as f32
        };
        (first + 1..=end).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(half)
    }

    /// The first pixel of a ramp that is nearer in depth to its end than to its start.
    fn half(&self, first: usize, end: usize) -> usize {
        let d = self.disparity;
        let half = 2.0 / (1.0 / d[first] + 1.0 / d[end]);
        let is_behind = |&p: &usize| (d[p] >= half) == (d[end] >= half);
        (first + 1..end).find(is_behind).unwrap_or(end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::kinect;

    /// The line after its ramps are restored.
    fn restored(disparity: &[f32], color: Option<&[[u8; 3]]>) -> Vec<f32> {
        let mut restored = vec![Restored::NONE; disparity.len()];
        Line { disparity, color }.restore(&mut restored, &Limits::of(&kinect()));
        let value = |(r, &d): (&Restored, &f32)| if r.disparity.is_nan() { d } else { r.disparity };
        restored.iter().zip(disparity).map(value).collect()
    }

    /// 40 pixels that go from 200 to 260 quanta like a step that was smoothed.
    fn smeared(slope: f32) -> Vec<f32> {
        let step = |u: f32| 60.0 / (1.0 + (-(u - 20.0) / 1.2).exp());
        (0..40).map(|u| 200.0 + slope * u as f32 + step(u as f32)).collect()
    }

    #[test]
    fn a_smeared_step_becomes_a_step() {
        for slope in [0.0, 0.5, -0.5] {
            let line = restored(&smeared(slope), None);
            let steps = line.windows(2).filter(|pair| (pair[1] - pair[0] - slope).abs() > 4.0).count();
            assert_eq!(steps, 1, "slope {slope}: {line:?}");
            assert!(
                (line[15] - 200.0 - 15.0 * slope).abs() < 3.0
                    && (line[25] - 260.0 - 25.0 * slope).abs() < 3.0
            );
        }
    }

    #[test]
    fn the_edge_is_where_colour_changes() {
        let line = smeared(0.0);
        let color: Vec<[u8; 3]> =
            (0..40).map(|u| if u < 22 { [200, 40, 40] } else { [40, 40, 200] }).collect();
        let edge = |line: &[f32]| line.iter().position(|&d| d > 230.0);
        assert_eq!(edge(&restored(&line, Some(&color))), Some(22));
        assert_eq!(edge(&restored(&line, Some(&[[90; 3]; 40]))), edge(&restored(&line, None)), "one colour");
    }

    #[test]
    fn a_steep_face_a_sharp_step_and_a_hole_stay() {
        let face: Vec<f32> = (0..40).map(|u| 200.0 + 3.0 * u as f32).collect();
        assert_eq!(restored(&face, None), face);
        let step: Vec<f32> = (0..40).map(|u| if u < 20 { 200.0 } else { 260.0 }).collect();
        assert_eq!(restored(&step, None), step);
        let mut hole = step;
        hole[19] = f32::NAN;
        let kept: Vec<u32> = restored(&hole, None).iter().map(|d| d.to_bits()).collect();
        assert_eq!(kept, hole.iter().map(|d| d.to_bits()).collect::<Vec<_>>());
        assert!(restored(&[], None).is_empty() && restored(&[3.0], None) == [3.0]);
    }
}
