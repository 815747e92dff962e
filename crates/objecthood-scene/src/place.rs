//! Putting things down: exactly in contact, never into each other.
//!
//! Certainty comes from supports: two solids are apart when along some direction one ends before the other begins. A
//! finite set of directions is tried, so a placement may be refused without need but is never wrong.

mod flush;
mod inside;
mod spot;

use glam::DVec3;

use crate::contact::{Contact, ContactKind};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::{Cavity, Outline, Solid};

pub(crate) use spot::Spot;

/// Things that do not touch stay this far apart (m).
const GAP_M: f64 = 0.004;
/// Rounding that a contact may have (m).
const CONTACT_M: f64 = 1e-9;
/// Height over the table (m) at which whatever has straight sides has its full outline.
const LOW_M: f64 = 0.001;
const TRIES: usize = 60;

/// A scene in the making.
pub(crate) struct Layout {
    pub(crate) solids: Vec<Solid>,
    pub(crate) contacts: Vec<Contact>,
    first_object: usize,
    /// Index of what things stand on. Placements keep clear of everything behind it.
    table: usize,
}

/// Where on the table things are put.
#[derive(Clone, Copy)]
pub(crate) struct Region {
    pub(crate) center_m: [f64; 2],
    pub(crate) half_m: [f64; 2],
}

impl Layout {
    /// On a table, which stands at index `table` in its room, before whatever lies on it.
    pub(crate) fn new(room: Vec<Solid>, table: usize) -> Self {
        Self { first_object: room.len(), solids: room, contacts: Vec::new(), table }
    }

    /// Adds a piece of furniture that things are to keep clear of; before the first of them is placed. Its index.
    pub(crate) fn furnish(&mut self, solid: Solid) -> usize {
        self.solids.push(solid);
        self.first_object = self.solids.len();
        self.first_object - 1
    }

    /// Index of what things stand on.
    pub(crate) fn table(&self) -> usize {
        self.table
    }

    /// Indices of what has been placed.
    pub(crate) fn placed(&self) -> std::ops::Range<usize> {
        self.first_object..self.solids.len()
    }

    /// Height of the highest point of a solid.
    pub(crate) fn top_m(&self, index: usize) -> f64 {
        self.solids[index].support(DVec3::Z)
    }

    fn table_top_m(&self) -> f64 {
        self.top_m(self.table)
    }

    /// Stands `solid` somewhere in `region` of the table, turned by any angle. Its index, or `None` when no room was found.
    pub(crate) fn stand(&mut self, rng: &mut Rng, solid: &Solid, region: Region) -> Option<usize> {
        (0..TRIES).find_map(|_| {
            let [x, y] = [0, 1].map(|k| region.center_m[k] + region.half_m[k] * rng.range(-1.0..1.0));
            self.stand_at(solid, [x, y], rng.range(0.0..360.0))
        })
    }

    /// A place of the table in `region` where `solid` keeps `gap_m` from everything.
    pub(crate) fn free_place(
        &self,
        rng: &mut Rng,
        solid: &Solid,
        region: Region,
        gap_m: f64,
    ) -> Option<Pose> {
        (0..TRIES).find_map(|_| {
            let [x, y] = [0, 1].map(|k| region.center_m[k] + region.half_m[k] * rng.range(-1.0..1.0));
            let pose = Pose::at([x, y, self.table_top_m()]).turned(2, rng.range(0.0..360.0));
            let solid = solid.clone().at(pose);
            (self.is_over_table(&solid) && self.is_free(&solid, &[], gap_m)).then_some(pose)
        })
    }

    /// Stands `solid` at a place of the table that is known to be free.
    pub(crate) fn stand_on_table(&mut self, solid: &Solid, pose: Pose) -> usize {
        self.rest(solid.clone().at(pose), self.table, ContactKind::StandsOn)
    }

    /// Adds `solid` where it is, without contact with anything.
    pub(crate) fn hang(&mut self, solid: Solid) -> usize {
        self.add(solid)
    }

    /// Adds `solid` where it is, which is in another one.
    pub(crate) fn insert(&mut self, solid: Solid, vessel: usize) -> usize {
        self.rest(solid, vessel, ContactKind::LiesIn)
    }

    /// Stands `solid` at a place of the table, if that is free.
    pub(crate) fn stand_at(&mut self, solid: &Solid, [x, y]: [f64; 2], yaw_deg: f64) -> Option<usize> {
        let solid = solid.clone().at(Pose::at([x, y, self.table_top_m()]).turned(2, yaw_deg));
        if !self.is_over_table(&solid) || !self.is_free(&solid, &[], GAP_M) {
            return None;
        }
        Some(self.rest(solid, self.table, ContactKind::StandsOn))
    }

    /// Stands `solid` on the lid of what was placed before, its middle over the lid.
    pub(crate) fn stack(&mut self, rng: &mut Rng, solid: &Solid, lower: usize) -> Option<usize> {
        let below = self.solids[lower].clone();
        if !below.form.has_flat_top || !solid.form.has_flat_base {
            return None;
        }
        (0..TRIES).find_map(|_| {
            let reach = match below.form.outline {
                Outline::Rectangle { half_m } => half_m.map(|half| half * 0.45),
                Outline::Disc { radius_m } => [radius_m * 0.3; 2],
            };
            let [x, y] = reach.map(|half| rng.range(-1.0..1.0) * half);
            let on_lid = below.pose.point(DVec3::new(x, y, below.form.height_m));
            let yaw = if rng.chance(0.5) { rng.range(-8.0..8.0) } else { rng.range(0.0..360.0) };
            let pose = Pose { origin: on_lid, ..below.pose }.turned(2, yaw);
            let solid = solid.clone().at(pose);
            self.is_free(&solid, &[lower], GAP_M).then(|| self.rest(solid, lower, ContactKind::StandsOn))
        })
    }

    /// Puts `solid` into a vessel: a ball to its lowest point, anything with a flat base onto a flat floor.
    pub(crate) fn fill(&mut self, rng: &mut Rng, solid: &Solid, vessel: usize) -> Option<usize> {
        let below = &self.solids[vessel];
        let radius = solid.form.outline.outer_radius_m();
        let (x, floor_z) = match below.form.cavity? {
            // Only a ball smaller than the cavity touches it in its lowest point alone.
            Cavity::Round { floor_z, radius_m } if !solid.form.has_flat_base && radius < 0.9 * radius_m => {
                (0.0, floor_z)
            }
            Cavity::Flat { floor_z, radius_m } if radius < radius_m - 0.001 => {
                (rng.range(0.0..1.0) * (radius_m - 0.001 - radius), floor_z)
            }
            _ => return None,
        };
        let pose = below.pose.turned(2, rng.range(0.0..360.0));
        let origin = pose.point(DVec3::new(x, 0.0, floor_z));
        let solid = solid.clone().at(Pose { origin, ..pose });
        self.is_free(&solid, &[vessel], GAP_M).then(|| self.rest(solid, vessel, ContactKind::LiesIn))
    }

    /// Stands `solid` side by side with `neighbor`, so that they touch. Both must have straight sides.
    pub(crate) fn touch(&mut self, rng: &mut Rng, solid: &Solid, neighbor: usize) -> Option<usize> {
        let other = self.solids[neighbor].clone();
        if !solid.form.has_straight_sides || !other.form.has_straight_sides || !self.is_on_table(neighbor) {
            return None;
        }
        (0..TRIES).find_map(|_| {
            let (normal, width) = match other.form.outline {
                Outline::Rectangle { half_m } => {
                    let side = rng.below(4);
                    let own = DVec3::AXES[side / 2] * [1.0, -1.0][side % 2];
                    (other.pose.rotation * own, half_m[1 - side / 2])
                }
                Outline::Disc { .. } => {
                    let (sin, cos) = libm::sincos(rng.range(0.0..std::f64::consts::TAU));
                    (DVec3::new(cos, sin, 0.0), 0.0)
                }
            };
            let tangent = DVec3::Z.cross(normal);
            // A flat face may touch a flat face anywhere, a round side only with its line of contact on the face.
            let half = match solid.form.outline {
                Outline::Rectangle { half_m } => half_m[1],
                Outline::Disc { .. } => 0.0,
            };
            let slide = rng.range(-0.7..0.7) * width.max(half);
            let pose = Pose {
                rotation: glam::DMat3::from_cols(-normal, -tangent, DVec3::Z),
                origin: DVec3::new(0.0, 0.0, self.table_top_m()),
            };
            let mut solid = solid.clone().at(pose);
            let distance = other.support(normal) + solid.support(-normal);
            let beside = tangent * (slide + other.pose.origin.dot(tangent));
            solid.pose.origin += normal * distance + beside;
            if !self.is_over_table(&solid) || !self.is_free(&solid, &[neighbor], GAP_M) {
                return None;
            }
            // In the middle of where the two faces overlap, low enough for the cover of a book.
            let low = (-width).max(slide - half);
            let high = width.min(slide + half);
            let point = tangent * (other.pose.origin.dot(tangent) + (low + high) / 2.0)
                + normal * other.support(normal)
                + DVec3::Z * (self.table_top_m() + LOW_M);
            let upper = self.rest(solid, self.table, ContactKind::StandsOn);
            self.contacts.push(contact(upper, neighbor, ContactKind::Touches, point, normal));
            Some(upper)
        })
    }

    /// Leans a thin box against a side of a higher one: its lower edge on the table, its upper edge at the side.
    pub(crate) fn lean(&mut self, rng: &mut Rng, slab: &Solid, against: usize) -> Option<usize> {
        let wall = self.solids[against].clone();
        let (Outline::Rectangle { half_m: wall_half }, Outline::Rectangle { half_m }) =
            (wall.form.outline, slab.form.outline)
        else {
            return None;
        };
        if !wall.form.has_straight_sides || !self.is_on_table(against) {
            return None;
        }
        (0..TRIES).find_map(|_| {
            let side = rng.below(4);
            let normal = wall.pose.rotation * (DVec3::AXES[side / 2] * [1.0, -1.0][side % 2]);
            let (width, tilt_deg) = (wall_half[1 - side / 2], rng.range(12.0..32.0));
            let (sin, cos) = libm::sincos(f64::to_radians(tilt_deg));
            // The slab's x runs along the side, its y (its thickness) away from it, its z up and towards it.
            let axes =
                [DVec3::Z.cross(normal), normal * -cos - DVec3::Z * sin, DVec3::Z * cos - normal * sin];
            let mut slab = slab.clone().at(Pose {
                rotation: glam::DMat3::from_cols(-axes[0], axes[1], axes[2]),
                origin: DVec3::ZERO,
            });
            let slide = rng.range(-0.5..0.5) * width;
            let tangent = axes[0];
            let lift = self.table_top_m() + slab.support(DVec3::NEG_Z);
            let distance = wall.support(normal) + slab.support(-normal);
            slab.pose.origin =
                tangent * (wall.pose.origin.dot(tangent) + slide) + normal * distance + DVec3::Z * lift;

            // The edges that touch: of the face towards the wall the upper one, of the other face the lower one.
            let upper_edge = slab.pose.point(DVec3::new(0.0, half_m[1], slab.form.height_m));
            let lower_edge = slab.pose.point(DVec3::new(0.0, half_m[1], 0.0));
            let lower_edge = if (lower_edge.z - self.table_top_m()).abs() < CONTACT_M {
                lower_edge
            } else {
                slab.pose.point(DVec3::new(0.0, -half_m[1], 0.0))
            };
            let on_wall = (upper_edge - wall.pose.origin).dot(tangent).abs() < width
                && upper_edge.z < wall.support(DVec3::Z) - 0.005;
            if !on_wall || !self.is_over_table(&slab) || !self.is_free(&slab, &[against], GAP_M) {
                return None;
            }
            let upper = self.add(slab);
            self.contacts.push(contact(upper, self.table, ContactKind::StandsOn, lower_edge, DVec3::Z));
            self.contacts.push(contact(upper, against, ContactKind::LeansOn, upper_edge, normal));
            Some(upper)
        })
    }

    fn is_on_table(&self, index: usize) -> bool {
        self.solids[index].pose.origin.z == self.table_top_m()
    }

    fn is_over_table(&self, solid: &Solid) -> bool {
        let table = &self.solids[self.table];
        [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y]
            .iter()
            .all(|&direction| solid.support(direction) <= table.support(direction) - GAP_M)
    }

    /// Whether `solid` keeps `gap_m` from everything placed, and does not interpenetrate what it `touches`.
    fn is_free(&self, solid: &Solid, touches: &[usize], gap_m: f64) -> bool {
        (self.table + 1..self.solids.len()).all(|k| {
            let needed = if touches.contains(&k) { -CONTACT_M } else { gap_m };
            let lies_in = touches.contains(&k) && self.solids[k].form.cavity.is_some();
            lies_in || separation(solid, &self.solids[k]) >= needed
        })
    }

    /// Adds `solid`, which rests with its origin on `lower`.
    fn rest(&mut self, solid: Solid, lower: usize, kind: ContactKind) -> usize {
        let point = solid.pose.origin;
        let upper = self.add(solid);
        self.contacts.push(contact(upper, lower, kind, point, DVec3::Z));
        upper
    }

    fn add(&mut self, solid: Solid) -> usize {
        self.solids.push(solid);
        self.solids.len() - 1
    }
}

fn contact(upper: usize, lower: usize, kind: ContactKind, point: DVec3, normal: DVec3) -> Contact {
    let instance = |index: usize| index as u16 + 1;
    Contact {
        upper: instance(upper),
        lower: instance(lower),
        kind,
        point_m: point.into(),
        normal: normal.into(),
    }
}

/// A lower bound of the distance of two solids (m); negative when none of the directions tried keeps them apart.
pub(crate) fn separation(a: &Solid, b: &Solid) -> f64 {
    let around = (0..36).map(|k| {
        let (sin, cos) = libm::sincos(f64::to_radians(10.0 * f64::from(k)));
        DVec3::new(cos, sin, 0.0)
    });
    let axes = [a, b]
        .into_iter()
        .flat_map(|solid| (0..3).flat_map(|k| [solid.pose.rotation.col(k), -solid.pose.rotation.col(k)]));
    let between = b.pose.origin - a.pose.origin;
    let flat = DVec3::new(between.x, between.y, 0.0).normalize_or(DVec3::X);
    around
        .chain(axes)
        .chain([DVec3::Z, DVec3::NEG_Z, flat])
        .map(|direction| -a.support(direction) - b.support(-direction))
        .fold(f64::NEG_INFINITY, f64::max)
}
