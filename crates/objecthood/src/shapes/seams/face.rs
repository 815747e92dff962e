//! Joints of a single face: things of different widths share a plane (docs/CONTEXT.md 3.4).
//!
//! A box on another may stand flush with it on one side only. Then no plane cuts their whole body where colour changes, but the outline of the face they
//! share steps at both ends of the joint.

use super::body::{Body, Face};
use super::trace::Trace;
use super::{MOST_SEAMS, Parting, Piece, Search};
use crate::check::{Bound, Check};
use crate::quantile::range;

/// The outline of the face steps by so much (m) at both ends of a joint, as by the thinnest box that is told by its side. Noise steps by up to 1 cm.
const STEP_M: f64 = 0.012;
/// The outline is measured over this length on either side of a joint (m), beyond what may show both.
const WINDOW_M: f64 = 0.008;
/// The ends of the outline there are these quantiles of its pixels.
const END_QUANTILES: [f64; 2] = [0.03, 0.97];
/// Fewer pixels on either side show no outline.
const LEAST_PX: usize = 10;
/// Both sides share at most this multiple of the colours that two sides of a body may share: the outline speaks for a joint too.
const OVERLAP_FACTOR: f64 = 2.0;
/// A smaller face is not searched (px at 525 px): each side has the pixels of the smallest object.
const LEAST_FACE_PX: usize = 400;

impl Search<'_> {
    /// Parts the faces of a piece, one by one, along joints that end in steps of their outlines. O(pixels · edges of a face).
    pub(super) fn part_faces(&self, piece: Piece, parting: &mut Parting) {
        let Piece { body, sides } = piece;
        let mut whole = Vec::new();
        for face in body.faces {
            let face = Body { faces: vec![face] };
            let is_large = face.size_px() >= self.space.area_px(LEAST_FACE_PX);
            let may_part = parting.seams.len() < MOST_SEAMS && is_large && face.is_flat();
            let find = || self.clearest(&face, |trace| self.passed_in_face(&face, trace));
            match may_part.then(find).flatten() {
                Some((trace, seam)) => {
                    let halves = parting.cut(&face, &sides, &trace, seam);
                    parting.pieces.extend(halves);
                }
                None => whole.extend(face.faces),
            }
        }
        if !whole.is_empty() {
            parting.pieces.push(Piece { body: Body { faces: whole }, sides });
        }
    }

    /// The checks of a joint of one face that passes them.
    fn passed_in_face(&self, body: &Body, trace: &Trace) -> Option<Vec<Check>> {
        let step_m = step_m(body.faces.first()?, trace)?;
        let mut checks = self.check_colors(body, trace, OVERLAP_FACTOR * self.params.color_overlap);
        let what = "step of the outline of the face at the end with the smaller one";
        checks.push(Check::new(what, "m", step_m, Bound::AtLeast, STEP_M));
        if !checks.iter().all(Check::holds) {
            return None;
        }
        checks.extend(self.check_light(body, trace, self.params.color_overlap));
        checks.iter().all(Check::holds).then_some(checks)
    }
}

/// By how much the outline of a face steps at the ends of a trace (m), at the end where it steps less. `None` where too little is seen.
fn step_m(face: &Face, trace: &Trace) -> Option<f64> {
    let across = face.normal.cross(trace.axis).try_normalize()?;
    let ends_m = |sign: f64| {
        let beyond_m = |height_m: f64| sign * height_m - trace.blur_m;
        let beside =
            face.pixels.iter().filter(|p| (0.0..WINDOW_M).contains(&beyond_m(trace.height_m(p.point))));
        let mut places_m: Vec<f64> = beside.map(|p| across.dot(p.point)).collect();
        (places_m.len() >= LEAST_PX).then(|| range(&mut places_m, END_QUANTILES))
    };
    let (below, above) = (ends_m(-1.0)?, ends_m(1.0)?);
    Some([0, 1].map(|end| (below[end] - above[end]).abs()).into_iter().fold(f64::INFINITY, f64::min))
}
