//! The directions along which a body may be divided: its axes.

use std::cmp::Reverse;

use glam::DVec3;

use crate::linear::{NO_RANGE, widened};
use crate::shapes::seams::body::{Body, Face};

/// Axes are taken from this many faces, the largest.
const FACES: usize = 3;
/// A face with less than this share of the body's pixels gives no axis.
const LEAST_SHARE: f64 = 0.1;
/// Two axes within this angle are one direction (degrees): joints are found up to about this turn.
const ALIKE_DEG: f64 = 15.0;
/// A face within this angle of level gets its axes from its outline (degrees).
const LEVEL_DEG: f64 = 30.0;
/// The outline is turned in steps of this angle (degrees).
const TURN_DEG: f64 = 5.0;
/// Every so-many-th pixel of a face gives its outline: enough for its sides.
const OUTLINE_STEP: usize = 7;

/// Unit vectors along the axes of a body, at most seven: up, then for each face its level direction and the
/// one across it. A level face, and every face if up is unknown, has the sides of the smallest rectangle
/// around it instead. O(pixels of the largest faces).
pub(super) fn find_axes(body: &Body, up: Option<DVec3>) -> Vec<DVec3> {
    let least_px = LEAST_SHARE * body.size_px() as f64;
    let mut faces: Vec<&Face> =
        body.faces.iter().filter(|face| face.pixels.len() as f64 >= least_px).collect();
    faces.sort_by_key(|face| Reverse(face.pixels.len()));
    let of_face = |face: &&Face| {
        let upright = up.filter(|up| up.dot(face.normal).abs() < libm::cos(LEVEL_DEG.to_radians()));
        let level = upright.and_then(|up| up.cross(face.normal).try_normalize());
        let along = level.or_else(|| outline_direction(face));
        along.map(|along| [along, face.normal.cross(along)])
    };
    let found = up.into_iter().chain(faces.iter().take(FACES).filter_map(of_face).flatten());
    let limit = libm::cos(ALIKE_DEG.to_radians());
    found.fold(Vec::new(), |mut axes: Vec<DVec3>, axis| {
        if axes.iter().all(|other| other.dot(axis).abs() < limit) {
            axes.push(axis);
        }
        axes
    })
}

/// A side of the smallest rectangle around a face, in its plane.
fn outline_direction(face: &Face) -> Option<DVec3> {
    let x = face.normal.any_orthonormal_vector();
    let y = face.normal.cross(x);
    let points: Vec<[f64; 2]> =
        face.pixels.iter().step_by(OUTLINE_STEP).map(|p| [x.dot(p.point), y.dot(p.point)]).collect();
    let area = |[cos, sin]: [f64; 2]| {
        let mut ranges = [NO_RANGE; 2];
        for [px, py] in &points {
            let turned = [cos * px + sin * py, cos * py - sin * px];
            ranges = [0, 1].map(|k| widened(ranges[k], turned[k]));
        }
        let [along, across] = ranges.map(|[low, high]| high - low);
        along * across
    };
    let turns = (0..(90.0 / TURN_DEG) as usize).map(|k| {
        let turn = (k as f64 * TURN_DEG).to_radians();
        [libm::cos(turn), libm::sin(turn)]
    });
    let [cos, sin] = turns.min_by(|a, b| area(*a).total_cmp(&area(*b)))?;
    Some(cos * x + sin * y)
}
