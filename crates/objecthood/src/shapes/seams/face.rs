//! Joints of a single face: things of different widths share a plane (docs/CONTEXT.md 3.4).
//!
//! A box on another may stand flush with it on one side only. Then no plane cuts their whole body where
//! colour changes. But the outline of the face that they share steps at both ends of the joint, or far at one
//! of them, or it has a notch there.

use glam::DVec3;

use super::body::Body;
use super::outline::{Outline, Step};
use super::side_colors::SideColors;
use super::trace::Trace;
use super::{GOES_ON, MOST_SEAMS, Parting, Piece, Search, clearest};
use crate::check::{Bound, Check};

/// The outline of the face steps by at least this (m) at both ends of a joint, as beside the thinnest box
/// that is recognised by its side. Noise makes steps of up to 1 cm.
const OUTLINE_STEP_M: f64 = 0.012;
/// A step at one end alone is at least this large (m): the sum of both.
const LONE_STEP_M: f64 = 2.0 * OUTLINE_STEP_M;
/// A face ends where what is seen beyond it lies behind its plane by this (quanta).
const BEHIND_QUANTA: f64 = 2.5;
/// The face does not end at a lone step if it may go on in more than this share of the plane beyond it.
const MOST_OPEN: f64 = 0.2;
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

    /// The checks of a joint of one face, if it passes them. Its outline steps at both ends. Or there is one long
    /// step, and the colours of both sides overlap no more than those of a whole body may at the clearest.
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
            let mut of_steps = outline
                .lone_steps()
                .map(|step| self.check_lone_step(&step, outline.beyond(&step, face, trace)));
            checks.extend(of_steps.find(|checks| checks.iter().all(Check::holds))?);
        }
        if !checks.iter().all(Check::holds) {
            return None;
        }
        checks.extend(self.check_light(body, trace, &colors, GOES_ON.min(most)));
        checks.iter().all(Check::holds).then_some(checks)
    }

    /// Checks that a lone step is long, and that the face ends there: the points `beyond` it lie before what is seen.
    fn check_lone_step(&self, step: &Step, beyond: impl Iterator<Item = DVec3>) -> [Check; 2] {
        let length = "longest step or notch of the outline of the face";
        let open = "share beyond this step where the face may go on";
        let share = self.open_share(beyond, step.is_notch);
        [
            Check::new(length, "m", step.length_m, Bound::AtLeast, LONE_STEP_M),
            Check::new(open, "", share, Bound::AtMost, MOST_OPEN),
        ]
    }

    /// The share of points where a face may go on: something hides them, or lies there, or they are outside the
    /// image. `in_notch`: points without depth count too. At an end they lie in the shadow of the face itself,
    /// but a notch may be a hole in what is measured.
    fn open_share(&self, points: impl Iterator<Item = DVec3>, in_notch: bool) -> f64 {
        let is_open = |point: DVec3| {
            let Some(i) = self.space.camera().pixel_at(point, self.size) else { return true };
            let depth_m = self.space.depth_m(self.disparity[i].into());
            let behind_m = self.space.step_m(BEHIND_QUANTA, point.z);
            if depth_m.is_nan() { in_notch } else { depth_m <= point.z + behind_m }
        };
        let (open, all) = points.fold((0, 0), |(open, all), p| (open + u32::from(is_open(p)), all + 1));
        f64::from(open) / f64::from(all.max(1))
    }
}
