//! The pixels of the depth camera that saw a list of points, where the points still tell them.
//!
//! x/z of the points of one column of an image are equal but for rounding, and those of neighbouring columns differ by
//! 1/fx; the same holds for y/z and rows. So the sorted values stand in heaps at even distances, whatever the order of the points and
//! however many are missing.

use objecthood::Camera;

use super::{GridCamera, focal, is_valid};
use crate::capture::Pose;

/// How far apart the values of one heap may be: from the rounding of 32-bit floats to that of text with four digits.
const HEAP_GAPS: [f64; 4] = [1e-6, 1e-5, 4e-5, 1.6e-4];
/// A heap must be narrower than this share of the distance of heaps, or the next heap is not told from it.
const GAP_SHARE: f64 = 0.2;
/// Fewer columns or rows are a coincidence.
const LEAST_LINES: usize = 8;
/// Points miss their pixels by no more than this (px, root mean square). Points anywhere miss them by 0.29.
const MAX_MISS_PX: f64 = 0.05;
/// Most neighbours of pixels with a point that have none. What is missing more is a list that was thinned out.
const MAX_EMPTY_SHARE: f64 = 0.25;

/// The camera on whose pixels the points stand, if there is one. O(points).
pub(super) fn find(
    points_m: &[[f32; 3]],
    sample: &[[f32; 3]],
    pose: Pose,
    max_pixels: usize,
) -> Option<GridCamera> {
    let slopes = |axis: usize| {
        let slope = move |&point: &[f32; 3]| slopes_of(pose.to_camera(point)).map(|slopes| slopes[axis]);
        let mut slopes: Vec<f64> = sample.iter().filter_map(slope).collect();
        slopes.sort_unstable_by(f64::total_cmp);
        Comb::of(&slopes)
    };
    let combs = [slopes(0)?, slopes(1)?];
    let mut lines = [Lines::default(); 2];
    for slopes in points_m.iter().filter_map(|&point| slopes_of(pose.to_camera(point))) {
        lines.iter_mut().zip(combs).zip(slopes).for_each(|((lines, comb), slope)| lines.add(comb, slope));
    }
    if lines.iter().any(|lines| lines.miss_px() > MAX_MISS_PX) {
        return None;
    }
    let [(width, cx), (height, cy)] = [lines[0].around(combs[0].phase)?, lines[1].around(combs[1].phase)?];
    let camera = Camera::new(combs[0].focal_px, combs[1].focal_px, cx, cy).ok()?;
    let grid = GridCamera { camera, size: Some((width, height)) };
    let is_small = width.checked_mul(height).is_some_and(|pixels| pixels <= focal::most_pixels(max_pixels));
    (is_small && focal::empty_share(points_m, pose, &grid) <= MAX_EMPTY_SHARE).then_some(grid)
}

/// x/z and y/z of a point in front of the camera.
fn slopes_of(point: [f32; 3]) -> Option<[f64; 2]> {
    let [x, y, z] = point.map(f64::from);
    is_valid(point).then(|| [x / z, y / z])
}

/// Columns or rows: those at slope `s` have the number `focal_px` · s + `phase`.
#[derive(Clone, Copy, Debug)]
struct Comb {
    focal_px: f64,
    phase: f64,
}

impl Comb {
    /// The comb of sorted slopes, if they stand in one.
    fn of(slopes: &[f64]) -> Option<Self> {
        HEAP_GAPS.iter().find_map(|&gap| Self::of_heaps(&heaps(slopes, gap), gap))
    }

    fn of_heaps(heaps: &[f64], heap_gap: f64) -> Option<Self> {
        if heaps.len() < LEAST_LINES {
            return None;
        }
        let mut steps: Vec<f64> = heaps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = steps.len() / 2;
        let step = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        if heap_gap > GAP_SHARE * step {
            return None;
        }
        let mut number = 0.0;
        let mut numbers = vec![0.0];
        for pair in heaps.windows(2) {
            number += ((pair[1] - pair[0]) / step).round();
            numbers.push(number);
        }
        let count = heaps.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (mean_slope, mean_number) = (mean(heaps), mean(&numbers));
        let pairs = || heaps.iter().zip(&numbers).map(|(s, n)| (s - mean_slope, n - mean_number));
        let focal_px = pairs().map(|(s, n)| s * n).sum::<f64>() / pairs().map(|(s, _)| s * s).sum::<f64>();
        let miss = pairs().map(|(s, n)| (focal_px * s - n).powi(2)).sum::<f64>() / count;
        let phase = (mean_number - focal_px * mean_slope).rem_euclid(1.0);
        (miss.sqrt() <= MAX_MISS_PX).then_some(Self { focal_px, phase })
    }
}

/// The middles of the heaps of sorted values.
fn heaps(sorted: &[f64], gap: f64) -> Vec<f64> {
    let chunks = sorted.chunk_by(|a, b| b - a <= gap);
    chunks.map(|heap| heap.iter().sum::<f64>() / heap.len() as f64).collect()
}

/// Which columns or rows hold points, and how far the points are off.
#[derive(Clone, Copy, Debug, Default)]
struct Lines {
    points: usize,
    squares_px2: f64,
    range: Option<(f64, f64)>,
}

impl Lines {
    fn add(&mut self, comb: Comb, slope: f64) {
        let place = comb.focal_px * slope + comb.phase;
        let line = place.round();
        self.points += 1;
        self.squares_px2 += (place - line).powi(2);
        let (first, last) = self.range.unwrap_or((line, line));
        self.range = Some((first.min(line), last.max(line)));
    }

    fn miss_px(&self) -> f64 {
        (self.squares_px2 / self.points as f64).sqrt()
    }

    /// How many lines an image has that shows all of them and whose middle is the principal point, and its place there.
    fn around(&self, phase: f64) -> Option<(usize, f64)> {
        let (first, last) = self.range?;
        let mirror = (2.0 * phase).round();
        let (least, most) = (first.min(mirror - last), last.max(mirror - first));
        let count = most - least + 1.0;
        (count < f64::from(u16::MAX)).then_some((count as usize, phase - least))
    }
}
