//! The outline of a face beside a trace: where it steps, one side of the trace shows more of the face than the other (docs/CONTEXT.md 3.4).

use glam::DVec3;

use super::body::Face;
use super::trace::Trace;
use crate::quantile::range;

/// The outline is measured over two such lengths on either side of a joint (m), beyond what may show both.
const OUTLINE_M: f64 = 0.008;
/// The ends of the outline there are these quantiles of its pixels.
const END_QUANTILES: [f64; 2] = [0.03, 0.97];
/// Fewer pixels show no outline.
const LEAST_PX: usize = 10;

/// A notch may hold fewer pixels than this: single ones stick out anywhere.
const STRAY_PX: usize = 2;

/// A stretch along a trace where one side shows the face and the other does not.
#[derive(Clone, Copy)]
pub(super) struct Step {
    /// The side that shows it: -1 below the trace, 1 above.
    wider: f64,
    /// From where to where (m along the trace).
    between_m: [f64; 2],
    pub(super) length_m: f64,
    /// Whether the other side shows the face on both sides of the stretch.
    pub(super) is_notch: bool,
}

/// The outline of a face beside a trace.
pub(super) struct Outline {
    /// The direction along the trace.
    along: DVec3,
    /// The sorted places along it (m) of the pixels beside the trace: below, and above.
    places_m: [Vec<f64>; 2],
    /// The two ends of these places.
    ends_m: [[f64; 2]; 2],
    /// How far the outline steps at both ends (m), beyond its slant.
    pub(super) steps_m: [f64; 2],
    /// Whether both sides show how the outline slants.
    shows_slant: bool,
}

impl Outline {
    /// `None` where too little of the face is seen. O(pixels · log pixels).
    pub(super) fn beside(face: &Face, trace: &Trace) -> Option<Self> {
        let along = face.normal.cross(trace.axis).try_normalize()?;
        // Below and above: near the trace, and one length farther.
        let mut places_m = [const { [const { Vec::new() }; 2] }; 2];
        for pixel in &face.pixels {
            let height_m = trace.height_m(pixel.point);
            for (sign, lengths) in [-1.0, 1.0].into_iter().zip(&mut places_m) {
                let from_blur_m = sign * height_m - trace.blur_m;
                for (from_m, places_m) in [0.0, OUTLINE_M].into_iter().zip(lengths) {
                    if (0.0..OUTLINE_M).contains(&(from_blur_m - from_m)) {
                        places_m.push(along.dot(pixel.point));
                    }
                }
            }
        }
        let mut ends =
            |places_m: &mut Vec<f64>| (places_m.len() >= LEAST_PX).then(|| range(places_m, END_QUANTILES));
        let [[below, lower], [above, upper]] =
            places_m.each_mut().map(|lengths| lengths.each_mut().map(&mut ends));
        let (below, above) = (below?, above?);
        let lengths_apart = (2.0 * trace.blur_m + OUTLINE_M) / OUTLINE_M;
        let step = |end: usize| {
            let step_m = above[end] - below[end];
            // From below to above, as the step.
            let slants =
                [lower.map(|lower| below[end] - lower[end]), upper.map(|upper| upper[end] - above[end])];
            let slants_m = slants.into_iter().flatten().map(|slant_m| slant_m * step_m.signum());
            // A slant that only one side shows is none: the corner of a box may lie there.
            let slant_m = slants_m.fold(f64::INFINITY, f64::min);
            step_m.abs() - lengths_apart * slant_m.clamp(0.0, step_m.abs())
        };
        let places_m = places_m.map(|[mut near_m, _]| {
            near_m.sort_by(f64::total_cmp);
            near_m
        });
        let shows_slant = lower.is_some() && upper.is_some();
        Some(Self { along, places_m, ends_m: [below, above], steps_m: [0, 1].map(step), shows_slant })
    }

    /// The longer step of both ends, unless it may be a slant, and the longest notch of either side.
    pub(super) fn lone_steps(&self) -> impl Iterator<Item = Step> {
        let end = usize::from(self.steps_m[1] > self.steps_m[0]);
        let at_end = self.shows_slant.then(|| self.step_at(end));
        at_end.into_iter().chain([1.0, -1.0].into_iter().filter_map(|wider| self.notch(wider)))
    }

    /// The step at an end.
    fn step_at(&self, end: usize) -> Step {
        let outward = [-1.0, 1.0][end];
        let [below_m, above_m] = self.ends_m.map(|ends_m| outward * ends_m[end]);
        let (wider, narrow_m) = if above_m > below_m { (1.0, below_m) } else { (-1.0, above_m) };
        let mut between_m = [outward * narrow_m, outward * f64::INFINITY];
        between_m.sort_by(f64::total_cmp);
        Step { wider, between_m, length_m: self.steps_m[end], is_notch: false }
    }

    /// The longest stretch in which one side shows hardly any place, while this other side has no gap of half that length.
    fn notch(&self, wider: f64) -> Option<Step> {
        let [below_m, above_m] = &self.places_m;
        let (narrower_m, wider_m) = if wider > 0.0 { (below_m, above_m) } else { (above_m, below_m) };
        // Enough of the narrower side lies on both sides of the notch.
        let inner_m = narrower_m.get(LEAST_PX..narrower_m.len().saturating_sub(LEAST_PX))?;
        let between_m = longest_gap(inner_m, STRAY_PX)?;
        let length_m = between_m[1] - between_m[0];
        let inside = wider_m.iter().copied().filter(|at_m| (between_m[0]..between_m[1]).contains(at_m));
        let covered: Vec<f64> = between_m[..1].iter().copied().chain(inside).chain([between_m[1]]).collect();
        let [from_m, to_m] = longest_gap(&covered, 1)?;
        (to_m - from_m < length_m / 2.0).then_some(Step { wider, between_m, length_m, is_notch: true })
    }

    /// The points of the plane of the face where it ends with a step: those that lie beside the wider side, on the other side of the trace.
    pub(super) fn beyond<'a>(
        &'a self,
        step: &'a Step,
        face: &'a Face,
        trace: &'a Trace,
    ) -> impl Iterator<Item = DVec3> + 'a {
        // The axis may be a little out of the plane.
        let in_plane = trace.axis - trace.axis.dot(face.normal) * face.normal;
        let mirror = in_plane * (2.0 / in_plane.length_squared());
        let [from_m, to_m] = step.between_m;
        face.pixels.iter().filter_map(move |pixel| {
            let height_m = trace.height_m(pixel.point);
            let is_beside = (0.0..OUTLINE_M).contains(&(step.wider * height_m - trace.blur_m));
            let is_beyond = (from_m..to_m).contains(&self.along.dot(pixel.point));
            (is_beside && is_beyond).then(|| pixel.point - height_m * mirror)
        })
    }
}

/// The longest stretch between two of these sorted places with fewer than so many others between them.
fn longest_gap(places_m: &[f64], others: usize) -> Option<[f64; 2]> {
    let gaps = places_m.windows(others + 1).map(|gap| [gap[0], gap[others]]);
    gaps.reduce(|a, b| if b[1] - b[0] > a[1] - a[0] { b } else { a })
}
