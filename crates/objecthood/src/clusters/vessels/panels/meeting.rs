//! How two panels meet: as pieces of one wall, at a corner, or as walls that face each other.

use glam::DVec3;

use super::panel::Panel;
use crate::check::{Bound, Check};

/// Cosine of the greatest angle between the planes of parallel walls: 20 degrees.
const PARALLEL_COSINE: f64 = 0.94;
/// Cosine of the least angle between walls that meet at a corner: 60 degrees.
const CORNER_COSINE: f64 = 0.5;
/// A wall ends within this distance (m) of the corner: one that goes on beyond it is another thing.
const CORNER_M: f64 = 0.04;
/// Contents of the box hide at most this length of a wall at its corner (m).
const HIDDEN_M: f64 = 0.2;
/// Two walls face each other along at least this share of the shorter one.
const FACING_SHARE: f64 = 0.5;
/// Such walls are at most this far apart (m): the sides of a shelf are furniture.
const APART_M: f64 = 0.8;

/// What two panels show where they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Two pieces of one wall.
    OneWall,
    /// The inside of a box: a corner, or two walls that face each other.
    Inside,
    /// The outer corner of a box, or of a solid thing.
    Outside,
}

/// The meeting of two panels.
pub(super) struct Meeting {
    /// The check of their places.
    pub check: Check,
    pub kind: Kind,
}

impl Meeting {
    /// `None` if the panels fit no box: they are neither parallel nor at right angles, or one goes on beyond
    /// the corner. O(1).
    pub(super) fn of(one: &Panel, other: &Panel) -> Option<Self> {
        let cosine = one.normal.dot(other.normal);
        let is_before = |one: &Panel, other: &Panel| one.normal.dot(other.middle()) > one.offset_m;
        if cosine > PARALLEL_COSINE {
            let apart_m = (one.normal.dot(other.middle()) - one.offset_m).abs();
            let limit_m = one.noise_m.max(other.noise_m);
            let check = Check::new("distance of their planes", "m", apart_m, Bound::AtMost, limit_m);
            return Some(Self { check, kind: Kind::OneWall });
        }
        if cosine < -PARALLEL_COSINE {
            let apart_m = one.normal.dot(other.middle()) - one.offset_m;
            let is_facing = is_before(one, other) && is_before(other, one) && apart_m < APART_M;
            let what = "share of the shorter one along which they face each other";
            let check = Check::new(what, "", facing_share(one, other), Bound::AtLeast, FACING_SHARE);
            return is_facing.then_some(Self { check, kind: Kind::Inside });
        }
        if cosine.abs() > CORNER_COSINE {
            return None;
        }
        let corner = corner(one, other, cosine);
        let beyond_m = [one, other].map(|panel| beyond_m(panel, corner));
        let least_m = beyond_m[0].min(beyond_m[1]);
        let most_m = beyond_m[0].max(beyond_m[1]).max(0.0);
        let check = Check::new("distance of an end from the corner", "m", most_m, Bound::AtMost, HIDDEN_M);
        let kind = if is_before(one, other) || is_before(other, one) { Kind::Inside } else { Kind::Outside };
        (least_m > -CORNER_M).then_some(Self { check, kind })
    }
}

/// Where the planes of two panels cross in the plan view.
fn corner(one: &Panel, other: &Panel, cosine: f64) -> DVec3 {
    let squared_sine = 1.0 - cosine * cosine;
    let share = |a: &Panel, b: &Panel| (a.offset_m - cosine * b.offset_m) / squared_sine;
    one.normal * share(one, other) + other.normal * share(other, one)
}

/// How far (m) a place lies beyond the nearer end of a panel; below 0 within it.
fn beyond_m(panel: &Panel, place: DVec3) -> f64 {
    let at_m = panel.along.dot(place);
    (panel.ends_m[0] - at_m).max(at_m - panel.ends_m[1])
}

fn facing_share(one: &Panel, other: &Panel) -> f64 {
    let ends = other.ends().map(|end| one.along.dot(end));
    let from_m = ends[0].min(ends[1]).max(one.ends_m[0]);
    let to_m = ends[0].max(ends[1]).min(one.ends_m[1]);
    (to_m - from_m) / one.length_m().min(other.length_m())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clusters::colors::Colors;
    use crate::regions::SegmentId;

    /// A wall in the plane y = 0 from one place to another, as seen from the side to which `normal` points.
    fn wall(from: [f64; 2], to: [f64; 2], normal: [f64; 2]) -> Panel {
        let [from, to] = [from, to].map(|[x, z]| DVec3::new(x, 0.0, z));
        let normal = DVec3::new(normal[0], 0.0, normal[1]);
        let along = (to - from).normalize();
        Panel {
            cluster: SegmentId(0),
            normal,
            along,
            offset_m: normal.dot(from),
            ends_m: [along.dot(from), along.dot(to)],
            foot_m: 0.0,
            top_m: 0.1,
            noise_m: 0.01,
            colors: Colors::default(),
            size_px: 1000,
            wall_share: 1.0,
        }
    }

    /// Whether the places of two walls fit one box, and what is seen of it; `None` if they are at odds.
    fn met(one: &Panel, other: &Panel) -> Option<(bool, Kind)> {
        Meeting::of(one, other).map(|meeting| (meeting.check.holds(), meeting.kind))
    }

    #[test]
    fn walls_face_each_other_along_most_of_the_shorter_one() {
        let left = wall([0.0, 1.0], [0.0, 1.4], [1.0, 0.0]);
        let right = |from, normal| wall([0.3, from], [0.3, from + 0.2], [normal, 0.0]);
        assert_eq!(met(&left, &right(1.1, -1.0)), Some((true, Kind::Inside)));
        assert_eq!(met(&left, &right(1.35, -1.0)), Some((false, Kind::Inside)), "beside each other");
        assert_eq!(met(&left, &right(1.1, 1.0)), Some((false, Kind::OneWall)), "seen from the same side");
        let behind = wall([-0.3, 1.1], [-0.3, 1.3], [-1.0, 0.0]);
        assert_eq!(met(&left, &behind), None, "back to back");
    }

    #[test]
    fn walls_end_at_their_corner() {
        let far = wall([0.0, 1.4], [0.5, 1.4], [0.0, -1.0]);
        let left = |to| wall([0.0, 1.0], [0.0, to], [1.0, 0.0]);
        let inside = |fits| Some((fits, Kind::Inside));
        assert_eq!(met(&far, &left(1.4)), inside(true));
        assert_eq!(met(&far, &left(1.25)), inside(true), "a thing in the box hides the corner");
        assert_eq!(met(&far, &left(1.1)), inside(false), "nothing that can be grasped is so large");
        assert_eq!(met(&far, &left(1.5)), None, "it goes on beyond the other");
        let outside = wall([0.0, 1.4], [0.0, 1.8], [-1.0, 0.0]);
        assert_eq!(met(&far, &outside), Some((true, Kind::Outside)), "the outer sides of a solid thing");
    }
}
