//! Kinds of scenes: each a distribution of things, places, light and camera.

mod arm;
mod bin;
pub(crate) mod bodies;
mod contents;
mod crowd;
mod flush;
pub(crate) mod furniture;
mod heap;
mod parts;
mod patterned;
mod printed;
mod rooms;
pub(crate) mod setting;
mod shelf;
pub(crate) mod tables;
#[cfg(test)]
mod tests;
mod thin;
mod tools;
pub(crate) mod views;

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, choices};
use crate::place::{Layout, Region};
use crate::random::Rng;
use crate::view::View;
use crate::world::{Sight, Viewpoint, World};

pub use crowd::crowd;

/// A kind of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
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
    /// A room with furniture, seen from its other end; things on the table, on the floor and on a cupboard.
    Room,
    /// Boards at several heights with things on them, seen from the front.
    Shelf,
    /// A bin with things in it, seen from above.
    Bin,
    /// Twenty and more things piled on a table; about half are hidden by a tenth or more of their pixels.
    Heap,
    /// People beside a table with things.
    Bodies,
    /// The arm of a robot that reaches over a table with things.
    RobotArm,
    /// A table with nothing on it.
    EmptyTable,
    /// A room with furniture and nothing else.
    EmptyRoom,
    /// Boxes pushed together in rows and towers, so that faces go on in each other; of different colour or print.
    Flush,
    /// The same, but the boxes of a group look alike.
    FlushAlike,
    /// Boxes that stand alone, with blocks of colour, bands, labels and print that are no joints.
    Printed,
    /// Flat things, 0.5 to 12 mm thick, of the colour of the table or another.
    Thin,
    /// Tables with tiles, stripes, cloths, stains and sharp shadows; none to two tall things and nothing flat.
    Patterned,
    /// Bodies of two and more convex parts: toys, animals, bottles, pots with lids, mugs with big handles.
    Parts,
    /// Vessels with contents that touch their walls or fill them; bowls in bowls.
    Contents,
    /// Elongated things with a handle of another colour, lying.
    Tools,
}

impl Family {
    /// Every family there is.
    pub const ALL: [Self; 22] = [
        Self::Single,
        Self::Tabletop,
        Self::Stacked,
        Self::Occluded,
        Self::Vessels,
        Self::Clutter,
        Self::Room,
        Self::Shelf,
        Self::Bin,
        Self::Heap,
        Self::Bodies,
        Self::RobotArm,
        Self::EmptyTable,
        Self::EmptyRoom,
        Self::Flush,
        Self::FlushAlike,
        Self::Printed,
        Self::Thin,
        Self::Patterned,
        Self::Parts,
        Self::Contents,
        Self::Tools,
    ];

    /// Those whose things stand on a table in plain view.
    pub const TABLES: [Self; 6] =
        [Self::Single, Self::Tabletop, Self::Stacked, Self::Occluded, Self::Vessels, Self::Clutter];

    /// Those that ask what colour tells where depth is silent.
    pub const COLOR: [Self; 8] = [
        Self::Flush,
        Self::FlushAlike,
        Self::Printed,
        Self::Thin,
        Self::Patterned,
        Self::Parts,
        Self::Contents,
        Self::Tools,
    ];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Tabletop => "tabletop",
            Self::Stacked => "stacked",
            Self::Occluded => "occluded",
            Self::Vessels => "vessels",
            Self::Clutter => "clutter",
            Self::Room => "room",
            Self::Shelf => "shelf",
            Self::Bin => "bin",
            Self::Heap => "heap",
            Self::Bodies => "bodies",
            Self::RobotArm => "robot-arm",
            Self::EmptyTable => "empty-table",
            Self::EmptyRoom => "empty-room",
            Self::Flush => "flush",
            Self::FlushAlike => "flush-alike",
            Self::Printed => "printed",
            Self::Thin => "thin",
            Self::Patterned => "patterned",
            Self::Parts => "parts",
            Self::Contents => "contents",
            Self::Tools => "tools",
        }
    }

    fn is_about_color(self) -> bool {
        Self::COLOR.contains(&self)
    }

    /// So many objects a scene has at least.
    fn fewest(self) -> usize {
        match self {
            Self::EmptyTable | Self::EmptyRoom | Self::Patterned => 0,
            Self::Single | Self::Printed | Self::Parts | Self::Tools => 1,
            Self::Flush | Self::FlushAlike | Self::Thin | Self::Contents => 2,
            Self::Room | Self::Bin => 5,
            Self::Shelf => 6,
            Self::Clutter => 8,
            Self::Heap => 20,
            _ => 3,
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

/// A Kinect sees nothing nearer than 0.45 m.
const NEAREST_M: f64 = 0.48;
/// Scenes that miss what their family is about are drawn anew, this often at most.
const DRAWS: u64 = 16;
/// A thing that shows less than this share of itself is not seen; one that shows more than the other is not hidden.
const SEEN: f64 = 0.1;
const WHOLE: f64 = 0.9;

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
    if family == Family::Patterned {
        return patterned::table(rng, seed);
    }
    let (layout, viewpoint) = match family {
        Family::Room => rooms::furnished(rng, true),
        Family::EmptyRoom => rooms::furnished(rng, false),
        Family::Shelf => shelf::filled(rng),
        Family::Bin => bin::filled(rng),
        Family::Heap => heap::piled(rng),
        Family::Bodies => bodies::beside_table(rng),
        Family::RobotArm => arm::over_table(rng),
        _ => on_table(family, rng),
    };
    let lighting = if family.is_about_color() { views::mixed_lighting(rng) } else { views::lighting(rng) };
    World::new(seed, layout.solids, layout.contacts, lighting, viewpoint)
}

fn on_table(family: Family, rng: &mut Rng) -> (Layout, Viewpoint) {
    let viewpoint = views::at_table(rng);
    let mut layout = setting::with_table(rng, family == Family::Clutter);
    let middle = tables::MIDDLE;
    match family {
        Family::Single => {
            let thing = tables::any(rng);
            layout.stand(rng, &thing, Region { half_m: [0.12, 0.10], ..middle });
        }
        Family::Tabletop => {
            let count = 3 + rng.below(6);
            tables::tabletop(rng, &mut layout, count, middle);
        }
        Family::Stacked => tables::stacked(rng, &mut layout),
        Family::Occluded => tables::occluded(rng, &mut layout, &viewpoint),
        Family::Vessels => tables::vessels(rng, &mut layout),
        Family::Flush => flush::pushed_together(rng, &mut layout, false),
        Family::FlushAlike => flush::pushed_together(rng, &mut layout, true),
        Family::Printed => printed::boxes(rng, &mut layout),
        Family::Thin => thin::lying(rng, &mut layout),
        Family::Parts => parts::bodies(rng, &mut layout),
        Family::Contents => contents::filled(rng, &mut layout),
        Family::Tools => tools::lying(rng, &mut layout),
        Family::Clutter => {
            let count = 9 + rng.below(6);
            tables::tabletop(rng, &mut layout, count, Region { half_m: [0.40, 0.28], ..middle });
            tables::stacked(rng, &mut layout);
        }
        _ => {}
    }
    (layout, viewpoint)
}

/// Enough objects are seen, but in piles all of them; nothing is nearer than any sensor sees; no object is cut by the
/// border of the image where one can keep clear of it; what shall be hidden is.
fn is_typical(family: Family, world: &World) -> bool {
    let view = View::of(&world.at_quarter_size());
    let visible = view.visible_fractions();
    let is_object =
        |sight: &Sight| usize::from(sight.instance) > world.solids().len() - world.objects().count();
    let cut = view.border().flatten().any(is_object);
    let may_be_cut = matches!(family, Family::Clutter | Family::Room | Family::Shelf);
    let too_near = view.sights.iter().flatten().any(|sight| sight.t < NEAREST_M);
    let objects: Vec<f64> = world.objects().map(|instance| visible[usize::from(instance) - 1]).collect();
    let seen = objects.iter().filter(|&&share| share > SEEN).count();
    let is_pile = matches!(family, Family::Bin | Family::Heap);
    seen >= family.fewest()
        && (seen == objects.len() || is_pile)
        && !too_near
        && (!cut || may_be_cut)
        && hides_enough(family, &objects)
}

/// Whether as much is hidden as the family promises; of every object the share that is seen.
fn hides_enough(family: Family, objects: &[f64]) -> bool {
    match family {
        Family::Occluded => objects.iter().any(|share| (0.15..0.75).contains(share)),
        Family::Heap => {
            let hidden = objects.iter().filter(|&&share| share < WHOLE).count();
            (0.35..0.7).contains(&(hidden as f64 / objects.len() as f64))
        }
        _ => true,
    }
}
