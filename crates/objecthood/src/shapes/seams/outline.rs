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

/// A stretch along a trace that one side of it covers and the other does not.
#[derive(Clone, Copy)]
pub(super) struct Step {
    /// The side that covers it: -1 below the trace, 1 above.
    wider: f64,
    /// From where to where (m along the trace).
    between_m: [f64; 2],
    pub(super) length_m: f64,
}

/// The outline of a face beside a trace.
pub(super) struct Outline {
    /// The direction along the trace.
    across: DVec3,
    /// The two ends along it (m): below the trace, and above.
    ends_m: [[f64; 2]; 2],
    /// How far the outline steps at both ends (m), beyond what it slants.
    pub(super) steps_m: [f64; 2],
    /// Whether both sides show how the outline slants.
    shows_slant: bool,
    /// The longest notch between the ends.
    notch: Option<Step>,
}

impl Outline {
    /// `None` where too little of the face is seen.
    pub(super) fn beside(face: &Face, trace: &Trace) -> Option<Self> {
        let across = face.normal.cross(trace.axis).try_normalize()?;
        // Places along the trace (m) of the pixels beside it: below and above, each near it and one length farther.
        let mut places_m = [const { [const { Vec::new() }; 2] }; 2];
        for pixel in &face.pixels {
            let height_m = trace.height_m(pixel.point);
            for (sign, lengths) in [-1.0, 1.0].into_iter().zip(&mut places_m) {
                let from_blur_m = sign * height_m - trace.blur_m;
                for (from_m, places_m) in [0.0, OUTLINE_M].into_iter().zip(lengths) {
                    if (0.0..OUTLINE_M).contains(&(from_blur_m - from_m)) {
                        places_m.push(across.dot(pixel.point));
                    }
                }
            }
        }
        let mut ends =
            |places_m: &mut Vec<f64>| (places_m.len() >= LEAST_PX).then(|| range(places_m, END_QUANTILES));
        let [[below, lower], [above, upper]] =
            places_m.each_mut().map(|lengths| lengths.each_mut().map(&mut ends));
        let (below, above) = (below?, above?);
        let lengths = (2.0 * trace.blur_m + OUTLINE_M) / OUTLINE_M;
        let step_m = |end: usize| {
            let step_m = above[end] - below[end];
            // From below to above, as the step.
            let slants =
                [lower.map(|lower| below[end] - lower[end]), upper.map(|upper| upper[end] - above[end])];
            let along = slants.into_iter().flatten().map(|slant_m| slant_m * step_m.signum());
            // A slant that only one side shows is none: the corner of a box may lie there.
            step_m.abs() - lengths * along.fold(f64::INFINITY, f64::min).clamp(0.0, step_m.abs())
        };
        let steps_m = [0, 1].map(step_m);
        let [[mut below_m, _], [mut above_m, _]] = places_m;
        Some(Self {
            across,
            ends_m: [below, above],
            steps_m,
            shows_slant: lower.is_some() && upper.is_some(),
            notch: longest_notch([&mut below_m, &mut above_m]),
        })
    }

    /// The longest step, at an end or between. `None` if only one end steps, and a slant may look like that.
    pub(super) fn largest_step(&self) -> Option<Step> {
        let end = usize::from(self.steps_m[1] > self.steps_m[0]);
        let at_end = self.shows_slant.then(|| self.step_at(end));
        let steps = at_end.into_iter().chain(self.notch);
        steps.reduce(|longest, step| if step.length_m > longest.length_m { step } else { longest })
    }

    /// The step at an end.
    fn step_at(&self, end: usize) -> Step {
        let outward = [-1.0, 1.0][end];
        let [below_m, above_m] = self.ends_m.map(|ends_m| outward * ends_m[end]);
        let (wider, narrow_m) = if above_m > below_m { (1.0, below_m) } else { (-1.0, above_m) };
        let mut between_m = [outward * narrow_m, outward * f64::INFINITY];
        between_m.sort_by(f64::total_cmp);
        Step { wider, between_m, length_m: self.steps_m[end] }
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
            let is_beyond = (from_m..to_m).contains(&self.across.dot(pixel.point));
            (is_beside && is_beyond).then(|| pixel.point - height_m * mirror)
        })
    }
}

/// The longest stretch between the ends of one side's places that shows none of them, while the other side covers it without a gap of half its length.
fn longest_notch(mut places_m: [&mut Vec<f64>; 2]) -> Option<Step> {
    places_m.iter_mut().for_each(|places_m| places_m.sort_by(f64::total_cmp));
    let [below_m, above_m] = places_m;
    let longest_gap = |places_m: &[f64]| {
        let gaps = places_m.windows(2).map(|pair| [pair[0], pair[1]]);
        gaps.reduce(|a, b| if b[1] - b[0] > a[1] - a[0] { b } else { a })
    };
    let notch = |(narrower_m, wider_m, wider): (&[f64], &[f64], f64)| {
        let between_m = longest_gap(narrower_m)?;
        let length_m = between_m[1] - between_m[0];
        let inside = wider_m.iter().copied().filter(|at_m| (between_m[0]..between_m[1]).contains(at_m));
        let covered: Vec<f64> = between_m[..1].iter().copied().chain(inside).chain([between_m[1]]).collect();
        let gap_m = longest_gap(&covered).map_or(0.0, |[from_m, to_m]| to_m - from_m);
        (gap_m < length_m / 2.0).then_some(Step { wider, between_m, length_m })
    };
    let notches =
        [(&**below_m, &**above_m, 1.0), (&**above_m, &**below_m, -1.0)].into_iter().filter_map(notch);
    notches.reduce(|a, b| if b.length_m > a.length_m { b } else { a })
}
