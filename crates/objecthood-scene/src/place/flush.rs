//! Boxes pushed together, so that their faces go on in each other.

use glam::DVec3;

use super::{GAP_M, LOW_M, Layout, contact};
use crate::contact::ContactKind;
use crate::pose::Pose;
use crate::solid::{Outline, Solid};

impl Layout {
    /// Stands a box beside another one that stands on the table, at its left (+1) or right (-1) along the x axis of that
    /// one; their front faces lie in one plane.
    pub(crate) fn stand_flush(&mut self, solid: &Solid, neighbor: usize, side: f64) -> Option<usize> {
        let other = &self.solids[neighbor];
        let (Outline::Rectangle { half_m: own }, Outline::Rectangle { half_m: its }) =
            (solid.form.outline, other.form.outline)
        else {
            return None;
        };
        let (pose, normal) = (other.pose, other.pose.rotation.col(0) * side);
        let beside = DVec3::new(side * (its[0] + own[0]), own[1] - its[1], 0.0);
        let solid = solid.clone().at(Pose { origin: pose.point(beside), ..pose });
        if !self.is_over_table(&solid) || !self.is_free(&solid, &[neighbor], GAP_M) {
            return None;
        }
        // In the middle of where the two faces overlap.
        let front = -its[1] + own[1].min(its[1]);
        let point = pose.point(DVec3::new(side * its[0], front, LOW_M));
        let upper = self.rest(solid, self.table, ContactKind::StandsOn);
        self.contacts.push(contact(upper, neighbor, ContactKind::Touches, point, normal));
        Some(upper)
    }

    /// Stands a box on the lid of another one, turned as that one is and right over it.
    pub(crate) fn stack_flush(&mut self, solid: &Solid, lower: usize) -> Option<usize> {
        let below = &self.solids[lower];
        let origin = below.pose.point(DVec3::Z * below.form.height_m);
        let solid = solid.clone().at(Pose { origin, ..below.pose });
        self.is_free(&solid, &[lower], GAP_M).then(|| self.rest(solid, lower, ContactKind::StandsOn))
    }
}
