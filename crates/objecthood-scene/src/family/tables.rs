//! What stands on a table, by kind of scene.

use glam::DVec3;

use super::setting::TABLE_M;
use crate::place::{Layout, Region};
use crate::random::Rng;
use crate::solid::Solid;
use crate::thing;
use crate::world::Viewpoint;

/// Where things are put on the table.
pub(crate) const MIDDLE: Region = Region { center_m: [0.0, 0.0], half_m: [0.30, 0.24] };
/// Stacks are no higher than this.
const HIGHEST_M: f64 = 0.30;

/// Any thing that stands by itself.
pub(crate) fn any(rng: &mut Rng) -> Solid {
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

/// Things of all kinds, some lying, some side by side.
pub(crate) fn tabletop(rng: &mut Rng, layout: &mut Layout, count: usize, region: Region) {
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

/// Stacks, and thin boxes that lean.
pub(crate) fn stacked(rng: &mut Rng, layout: &mut Layout) {
    let stacks = 2 + rng.below(2);
    for _ in 0..stacks {
        let base = if rng.chance(0.3) { thing::book(rng) } else { thing::package(rng) };
        let Some(mut top) = layout.stand(rng, &base, MIDDLE) else { continue };
        for _ in 0..1 + rng.below(3) {
            let next = if rng.chance(0.15) { any(rng) } else { straight(rng) };
            if layout.top_m(top) + next.form.height_m > TABLE_M + HIGHEST_M {
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

/// Things partly hidden behind others.
pub(crate) fn occluded(rng: &mut Rng, layout: &mut Layout, viewpoint: &Viewpoint) {
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

/// Bowls, mugs, cups and plates, some with something in them.
pub(crate) fn vessels(rng: &mut Rng, layout: &mut Layout) {
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
