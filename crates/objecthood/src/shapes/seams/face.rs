//! Joints of a single face: things of different widths share a plane (docs/CONTEXT.md 3.4).
//!
//! A box on another may stand flush with it on one side only. Then no plane cuts their whole body where
//! colour changes. But the outline of the face that they share steps at both ends of the joint, or far at one
//! of them.

use glam::DVec3;

use super::body::{Body, Face};
use super::side_colors::SideColors;
use super::trace::Trace;
use super::{GOES_ON, MOST_SEAMS, Parting, Piece, Search, clearest};
use crate::check::{Bound, Check};
use crate::quantile::range;

/// The outline of the face steps by at least this (m) at both ends of a joint, as beside the thinnest box
/// that is recognised by its side. Noise makes steps of up to 1 cm.
const OUTLINE_STEP_M: f64 = 0.012;
/// A step at one end alone is at least this large (m): the sum of both.
const LONE_STEP_M: f64 = 2.0 * OUTLINE_STEP_M;
/// A thing at least this far (m) before the plane of a face may hide a part of it.
const BEFORE_M: f64 = 0.01;
/// The face does not end at a lone step if more than this share of the plane beyond it is hidden.
const MOST_HIDDEN: f64 = 0.2;
/// The outline is measured over two lengths of this (m) on either side of a joint, beyond the pixels that may
/// show both sides.
const OUTLINE_M: f64 = 0.008;
/// The ends of the outline there are these quantiles of its pixels.
const END_QUANTILES: [f64; 2] = [0.03, 0.97];
/// With fewer pixels there is no outline.
const LEAST_PX: usize = 10;
/// The colours of both sides overlap by at most this multiple of what two sides of a body may: the outline is
/// evidence for a joint too.
const OVERLAP_FACTOR: f64 = 2.0;
/// A smaller face is not searched (px at 525 px): each side has the pixels of the smallest object.
const LEAST_FACE_PX: usize = 400;

impl Search<'_> {
    /// Divides the faces of a piece, one by one, along joints that end in steps of their outlines; then both
    /// sides of each joint. `traces`: those of the piece. O(pixels · axes of a face · seams).
    pub(super) fn part_faces(&self, piece: Piece, traces: Vec<Trace>, parting: &mut Parting) {
        let Piece { body, sides } = piece;
        // A piece of one face was searched as this face.
        let mut known = (body.faces.len() == 1).then_some(traces);
        let mut whole = Vec::new();
        for face in body.faces {
            let mut open = vec![Piece { body: Body { faces: vec![face] }, sides: sides.clone() }];
            while let Some(piece) = open.pop() {
                let Piece { body, sides: own } = &piece;
                let is_large = body.size_px() >= self.space.area_px(LEAST_FACE_PX);
                let may_part = parting.seams.len() < MOST_SEAMS && is_large && body.is_flat();
                let mut traces = || known.take().unwrap_or_else(|| self.find_traces(body));
                let traces = if may_part { traces() } else { Vec::new() };
                match clearest(&traces, |trace| self.passed_in_face(body, trace)) {
                    Some((trace, seam)) => open.extend(parting.cut(body, own, trace, seam)),
                    None if own.len() > sides.len() => parting.pieces.push(piece),
                    None => whole.extend(piece.body.faces),
                }
            }
        }
        if !whole.is_empty() {
            parting.pieces.push(Piece { body: Body { faces: whole }, sides });
        }
    }

    /// The checks of a joint of one face, if it passes them. Its outline steps at both ends. Or one step is
    /// large, and the colours of both sides overlap no more than those of a whole body may at the clearest.
    fn passed_in_face(&self, body: &Body, trace: &Trace) -> Option<Vec<Check>> {
        let colors = SideColors::of(body, trace);
        let (overlap, most) = (colors.overlap(), self.params.color_overlap);
        let mut checks = self.check_colors(trace, overlap, OVERLAP_FACTOR * most);
        // Most traces fail here, before the outline is measured.
        if !checks.iter().all(Check::holds) {
            return None;
        }
        let face = body.faces.first()?;
        let outline = Outline::beside(face, trace)?;
        let [first_m, last_m] = outline.steps_m;
        let what = "step of the outline of the face at the end with the smaller one";
        let both = Check::new(what, "m", first_m.min(last_m), Bound::AtLeast, OUTLINE_STEP_M);
        if both.holds() {
            checks.push(both);
        } else {
            checks = self.check_colors(trace, overlap, most);
            checks.extend(self.check_lone_step(&outline, face, trace)?);
        }
        if !checks.iter().all(Check::holds) {
            return None;
        }
        checks.extend(self.check_light(body, trace, &colors, GOES_ON.min(most)));
        checks.iter().all(Check::holds).then_some(checks)
    }

    /// Checks that the outline steps far at one end of a trace, and that the face really ends there: nothing
    /// hides the place where it would go on. `None` if a slant may look like a step.
    fn check_lone_step(&self, outline: &Outline, face: &Face, trace: &Trace) -> Option<[Check; 2]> {
        let [first_m, last_m] = outline.steps_m;
        let step = "step of the outline of the face at the end with the larger one";
        let hidden = "share beyond it that something hides";
        if !outline.shows_slant {
            return None;
        }
        let share = self.hidden_share(outline.beyond(usize::from(last_m > first_m), face, trace));
        Some([
            Check::new(step, "m", first_m.max(last_m), Bound::AtLeast, LONE_STEP_M),
            Check::new(hidden, "", share, Bound::AtMost, MOST_HIDDEN),
        ])
    }

    /// The share of points that something hides, or that lie outside the image.
    fn hidden_share(&self, points: impl Iterator<Item = DVec3>) -> f64 {
        let is_hidden = |point: DVec3| {
            let seen = self.space.camera().pixel_at(point, self.size);
            let depth_m = seen.map(|i| self.space.depth_m(self.disparity[i].into()));
            // In the shadow of the face itself nothing is measured; there it does end.
            depth_m.is_none_or(|depth_m| depth_m < point.z - BEFORE_M)
        };
        let (hidden, all) =
            points.fold((0, 0), |(hidden, all), p| (hidden + u32::from(is_hidden(p)), all + 1));
        f64::from(hidden) / f64::from(all.max(1))
    }
}

/// The outline of a face beside a trace.
struct Outline {
    /// The direction along the trace.
    across: DVec3,
    /// The two ends along it (m): below the trace, and above.
    ends_m: [[f64; 2]; 2],
    /// How far the outline steps at both ends (m), without its slant.
    steps_m: [f64; 2],
    /// Whether both sides show how the outline slants.
    shows_slant: bool,
}

impl Outline {
    /// `None` if too little of the face is seen.
    fn beside(face: &Face, trace: &Trace) -> Option<Self> {
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
        let [[below, lower], [above, upper]] = places_m.map(|lengths| {
            lengths
                .map(|mut places_m| (places_m.len() >= LEAST_PX).then(|| range(&mut places_m, END_QUANTILES)))
        });
        let (below, above) = (below?, above?);
        let lengths = (2.0 * trace.blur_m + OUTLINE_M) / OUTLINE_M;
        let step_m = |end: usize| {
            let step_m = above[end] - below[end];
            // From below to above, as the step.
            let slants =
                [lower.map(|lower| below[end] - lower[end]), upper.map(|upper| upper[end] - above[end])];
            let along = slants.into_iter().flatten().map(|slant_m| slant_m * step_m.signum());
            // A slant that only one side shows does not count: the corner of a box may lie there.
            step_m.abs() - lengths * along.fold(f64::INFINITY, f64::min).clamp(0.0, step_m.abs())
        };
        let steps_m = [0, 1].map(step_m);
        Some(Self {
            across,
            ends_m: [below, above],
            steps_m,
            shows_slant: lower.is_some() && upper.is_some(),
        })
    }

    /// Points of the plane of the face where it ends with a step: beside the wider side, on the other side of
    /// the trace.
    fn beyond<'a>(
        &'a self,
        end: usize,
        face: &'a Face,
        trace: &'a Trace,
    ) -> impl Iterator<Item = DVec3> + 'a {
        let outward = [-1.0, 1.0][end];
        let [below_m, above_m] = self.ends_m.map(|ends_m| outward * ends_m[end]);
        // The axis may deviate a little from the plane.
        let in_plane = trace.axis - trace.axis.dot(face.normal) * face.normal;
        let mirror = in_plane * (2.0 / in_plane.length_squared());
        let (wider, narrow_m) = if above_m > below_m { (1.0, below_m) } else { (-1.0, above_m) };
        face.pixels.iter().filter_map(move |pixel| {
            let height_m = trace.height_m(pixel.point);
            let is_beside = (0.0..OUTLINE_M).contains(&(wider * height_m - trace.blur_m));
            let is_beyond = outward * self.across.dot(pixel.point) > narrow_m;
            (is_beside && is_beyond).then(|| pixel.point - height_m * mirror)
        })
    }
}
