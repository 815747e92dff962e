//! Putting things down where furniture leaves room: on boards, in bins, on the floor, and on each other.

use glam::DVec3;

use super::{GAP_M, Layout, TRIES};
use crate::contact::ContactKind;
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Outline, Solid};

/// A box without furniture in it, over something flat. What keeps within it keeps clear of all furniture.
#[derive(Clone, Copy)]
pub(crate) struct Spot {
    /// Index of what things stand on there.
    pub(crate) on: usize,
    /// Corners (m); the lower one has the height of what things stand on.
    pub(crate) low_m: [f64; 3],
    pub(crate) high_m: [f64; 3],
}

impl Spot {
    /// Whether a solid keeps clear of the sides and the top.
    fn holds(&self, solid: &Solid) -> bool {
        let (low, high) = (DVec3::from(self.low_m), DVec3::from(self.high_m));
        let sideways = [DVec3::X, DVec3::Y].iter().all(|&axis| {
            solid.support(axis) <= high.dot(axis) - GAP_M && solid.support(-axis) <= -low.dot(axis) - GAP_M
        });
        sideways && solid.support(DVec3::Z) <= high.z - GAP_M
    }
}

impl Layout {
    /// Stands `solid` somewhere in a spot, turned by any angle, on what the spot is over. Its index, or `None` when no
    /// room was found.
    pub(crate) fn stand_in(&mut self, rng: &mut Rng, solid: &Solid, spot: &Spot) -> Option<usize> {
        (0..TRIES).find_map(|_| {
            let solid = somewhere(rng, solid, spot);
            (spot.holds(&solid) && self.is_free(&solid, &[], GAP_M))
                .then(|| self.rest(solid, spot.on, ContactKind::StandsOn))
        })
    }

    /// Lets `solid` down somewhere in a spot until it meets something: what the spot is over, or the lid of what was
    /// placed before, which must be under the middle of `solid`, or it would tip. Its index, or `None` when no room was
    /// found.
    pub(crate) fn drop_in(&mut self, rng: &mut Rng, solid: &Solid, spot: &Spot) -> Option<usize> {
        (0..TRIES).find_map(|_| {
            let mut solid = somewhere(rng, solid, spot);
            let lower = self.highest_below(&solid, spot);
            if let Some(lower) = lower {
                solid.pose.origin.z = self.top_m(lower);
            }
            let is_carried = lower.is_none_or(|lower| is_over_lid(&solid, &self.solids[lower]));
            let mut obstacles = (self.table + 1..self.first_object).filter(|&k| k != spot.on);
            let is_clear = obstacles.all(|k| super::separation(&solid, &self.solids[k]) >= GAP_M);
            (is_carried && is_clear && spot.holds(&solid))
                .then(|| self.rest(solid, lower.unwrap_or(spot.on), ContactKind::StandsOn))
        })
    }

    /// Of what was placed in a spot, and is not beside `solid`, the one with the highest top.
    fn highest_below(&self, solid: &Solid, spot: &Spot) -> Option<usize> {
        let heights = spot.low_m[2]..spot.high_m[2];
        let in_spot = self.placed().filter(|&k| heights.contains(&self.solids[k].pose.origin.z));
        let below = in_spot.filter(|&k| !is_beside(solid, &self.solids[k]));
        below.max_by(|&a, &b| self.top_m(a).total_cmp(&self.top_m(b)))
    }
}

/// `solid` somewhere in a spot, on what the spot is over.
fn somewhere(rng: &mut Rng, solid: &Solid, spot: &Spot) -> Solid {
    let [x, y] = [0, 1].map(|k| rng.range(spot.low_m[k]..spot.high_m[k]));
    solid.clone().at(Pose::at([x, y, spot.low_m[2]]).turned(2, rng.range(0.0..360.0)))
}

/// Whether two solids keep apart however high one of them is.
fn is_beside(a: &Solid, b: &Solid) -> bool {
    (0..36).any(|k| {
        let (sin, cos) = libm::sincos(f64::to_radians(10.0 * f64::from(k)));
        let direction = DVec3::new(cos, sin, 0.0);
        -a.support(direction) - b.support(-direction) >= GAP_M
    })
}

/// Whether the origin of `upper` lies well within the level lid of `lower`.
fn is_over_lid(upper: &Solid, lower: &Solid) -> bool {
    const WITHIN: f64 = 0.85;
    let is_level = lower.pose.rotation.col(2).z > 1.0 - 1e-12;
    let own = lower.pose.own_direction(upper.pose.origin - lower.pose.origin);
    let is_within = match lower.form.outline {
        Outline::Rectangle { half_m: [x, y] } => own.x.abs() < WITHIN * x && own.y.abs() < WITHIN * y,
        Outline::Disc { radius_m } => libm::hypot(own.x, own.y) < WITHIN * radius_m,
    };
    lower.form.has_flat_top && is_level && is_within
}
