//! How clearly colour changes across a body, place by place along one of its axes.

use std::ops::Range;

use glam::DVec3;

use crate::color::{CLEAR_CONTRAST, CONTRAST, LIGHT_OFFSET, weighted};
use crate::linear::{NO_RANGE, widened};
use crate::shapes::seams::body::{Body, BodyPixel, Face};
use crate::shapes::seams::trace::Trace;
use crate::surface::disparity::DisparitySpace;

/// Places are this far apart (m), or one pixel where that is more.
const STEP_M: f64 = 0.002;
/// Colours are compared from this far on either side of a place (m), or from `GAP_PX` where that is more: nearer, both sides mix.
const GAP_M: f64 = 0.003;
/// As `GAP_M` (px at 525 px): the width of an edge in the smoothed image.
const GAP_PX: f64 = 2.0;
/// Colours are compared over this length (m), or `WINDOW_PX` where that is more, in stripes of the same width: letters are smaller.
const WINDOW_M: f64 = 0.008;
/// As `WINDOW_M` (px at 525 px): a window of 25 pixels has a fifth of the noise of one.
const WINDOW_PX: f64 = 5.0;
/// A window with fewer pixels is not judged.
const LEAST_PX: f32 = 4.0;
/// A joint is at least this far from the ends of the body and from its folds (m), as with the thinnest box
/// that is recognised by its side.
const MARGIN_M: f64 = 0.012;
/// Each side of a joint has at least this many pixels (px at 525 px), as the smallest object.
const LEAST_SIDE_PX: usize = 200;
/// A face across the axis with a smaller share of the body's pixels is no fold.
const LEAST_FOLD: f64 = 0.05;
/// L\* + 16 of middle light: from there up, differences of colours are taken as measured.
const MIDDLE_LIGHTNESS: f32 = 66.0;
/// Differences grow at most by this factor, because their noise grows too.
const MOST_GAIN: f32 = 2.0;
/// Weight of the clearness in middle light in the rank of a place: it decides only where the measured
/// clearness is 0.
const LEAST_RANK: f64 = 1e-3;
/// A place needs at least this share of the stripes that the best measured place has.
pub(super) const LEAST_MEASURED: f64 = 0.3;
/// Places that have at least this share of the greatest clearness are equally clear: the joint is in their
/// middle.
const ALIKE: f64 = 0.95;
/// This many places are proposed for each axis, the clearest first.
const MOST_TRACES: usize = 4;
/// An axis with more places is no axis of a thing.
const MOST_PLACES: usize = 2048;

/// Proposes the clearest places along an axis, the clearest first. At each, colour changes in at least this
/// share of the stripes, and both sides are large enough for an object. O(pixels + stripes · places).
pub(super) fn find_traces(body: &Body, axis: DVec3, least_share: f64, space: &DisparitySpace) -> Vec<Trace> {
    let Some(places) = Places::along(body, axis, space) else { return Vec::new() };
    let (folds, faces): (Vec<&Face>, Vec<&Face>) = body.faces.iter().partition(|face| face.is_across(axis));
    let mut contrasts: Vec<Vec<Contrast>> = vec![Vec::new(); places.count];
    faces.into_iter().for_each(|face| places.compare(face, &mut contrasts));
    let is_large = |fold: &&Face| fold.pixels.len() as f64 >= LEAST_FOLD * body.size_px() as f64;
    let folds_m: Vec<f64> =
        folds.into_iter().filter(is_large).map(|face| mean_along(axis, &face.pixels)).collect();
    let mut traces = places.clearest(&rate(&mut contrasts), &folds_m);
    let has_sides = |trace: &Trace| {
        let above = body.pixels().filter(|p| trace.is_above(p.point)).count();
        above.min(body.size_px() - above) >= space.area_px(LEAST_SIDE_PX)
    };
    traces.retain(|trace| trace.share >= least_share && has_sides(trace));
    traces
}

/// The mean place of pixels along a direction (m).
fn mean_along(axis: DVec3, pixels: &[BodyPixel]) -> f64 {
    pixels.iter().map(|p| axis.dot(p.point)).sum::<f64>() / pixels.len() as f64
}

/// How far apart the colours on both sides of a place of a stripe are (Lab, lightness weighted), without the
/// part that a gradient makes.
#[derive(Clone, Copy)]
struct Contrast {
    /// As measured.
    plain: f32,
    /// In middle light.
    in_middle_light: f32,
}

/// What the stripes of a place show; 0 if few are seen.
#[derive(Clone, Copy, Default)]
struct Rating {
    /// The share of stripes whose colour changes, and the clearness, in middle light.
    share: f64,
    clearness: f64,
    /// The median contrast, as measured.
    contrast: f64,
    /// The stripes, as a share of those of the best measured place.
    measured: f64,
    /// The measured clearness, by which the place is found. (What dim light adds differs from stripe to
    /// stripe and would shift the place.) Where no colour changes as measured, the clearness in middle light
    /// decides.
    rank: f64,
}

/// Rates the stripes of each place.
fn rate(contrasts: &mut [Vec<Contrast>]) -> Vec<Rating> {
    let most = contrasts.iter().map(Vec::len).max().unwrap_or(0);
    let rate = |contrasts: &mut Vec<Contrast>| {
        let count = contrasts.len() as f64;
        let measured = count / most as f64;
        if contrasts.is_empty() || measured < LEAST_MEASURED {
            return Rating::default();
        }
        let mut clear = |value: fn(&Contrast) -> f32| {
            let share = contrasts.iter().filter(|contrast| value(contrast) > CONTRAST).count() as f64 / count;
            contrasts.sort_by(|a, b| value(a).total_cmp(&value(b)));
            let median = f64::from(value(&contrasts[contrasts.len() / 2]));
            (share, share * (median / CLEAR_CONTRAST).min(1.0), median)
        };
        let (share, clearness, _) = clear(|contrast| contrast.in_middle_light);
        let (_, plain, contrast) = clear(|contrast| contrast.plain);
        Rating { share, clearness, contrast, measured, rank: plain + LEAST_RANK * clearness }
    };
    contrasts.iter_mut().map(rate).collect()
}

/// The factor by which differences of colour grow on a face in dim light. They become those that would be
/// seen in middle light, as far as noise allows.
fn gain(face: &Face) -> f32 {
    let light =
        face.pixels.iter().map(|pixel| pixel.color[0] + LIGHT_OFFSET).sum::<f32>() / face.pixels.len() as f32;
    (MIDDLE_LIGHTNESS / light).clamp(1.0, MOST_GAIN)
}

/// Places along an axis of a body.
struct Places {
    axis: DVec3,
    low_m: f64,
    step_m: f64,
    count: usize,
    /// Places between a joint and the windows beside it.
    gap: usize,
    /// Places that a window covers.
    window: usize,
    stripe_m: f64,
}

/// The colours of the pixels of a stripe up to a place.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: f32,
    color: [f32; 3],
}

impl Places {
    /// `None` for a body that is too short for a joint, or absurdly long.
    fn along(body: &Body, axis: DVec3, space: &DisparitySpace) -> Option<Self> {
        let (mut range_m, mut depth_m) = (NO_RANGE, 0.0);
        for pixel in body.pixels() {
            range_m = widened(range_m, axis.dot(pixel.point));
            depth_m += pixel.point.z;
        }
        let [low_m, high_m] = range_m;
        let camera = space.camera();
        let pixel_m = depth_m / body.size_px() as f64 / camera.fx_px.min(camera.fy_px);
        let step_m = STEP_M.max(pixel_m);
        let at_least_m = |m: f64, px: f64| m.max(px / space.length_at_525_px(1.0) * pixel_m);
        let places = |m: f64| (m / step_m).ceil() as usize;
        let count = places(high_m - low_m) + 1;
        (count <= MOST_PLACES && high_m - low_m > 2.0 * MARGIN_M).then(|| Self {
            axis,
            low_m,
            step_m,
            count,
            gap: places(at_least_m(GAP_M, GAP_PX)),
            window: places(at_least_m(WINDOW_M, WINDOW_PX)),
            stripe_m: at_least_m(WINDOW_M, WINDOW_PX),
        })
    }

    /// Adds the contrast at each place of each stripe of a face.
    fn compare(&self, face: &Face, contrasts: &mut [Vec<Contrast>]) {
        let across = face.normal.cross(self.axis).normalize();
        let [first_m, last_m] =
            face.pixels.iter().fold(NO_RANGE, |range_m, p| widened(range_m, across.dot(p.point)));
        // By way of 32 bits, to which a number is converted in fewer steps.
        let whole = |x: f64| x as u32 as usize;
        let stripe = |at_m: f64| whole((at_m - first_m) / self.stripe_m);
        let stripes = stripe(last_m) + 1;
        let width = self.count + 1;
        if stripes > MOST_PLACES {
            return;
        }
        let mut sums = vec![Sum::default(); stripes * width];
        for pixel in &face.pixels {
            let place = whole((self.axis.dot(pixel.point) - self.low_m) / self.step_m);
            let cell = &mut sums[stripe(across.dot(pixel.point)) * width + place.min(self.count - 1) + 1];
            cell.count += 1.0;
            (0..3).for_each(|k| cell.color[k] += pixel.color[k]);
        }
        let gain = gain(face);
        for sums in sums.chunks_mut(width) {
            for k in 1..width {
                let before = sums[k - 1];
                sums[k].count += before.count;
                (0..3).for_each(|c| sums[k].color[c] += before.color[c]);
            }
            let seen = self.seen_places(sums);
            let all = seen.clone().zip(&mut contrasts[seen]);
            all.for_each(|(k, all)| all.extend(self.contrast_at(sums, k, gain)));
        }
    }

    /// The places of a stripe, up to the last, on both sides of which there are pixels enough; none between facets of one plane that lie apart.
    fn seen_places(&self, sums: &[Sum]) -> Range<usize> {
        let enough_below = sums.partition_point(|sum| sum.count < LEAST_PX);
        let enough_above = sums.partition_point(|sum| sum.count <= sums[self.count].count - LEAST_PX);
        let end = enough_above.saturating_sub(self.gap).min(self.count);
        (enough_below + self.gap).min(end)..end
    }

    /// How far apart the colours on both sides of a place of a stripe are, without the part that a gradient
    /// makes. `None` if too little is seen.
    ///
    /// Where one colour fades into another, colour changes beside the place as it does across it. So the mean
    /// change from one window to the next, on both sides, is continued across the place and subtracted.
    fn contrast_at(&self, sums: &[Sum], place: usize, gain: f32) -> Option<Contrast> {
        let mean = |from: usize, to: usize| {
            let count = sums[to].count - sums[from].count;
            let color = std::array::from_fn(|k| (sums[to].color[k] - sums[from].color[k]) / count);
            (count >= LEAST_PX).then(|| weighted(color))
        };
        let below = |end: usize| mean(end.saturating_sub(self.window), end);
        let above = |start: usize| mean(start.min(self.count), (start + self.window).min(self.count));
        let (before, behind) = (place.checked_sub(self.gap)?, place + self.gap);
        let (low, high) = (below(before)?, above(behind)?);
        let change = high - low;
        let windows_apart = (2 * self.gap + self.window) as f32 / self.window as f32;
        let way = change.normalize_or_zero();
        let lower = before.checked_sub(self.window).and_then(below).map(|lower| low - lower);
        let higher = above(behind + self.window).map(|higher| higher - high);
        let slopes = [lower, higher].into_iter().flatten().map(|beside| way.dot(beside));
        let (sum, count) = slopes.fold((0.0, 0.0), |(sum, count), slope| (sum + slope, count + 1.0));
        let gradient = sum / f32::max(count, 1.0);
        let plain = (change.length() - (gradient * windows_apart).max(0.0)).max(0.0);
        Some(Contrast { plain, in_middle_light: plain * gain })
    }

    /// The clearest places that are a window apart, if they lie a margin from the ends and from folds.
    fn clearest(&self, rated: &[Rating], folds_m: &[f64]) -> Vec<Trace> {
        let place_m = |k: usize| self.low_m + k as f64 * self.step_m;
        let ends_m = [self.low_m, place_m(self.count - 1)];
        let is_inside =
            |at_m: f64| ends_m.iter().chain(folds_m).all(|other_m| (other_m - at_m).abs() > MARGIN_M);
        let mut open: Vec<usize> = (0..rated.len()).filter(|&k| rated[k].rank > 0.0).collect();
        let mut traces = Vec::new();
        for _ in 0..MOST_TRACES {
            // On ties the first place.
            let clearest = open.iter().rev().max_by(|&&a, &&b| rated[a].rank.total_cmp(&rated[b].rank));
            let Some(&best) = clearest else { break };
            let Rating { share, clearness, contrast, rank, measured } = rated[best];
            // All places whose gap hides the joint are equally clear; the joint is in their middle.
            let is_alike = |k: &&usize| {
                k.abs_diff(best) <= 2 * self.gap + self.window && rated[**k].rank >= ALIKE * rank
            };
            let (sum_m, alike) =
                open.iter().filter(is_alike).fold((0.0, 0), |(sum, n), &k| (sum + place_m(k), n + 1));
            let (at_m, blur_m) = (sum_m / f64::from(alike), self.gap as f64 * self.step_m);
            open.retain(|k| k.abs_diff(best) > self.window);
            if is_inside(at_m) {
                traces.push(Trace { axis: self.axis, at_m, share, clearness, contrast, blur_m, measured });
            }
        }
        traces
    }
}
