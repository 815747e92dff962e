//! Putting things into vessels where they touch the wall.

use glam::DVec3;

use super::{GAP_M, Layout, contact};
use crate::contact::ContactKind;
use crate::pose::Pose;
use crate::shape::Shape;
use crate::solid::{Cavity, Solid};

impl Layout {
    /// Puts `solid` onto the floor of the last of these vessels, each of which stands in the one before: its origin at
    /// a place of that one's frame, turned as that one is. The place must be one where it does not cut the wall.
    pub(crate) fn fill_at(&mut self, solid: &Solid, vessels: &[usize], place_m: [f64; 3]) -> Option<usize> {
        let &vessel = vessels.last()?;
        let below = &self.solids[vessel];
        let pose = Pose { origin: below.pose.point(place_m.into()), ..below.pose };
        let solid = solid.clone().at(pose);
        self.is_free(&solid, vessels, GAP_M).then(|| self.rest(solid, vessel, ContactKind::LiesIn))
    }

    /// Puts a bowl into the last of these bowls, each of which stands in the one before: it rests on the rim of its
    /// foot, in the middle.
    pub(crate) fn nest(&mut self, bowl: &Solid, bowls: &[usize]) -> Option<usize> {
        let &lower = bowls.last()?;
        let below = &self.solids[lower];
        let (Cavity::Round { floor_z, radius_m }, Shape::Revolved(shape)) =
            (below.form.cavity?, &bowl.parts[0].shape)
        else {
            return None;
        };
        let foot = shape.foot_m();
        let rise = (radius_m * radius_m - foot * foot).sqrt();
        let foot_z = floor_z + radius_m - rise;
        let point = below.pose.point(DVec3::new(foot, 0.0, foot_z));
        let normal = below.pose.rotation * (DVec3::new(-foot, 0.0, rise) / radius_m);
        let origin = below.pose.point(DVec3::Z * foot_z);
        let bowl = bowl.clone().at(Pose { origin, ..below.pose });
        self.is_free(&bowl, bowls, GAP_M).then(|| {
            let upper = self.add(bowl);
            self.contacts.push(contact(upper, lower, ContactKind::LiesIn, point, normal));
            upper
        })
    }
}
