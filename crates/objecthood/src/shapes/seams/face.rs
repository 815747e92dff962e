//! Joints of a single face: things of different widths share a plane (docs/CONTEXT.md 3.4).
//!
//! A box on another may stand flush with it on one side only. Then no plane cuts their whole body where colour changes, but the outline of the face they
//! share steps at both ends of the joint.

use super::body::{Body, Face};
use super::trace::Trace;
use super::{GOES_ON, MOST_SEAMS, Parting, Piece, Search, clearest};
use crate::check::{Bound, Check};
use crate::quantile::range;

/// The outline of the face steps by so much (m) at both ends of a joint, as by the thinnest box that is told by its side. Noise steps by up to 1 cm.
const OUTLINE_STEP_M: f64 = 0.012;
/// The outline is measured over two such lengths on either side of a joint (m), beyond what may show both.
const OUTLINE_M: f64 = 0.008;
/// The ends of the outline there are these quantiles of its pixels.
const END_QUANTILES: [f64; 2] = [0.03, 0.97];
/// Fewer pixels show no outline.
const LEAST_PX: usize = 10;
/// Both sides share at most this multiple of the colours that two sides of a body may share: the outline speaks for a joint too.
const OVERLAP_FACTOR: f64 = 2.0;
/// A smaller face is not searched (px at 525 px): each side has the pixels of the smallest object.
const LEAST_FACE_PX: usize = 400;

impl Search<'_> {
    /// Parts the faces of a piece, one by one, along joints that end in steps of their outlines; then both sides. `traces`: those of the piece.
    /// O(pixels · edges of a face · seams).
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

    /// The checks of a joint of one face that passes them.
    fn passed_in_face(&self, body: &Body, trace: &Trace) -> Option<Vec<Check>> {
        let overlap = self.params.color_overlap;
        let mut checks = self.check_colors(body, trace, OVERLAP_FACTOR * overlap);
        // Most traces end here, before the outline is measured.
        if !checks.iter().all(Check::holds) {
            return None;
        }
        let step_m = step_m(body.faces.first()?, trace)?;
        let what = "step of the outline of the face at the end with the smaller one";
        checks.push(Check::new(what, "m", step_m, Bound::AtLeast, OUTLINE_STEP_M));
        if !checks.iter().all(Check::holds) {
            return None;
        }
        checks.extend(self.check_light(body, trace, GOES_ON.min(overlap)));
        checks.iter().all(Check::holds).then_some(checks)
    }
}

/// By how much the outline of a face steps at the ends of a trace (m), at the end where it steps less, beyond what it slants. `None` where too little is
/// seen.
fn step_m(face: &Face, trace: &Trace) -> Option<f64> {
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
        lengths.map(|mut places_m| (places_m.len() >= LEAST_PX).then(|| range(&mut places_m, END_QUANTILES)))
    });
    let (below, above) = (below?, above?);
    let beyond = [lower, upper];
    let lengths = (2.0 * trace.blur_m + OUTLINE_M) / OUTLINE_M;
    let step_m = |end: usize| {
        let step_m = above[end] - below[end];
        // From below to above, as the step.
        let slants =
            [beyond[0].map(|lower| below[end] - lower[end]), beyond[1].map(|upper| upper[end] - above[end])];
        let along = slants.into_iter().flatten().map(|slant_m| slant_m * step_m.signum());
        // A slant that only one side shows is none: the corner of a box may lie there.
        step_m.abs() - lengths * along.fold(f64::INFINITY, f64::min).clamp(0.0, step_m.abs())
    };
    Some(step_m(0).min(step_m(1)))
}
