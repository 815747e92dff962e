//! A thing: shapes that move together, with their paint.

use glam::DVec3;

use crate::pose::Pose;
use crate::shape::Shape;
use crate::texture::Paint;

/// What a solid is in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Role {
    /// Walls and floor, and what is fixed to them.
    Room,
    /// What things stand on, and what else nobody is to grasp: chairs, cables, bins, people, machines.
    Furniture,
    /// What can be grasped and moved.
    Object,
    /// Who moves objects in a video: hands with their arms, people who walk.
    Agent,
}

/// One thing of a scene.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(crate) kind: &'static str,
    pub(crate) role: Role,
    pub(crate) parts: Vec<Part>,
    pub(crate) form: Form,
    /// Its origin is the point of it that touches what it stands on, its z axis then points up.
    pub(crate) pose: Pose,
}

/// A shape of a thing, with one paint for all its faces or one for each.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) shape: Shape,
    pub(crate) pose: Pose,
    pub(crate) paints: Vec<Paint>,
}

/// What placing a thing needs to know of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    pub(crate) outline: Outline,
    pub(crate) height_m: f64,
    /// Whether its sides are vertical all the way up: others can touch them.
    pub(crate) has_straight_sides: bool,
    /// Whether its top is the flat lid of its outline: others can stand on it.
    pub(crate) has_flat_top: bool,
    /// Whether it stands on more than a point or a line.
    pub(crate) has_flat_base: bool,
    pub(crate) cavity: Option<Cavity>,
}

/// The outline of a thing from above.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Outline {
    Rectangle { half_m: [f64; 2] },
    Disc { radius_m: f64 },
}

/// The inside of a vessel.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cavity {
    /// Part of a ball with its lowest point on the axis.
    Round { floor_z: f64, radius_m: f64 },
    /// A flat floor; the walls do not lean inwards.
    Flat { floor_z: f64, radius_m: f64 },
}

impl Solid {
    /// What it is: `box`, `mug`, `table`, ..
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// What it is in the scene.
    pub fn role(&self) -> Role {
        self.role
    }

    /// Where it stands, in the frame of the world.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Lowest and highest coordinates (m) along the axes of its own frame.
    pub fn bounds_m(&self) -> [[f64; 3]; 2] {
        let own = Self { pose: Pose::at([0.0; 3]), ..self.clone() };
        let reach = |sign: f64| [0, 1, 2].map(|k| sign * own.support(DVec3::AXES[k] * sign));
        [reach(-1.0), reach(1.0)]
    }

    /// How far it reaches in a direction of the world: the greatest `direction` · p.
    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        let reach = |part: &Part| {
            let pose = self.pose.after(&part.pose);
            part.shape.support(pose.own_direction(direction)) + pose.origin.dot(direction)
        };
        self.parts.iter().map(reach).fold(f64::NEG_INFINITY, f64::max)
    }

    pub(crate) fn at(self, pose: Pose) -> Self {
        Self { pose, ..self }
    }

    /// Laid on its side: turned by a quarter about its y axis, so that it rests on what was its side.
    pub(crate) fn laid(self) -> Self {
        self.laid_dipped(0.0)
    }

    /// The same, but what was its upper end dips by an angle.
    pub(crate) fn laid_dipped(mut self, dip_deg: f64) -> Self {
        let turned = Pose::at([0.0; 3]).turned(1, 90.0 + dip_deg);
        for part in &mut self.parts {
            part.pose = turned.after(&part.pose);
        }
        self.pose = Pose::at([0.0; 3]);
        let lift = self.support(DVec3::NEG_Z);
        let shift = (self.support(DVec3::NEG_X) - self.support(DVec3::X)) / 2.0;
        for part in &mut self.parts {
            part.pose.origin += DVec3::new(shift, 0.0, lift);
        }
        let half_m = [self.support(DVec3::X), self.support(DVec3::Y)];
        self.form = Form {
            outline: Outline::Rectangle { half_m },
            height_m: self.support(DVec3::Z),
            has_straight_sides: false,
            has_flat_top: false,
            has_flat_base: false,
            cavity: None,
        };
        self
    }

    pub(crate) fn surfaces(&self) -> usize {
        self.parts.iter().map(|part| part.shape.surfaces()).sum()
    }
}

impl Outline {
    /// Radius of the circle around it.
    pub(crate) fn outer_radius_m(self) -> f64 {
        match self {
            Self::Rectangle { half_m: [x, y] } => libm::hypot(x, y),
            Self::Disc { radius_m } => radius_m,
        }
    }
}

/// Which solids a point of the world lies in, independently of rays and supports.
#[cfg(test)]
pub(crate) struct Probe {
    parts: Vec<(usize, Shape, Pose, DVec3, f64)>,
}

#[cfg(test)]
impl Probe {
    pub(crate) fn new(solids: &[Solid]) -> Self {
        let mut parts = Vec::new();
        for (k, solid) in solids.iter().enumerate() {
            for part in &solid.parts {
                let (center, radius) = part.shape.bounding_sphere();
                let pose = solid.pose.after(&part.pose);
                parts.push((k, part.shape.clone(), pose, pose.point(center), radius));
            }
        }
        Self { parts }
    }

    /// Indices of the solids around `p`.
    pub(crate) fn at(&self, p: DVec3) -> impl Iterator<Item = usize> {
        let around = self.parts.iter().filter(move |(_, shape, pose, center, radius)| {
            (p - center).length_squared() <= radius * radius
                && crate::shape::testing::contains(shape, pose.own_direction(p - pose.origin))
        });
        around.map(|part| part.0)
    }
}
