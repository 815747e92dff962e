//! Kinds of scenes: each a distribution of things, places, light and camera.

mod crowd;
mod room;

use std::fmt;
use std::str::FromStr;

use glam::DVec3;
use objecthood::Camera;

use crate::error::{Error, choices};
use crate::light::Lighting;
use crate::place::{Layout, Region};
use crate::pose::Pose;
use crate::random::Rng;
use crate::solid::Solid;
use crate::thing;
use crate::view::View;
use crate::world::{Sight, Viewpoint, World};

pub use crowd::crowd;

/// A kind of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Family {
    /// One thing on a table.
    Single,
    /// Three to eight things of all kinds, some lying, some side by side.
    Tabletop,
    /// Boxes, books and cans on each other; thin boxes that lean.
    Stacked,
    /// Things partly hidden behind others.
    Occluded,
    /// Bowls, mugs, cups and plates, some with something in them.
    Vessels,
    /// Many things of all kinds before a shelf, with a cable and sheets of paper on the table and a chair beside it.
    Clutter,
}

impl Family {
    /// Every family there is.
    pub const ALL: [Self; 6] =
        [Self::Single, Self::Tabletop, Self::Stacked, Self::Occluded, Self::Vessels, Self::Clutter];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Tabletop => "tabletop",
            Self::Stacked => "stacked",
            Self::Occluded => "occluded",
            Self::Vessels => "vessels",
            Self::Clutter => "clutter",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Family {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|family| family.name() == name)
            .ok_or_else(|| Error::UnknownFamily { name: name.to_owned(), known: choices(Self::ALL) })
    }
}

/// Where things are put on the table.
const MIDDLE: Region = Region { center_m: [0.0, 0.0], half_m: [0.30, 0.24] };
/// A Kinect sees nothing nearer than 0.45 m.
const NEAREST_M: f64 = 0.48;
/// Stacks are no higher than this.
const HIGHEST_M: f64 = 0.30;
/// Scenes that miss what their family is about are drawn anew, this often at most.
const DRAWS: u64 = 16;

/// The scene of a family with this seed. The same seed gives the same scene on every machine.
pub fn generate(family: Family, seed: u64) -> World {
    let mut world = draw(family, seed, 0);
    for attempt in 1..DRAWS {
        if is_typical(family, &world) {
            break;
        }
        world = draw(family, seed, attempt);
    }
    world
}

fn draw(family: Family, seed: u64, attempt: u64) -> World {
    let mut rng = Rng::new(seed, family as u64 * 1000 + attempt);
    let rng = &mut rng;
    let viewpoint = viewpoint(rng);
    let mut layout = room::with_table(rng, family == Family::Clutter);
    match family {
        Family::Single => {
            let thing = any(rng);
            layout.stand(rng, &thing, Region { half_m: [0.12, 0.10], ..MIDDLE });
        }
        Family::Tabletop => {
            let count = 3 + rng.below(6);
            tabletop(rng, &mut layout, count, MIDDLE);
        }
        Family::Stacked => stacked(rng, &mut layout),
        Family::Occluded => occluded(rng, &mut layout, &viewpoint),
        Family::Vessels => vessels(rng, &mut layout),
        Family::Clutter => {
            let count = 9 + rng.below(6);
            tabletop(rng, &mut layout, count, Region { half_m: [0.40, 0.28], ..MIDDLE });
            stacked(rng, &mut layout);
        }
    }
    World::new(seed, layout.solids, layout.contacts, lighting(rng), viewpoint)
}

/// Every object is seen, none is nearer than any sensor sees; none is cut by the border of the image, but in `clutter`; in
/// `occluded` one is partly hidden.
fn is_typical(family: Family, world: &World) -> bool {
    let view = View::of(&world.at_quarter_size());
    let visible = view.visible_fractions();
    let is_object =
        |sight: &Sight| usize::from(sight.instance) > world.solids().len() - world.objects().count();
    let cut = view.border().flatten().any(is_object);
    let too_near = view.sights.iter().flatten().any(|sight| sight.t < NEAREST_M);
    let objects: Vec<f64> = world.objects().map(|instance| visible[usize::from(instance) - 1]).collect();
    let all_seen = !objects.is_empty() && objects.iter().all(|&share| share > 0.1);
    let least = match family {
        Family::Single => 1,
        Family::Clutter => 8,
        _ => 3,
    };
    let one_hidden = objects.iter().any(|share| (0.15..0.75).contains(share));
    all_seen
        && !too_near
        && (!cut || family == Family::Clutter)
        && objects.len() >= least
        && (family != Family::Occluded || one_hidden)
}

/// Someone who stands or sits at the table: 0.78 to 1.1 m from its middle, 28 to 52 degrees above.
fn viewpoint(rng: &mut Rng) -> Viewpoint {
    let (distance, elevation) = (rng.range(0.78..1.1), rng.range(28.0..52.0_f64).to_radians());
    let azimuth = rng.range(-35.0..35.0_f64).to_radians();
    let ((sin_e, cos_e), (sin_a, cos_a)) = (libm::sincos(elevation), libm::sincos(azimuth));
    let target = DVec3::new(rng.range(-0.04..0.04), rng.range(-0.04..0.04), room::TABLE_M + 0.03);
    let eye = target + DVec3::new(sin_a * cos_e, -cos_a * cos_e, sin_e) * distance;
    let pose = Pose::looking_at(eye.into(), target.into());
    kinect_at(pose.turned(2, rng.range(-4.0..4.0)))
}

/// A camera with the nominal intrinsics of a Kinect v1, which mOSD has too.
fn kinect_at(pose: Pose) -> Viewpoint {
    let camera = Camera { fx_px: 525.0, fy_px: 525.0, cx_px: 319.5, cy_px: 239.5 };
    Viewpoint { camera, size_px: (640, 480), pose }
}

/// A lamp between warm and cold, above and to one side, and the light of the room.
fn lighting(rng: &mut Rng) -> Lighting {
    let warmth = rng.range(-0.12..0.12);
    let tint = [1.0 + warmth, 1.0, 1.0 - warmth];
    let height = rng.range(1.2..1.9);
    let (lamp, sky) = (rng.range(0.35..0.65) * height * height, rng.range(0.4..0.6));
    Lighting {
        lamp_m: DVec3::new(rng.range(-1.0..1.0), rng.range(-0.8..0.6), room::TABLE_M + height),
        lamp_radius_m: rng.range(0.12..0.45),
        lamp: tint.map(|c| c * lamp),
        sky: tint.map(|c| sky * (2.0 - c)),
    }
}

/// Any thing that stands by itself.
fn any(rng: &mut Rng) -> Solid {
    match rng.below(12) {
        0..4 => thing::package(rng),
        4 => thing::book(rng),
        5 | 6 => thing::can(rng),
        7 => thing::bottle(rng),
        8 => {
            let radius = rng.range(0.03..0.06);
            thing::ball(rng, radius)
        }
        9 => thing::cone(rng),
        10 => thing::mug(rng),
        _ => thing::bowl(rng),
    }
}

/// Something with straight sides.
fn straight(rng: &mut Rng) -> Solid {
    match rng.below(4) {
        0 => thing::can(rng),
        1 => thing::book(rng),
        _ => thing::package(rng),
    }
}

fn tabletop(rng: &mut Rng, layout: &mut Layout, count: usize, region: Region) {
    for _ in 0..count {
        let choice = rng.range(0.0..1.0);
        if choice < 0.25 && !layout.placed().is_empty() {
            let neighbor = layout.placed().start + rng.below(layout.placed().len());
            let thing = straight(rng);
            layout.touch(rng, &thing, neighbor);
        } else if choice < 0.4 {
            let thing = if rng.chance(0.5) { thing::can(rng) } else { thing::bottle(rng) };
            layout.stand(rng, &thing.laid(), region);
        } else {
            let thing = any(rng);
            layout.stand(rng, &thing, region);
        }
    }
}

fn stacked(rng: &mut Rng, layout: &mut Layout) {
    let stacks = 2 + rng.below(2);
    for _ in 0..stacks {
        let base = if rng.chance(0.3) { thing::book(rng) } else { thing::package(rng) };
        let Some(mut top) = layout.stand(rng, &base, MIDDLE) else { continue };
        for _ in 0..1 + rng.below(3) {
            let next = if rng.chance(0.15) { any(rng) } else { straight(rng) };
            if layout.top_m(top) + next.form.height_m > room::TABLE_M + HIGHEST_M {
                continue;
            }
            top = match layout.stack(rng, &next, top) {
                Some(next) => next,
                None => break,
            };
        }
    }
    let walls: Vec<usize> = layout.placed().collect();
    for wall in walls {
        if rng.chance(0.7) {
            let slab = thing::slab(rng);
            layout.lean(rng, &slab, wall);
        }
    }
}

fn occluded(rng: &mut Rng, layout: &mut Layout, viewpoint: &Viewpoint) {
    let region = Region { center_m: [0.0, 0.10], half_m: [0.26, 0.14] };
    for _ in 0..2 + rng.below(2) {
        let hidden = if rng.chance(0.6) { thing::package(rng) } else { any(rng) };
        layout.stand(rng, &hidden, region);
    }
    for index in layout.placed() {
        let place = layout.solids[index].pose.origin;
        let toward = viewpoint.pose.origin - place;
        let toward = DVec3::new(toward.x, toward.y, 0.0).normalize();
        for _ in 0..8 {
            let cover = if rng.chance(0.7) { thing::package(rng) } else { straight(rng) };
            let reach = |solid: &Solid| solid.form.outline.outer_radius_m();
            let distance = reach(&layout.solids[index]) + reach(&cover) + rng.range(0.01..0.06);
            let aside = toward.cross(DVec3::Z) * (rng.range(-0.9..0.9) * reach(&layout.solids[index]));
            let place = place + toward * distance + aside;
            if cover.form.height_m > 0.08
                && layout.stand_at(&cover, [place.x, place.y], rng.range(0.0..360.0)).is_some()
            {
                break;
            }
        }
    }
}

fn vessels(rng: &mut Rng, layout: &mut Layout) {
    for _ in 0..3 + rng.below(3) {
        let vessel = match rng.below(4) {
            0 => thing::bowl(rng),
            1 => thing::mug(rng),
            2 => thing::cup(rng),
            _ => thing::plate(rng),
        };
        let Some(vessel) = layout.stand(rng, &vessel, MIDDLE) else { continue };
        if rng.chance(0.5) {
            let content = content(rng, layout.solids[vessel].kind);
            layout.fill(rng, &content, vessel);
        }
    }
    for _ in 0..rng.below(3) {
        let other = if rng.chance(0.5) { thing::bottle(rng) } else { thing::can(rng) };
        layout.stand(rng, &other, MIDDLE);
    }
}

fn content(rng: &mut Rng, vessel: &str) -> Solid {
    match vessel {
        "plate" if rng.chance(0.6) => thing::cup(rng),
        "bowl" | "plate" => {
            let radius = rng.range(0.028..0.042);
            thing::ball(rng, radius)
        }
        _ => {
            let radius = rng.range(0.014..0.021);
            thing::ball(rng, radius)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactKind;
    use crate::ray::Ray;
    use crate::solid::{Probe, Role};

    fn worlds() -> impl Iterator<Item = (Family, u64, World)> {
        Family::ALL
            .into_iter()
            .flat_map(|family| (0..12).map(move |seed| (family, seed, generate(family, seed))))
    }

    #[test]
    fn names_are_read_back() {
        for family in Family::ALL {
            assert_eq!(family.name().parse::<Family>().unwrap(), family);
        }
        let message = "desk".parse::<Family>().unwrap_err().to_string();
        assert!(
            message.contains("`desk`")
                && message.contains("single, tabletop")
                && message.contains("or clutter")
        );
    }

    #[test]
    fn contacts_are_exact() {
        let mut kinds = Vec::new();
        for (family, seed, world) in worlds() {
            for contact in world.contacts() {
                let (point, normal) = (DVec3::from(contact.point_m), DVec3::from(contact.normal));
                let (upper, lower) =
                    (world.solid(contact.upper).unwrap(), world.solid(contact.lower).unwrap());
                // The upper ends at the point, seen along the normal; the lower begins there.
                let upper_gap = -upper.support(-normal) - point.dot(normal);
                let above = Ray { origin: point + normal * 0.001, direction: -normal };
                let alone = world.with_only(contact.lower);
                let lower_gap = alone.first(above, &mut [0]).map(|sight| sight.t - 0.001);
                let lower_kind = lower.kind();
                assert!(upper_gap.abs() < 1e-9, "{family} {seed} {contact:?} {upper_gap}");
                assert!(
                    lower_gap.is_some_and(|gap| gap.abs() < 1e-9),
                    "{family} {seed} {contact:?} {lower_kind} {lower_gap:?}"
                );
                kinds.push(contact.kind);
            }
        }
        for kind in [ContactKind::StandsOn, ContactKind::LeansOn, ContactKind::LiesIn, ContactKind::Touches] {
            assert!(kinds.iter().filter(|&&k| k == kind).count() > 5, "{kind:?}");
        }
    }

    #[test]
    fn everything_rests_on_something_placed_before() {
        for (family, seed, world) in worlds() {
            for object in world.objects() {
                let rests = |c: &&crate::Contact| c.upper == object && c.kind != ContactKind::Touches;
                assert!(world.contacts().iter().any(|c| rests(&c)), "{family} {seed}: {object} floats");
            }
            assert!(world.contacts().iter().all(|contact| contact.lower < contact.upper));
        }
    }

    #[test]
    fn nothing_interpenetrates() {
        let mut rng = Rng::new(9, 9);
        for (family, seed, world) in worlds() {
            let probe = Probe::new(world.solids());
            for k in world.objects() {
                let solid = world.solid(k).unwrap();
                let [low, high] =
                    [-1.0, 1.0].map(|s| [0, 1, 2].map(|a| s * solid.support(DVec3::AXES[a] * s)));
                for _ in 0..500 {
                    let p = DVec3::from([0, 1, 2].map(|a| rng.range(low[a]..high[a])));
                    let own = usize::from(k) - 1;
                    let mut around: Vec<usize> = probe.at(p).collect();
                    around.dedup();
                    assert!(
                        !around.contains(&own) || around == [own],
                        "{family} {seed}: {around:?} in each other"
                    );
                }
            }
        }
    }

    #[test]
    fn scenes_show_what_their_family_promises() {
        let mut typical = 0;
        for (family, _, world) in worlds() {
            typical += usize::from(is_typical(family, &world));
            assert!(world.objects().count() >= 1);
            let roles = |role| world.solids().iter().filter(|solid| solid.role() == role).count();
            assert_eq!(roles(Role::Furniture), if family == Family::Clutter { 6 } else { 1 });
        }
        assert!(typical >= 68, "{typical} of 72");
    }
}
