//! What holds for the scenes of every family.

use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::*;
use crate::contact::ContactKind;
use crate::ray::Ray;
use crate::solid::{Probe, Role, Solid};
use crate::texture::Texture;

/// Twelve scenes of every family.
fn worlds() -> impl Iterator<Item = (Family, u64, &'static World)> {
    static WORLDS: LazyLock<Vec<World>> = LazyLock::new(|| {
        let all = Family::ALL.into_iter().flat_map(|family| (0..12).map(move |seed| (family, seed)));
        all.collect::<Vec<_>>().into_par_iter().map(|(family, seed)| generate(family, seed)).collect()
    });
    let all = Family::ALL.into_iter().flat_map(|family| (0..12).map(move |seed| (family, seed)));
    all.zip(WORLDS.iter()).map(|((family, seed), world)| (family, seed, world))
}

#[test]
fn names_are_read_back() {
    for family in Family::ALL {
        assert_eq!(family.name().parse::<Family>().unwrap(), family);
    }
    let message = "desk".parse::<Family>().unwrap_err().to_string();
    assert!(
        message.contains("`desk`") && message.contains("single, tabletop") && message.contains("or tools")
    );
}

#[test]
fn contacts_are_exact() {
    let mut kinds = Vec::new();
    for (family, seed, world) in worlds() {
        for contact in world.contacts() {
            let (point, normal) = (DVec3::from(contact.point_m), DVec3::from(contact.normal));
            let (upper, lower) = (world.solid(contact.upper).unwrap(), world.solid(contact.lower).unwrap());
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
            let [low, high] = [-1.0, 1.0].map(|s| [0, 1, 2].map(|a| s * solid.support(DVec3::AXES[a] * s)));
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
    for family in Family::ALL {
        let own = || worlds().filter(|(of, ..)| *of == family).map(|(.., world)| world);
        let typical = own().filter(|world| is_typical(family, world)).count();
        assert!(typical >= 11, "{family}: {typical} of 12");
        for world in own() {
            assert!(world.objects().count() >= family.fewest().min(1), "{family}");
            let pieces = world.solids().iter().filter(|solid| solid.role() == Role::Furniture).count();
            let expected = match family {
                Family::Clutter => 6..7,
                Family::Room | Family::EmptyRoom => 4..5,
                Family::Bin => 2..3,
                Family::Patterned => 1..3,
                Family::Bodies => 2..4,
                Family::RobotArm => 9..10,
                _ => 1..2,
            };
            assert!(expected.contains(&pieces), "{family}: {pieces}");
        }
    }
}

#[test]
fn nothing_stands_in_empty_scenes() {
    let empty = worlds().filter(|(family, ..)| family.name().starts_with("empty"));
    let counts: Vec<usize> = empty.map(|(.., world)| world.objects().count()).collect();
    assert_eq!(counts, [0; 24]);
}

#[test]
fn heaps_have_several_layers() {
    for (_, seed, world) in worlds().filter(|(family, ..)| *family == Family::Heap) {
        let is_object = |instance| world.solid(instance).is_some_and(|solid| solid.role() == Role::Object);
        let upper = world.contacts().iter().filter(|contact| is_object(contact.lower)).count();
        let all = world.objects().count();
        assert!(upper * 3 >= all, "{seed}: {upper} of {all} lie on others");
    }
}

fn of(wanted: Family) -> impl Iterator<Item = (u64, &'static World)> {
    worlds().filter(move |(family, ..)| *family == wanted).map(|(_, seed, world)| (seed, world))
}

fn object_heights_m(world: &World) -> impl Iterator<Item = f64> + '_ {
    world.objects().map(|instance| {
        let [low, high] = world.solid(instance).unwrap().bounds_m();
        high[2] - low[2]
    })
}

#[test]
fn flush_things_go_on_in_each_other_without_a_gap() {
    for (family, are_alike) in [(Family::Flush, false), (Family::FlushAlike, true)] {
        let mut pairs = 0;
        for (seed, world) in of(family) {
            for contact in world.contacts() {
                let (upper, lower) =
                    (world.solid(contact.upper).unwrap(), world.solid(contact.lower).unwrap());
                if lower.role() != Role::Object {
                    continue;
                }
                pairs += 1;
                let (normal, front) = (DVec3::from(contact.normal), -lower.pose.rotation.col(1));
                let gap = -upper.support(-normal) - lower.support(normal);
                let step = upper.support(front) - lower.support(front);
                assert!(gap.abs() < 1e-9 && step.abs() < 1e-9, "{family} {seed}: {gap} {step}");
                let paint = |solid: &Solid| format!("{:?}", solid.parts[0].paints);
                assert_eq!(paint(upper) == paint(lower), are_alike, "{family} {seed}");
            }
        }
        assert!(pairs > 20, "{family}: {pairs}");
    }
}

#[test]
fn printed_boxes_stand_alone() {
    for (seed, world) in of(Family::Printed) {
        let on_table = world.contacts().iter().all(|c| world.solid(c.lower).unwrap().kind() == "table");
        assert!(on_table, "{seed}");
        for instance in world.objects() {
            let paints = &world.solid(instance).unwrap().parts[0].paints;
            assert!(!matches!(paints[2].texture, Texture::Plain | Texture::Wood { .. }), "{seed}");
        }
    }
}

#[test]
fn thin_things_are_thin() {
    let heights: Vec<f64> = of(Family::Thin).flat_map(|(_, world)| object_heights_m(world)).collect();
    assert!(heights.iter().all(|height| (0.0005..=0.012).contains(height)), "{heights:?}");
    assert!(heights.iter().filter(|&&height| height < 0.002).count() >= 3, "{heights:?}");
    assert!(heights.iter().filter(|&&height| height > 0.006).count() >= 3, "{heights:?}");
}

#[test]
fn nothing_flat_lies_on_patterned_tables_and_nobody_sees_what_throws_shadows() {
    let mut screens = 0;
    for (seed, world) in of(Family::Patterned) {
        assert!(
            object_heights_m(world).all(|height| height > 0.03) && world.objects().count() <= 2,
            "{seed}"
        );
        let is_screen = |instance| world.solid(instance).is_some_and(|solid| solid.kind() == "screen");
        let view = View::of(&world.at_quarter_size());
        assert!(!view.sights.iter().flatten().any(|sight| is_screen(sight.instance)), "{seed}");
        screens += world.solids().iter().filter(|solid| solid.kind() == "screen").count();
    }
    assert!(screens > 5, "{screens}");
}

#[test]
fn bodies_of_parts_are_of_all_kinds() {
    let kinds = |family| {
        let all = of(family).flat_map(|(_, world)| world.objects().map(|k| world.solid(k).unwrap().kind()));
        let mut kinds: Vec<_> = all.collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    };
    assert_eq!(kinds(Family::Parts), ["animal", "bottle", "doll", "mug", "pawn", "pot"]);
    assert_eq!(kinds(Family::Tools), ["brush", "hammer", "knife", "screwdriver"]);
}

#[test]
fn contents_lie_in_vessels() {
    let lie_in = |world: &World| world.contacts().iter().any(|c| c.kind == ContactKind::LiesIn);
    assert!(of(Family::Contents).filter(|(_, world)| lie_in(world)).count() >= 11);
    let is_nested = |c: &crate::Contact, world: &World| {
        [c.upper, c.lower].iter().all(|&k| world.solid(k).unwrap().kind() == "bowl")
    };
    let nested =
        of(Family::Contents).filter(|(_, world)| world.contacts().iter().any(|c| is_nested(c, world)));
    assert!(nested.count() >= 2);
}
