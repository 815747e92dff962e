//! What only colour can tell, beyond strict verdicts: groups of flush boxes, print, thickness, and flat things where there are none.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "what fails and what was measured is reported so"
)]

use std::collections::BTreeMap;

use glam::Vec3;
use objecthood::{Discovery, Params, discover};
use objecthood_eval::{Verdict, mosd, score};
use objecthood_scene::{Family, Rendered, Sensor, World, export, generate, render};
use rayon::prelude::*;

/// The first of other scenes than those on which the rules were made.
const FIRST_SEED: u64 = 2000;
/// A joint may lie this far from the true one (px).
const JOINT_PX: usize = 4;
/// Of what is farther from the joints, this share has one label in a box that is not cut.
const ONE_LABEL: f64 = 0.9;
/// A thing has another colour than what is around it from this difference of mean RGB on (of 255).
const CONTRAST: f32 = 40.0;
/// So far around a thing its surroundings are looked at (px).
const AROUND_PX: usize = 12;
/// Thinner things (m) lie within the noise.
const THICK_M: f64 = 0.002;

/// Right ones, and all.
#[derive(Clone, Copy, Debug, Default)]
struct Share(usize, usize);

impl Share {
    fn count(&mut self, is_right: bool) {
        self.0 += usize::from(is_right);
        self.1 += 1;
    }

    fn of(self) -> f64 {
        self.0 as f64 / self.1.max(1) as f64
    }
}

/// A scene, as a Kinect sees it, and what is found in it.
struct Seen {
    world: World,
    rendered: Rendered,
    found: Discovery,
}

impl Seen {
    fn of(family: Family, seed: u64) -> Self {
        let world = generate(family, seed);
        let rendered = render(&world, Sensor::Kinect).unwrap();
        let found = discover(&rendered.frame, &Params::default()).unwrap();
        Self { world, rendered, found }
    }

    /// The pixels of an object.
    fn pixels(&self, instance: u16) -> Vec<usize> {
        let truth = self.rendered.truth.instance.as_slice();
        (0..truth.len()).filter(|&i| truth[i] == instance).collect()
    }

    /// The strict verdict on each object that is seen.
    fn verdicts(&self) -> BTreeMap<u16, Verdict> {
        let truth = mosd::truth_of(&export::mosd_labels(&self.world, &self.rendered, false)).unwrap();
        let scored = score(&self.found.labels, &truth).unwrap();
        let verdict = |instance: u16| {
            let label = truth.object_at(*self.pixels(instance).first()?)?;
            let own = scored.objects.iter().find(|object| object.truth_label == label)?;
            Some((instance, own.verdict))
        };
        self.world.objects().filter_map(verdict).collect()
    }

    /// Groups of objects that touch each other.
    fn groups(&self) -> Vec<Vec<u16>> {
        let mut groups: Vec<Vec<u16>> = self.world.objects().map(|object| vec![object]).collect();
        for contact in self.world.contacts() {
            let find = |of: u16| groups.iter().position(|group| group.contains(&of));
            if let (Some(a), Some(b)) = (find(contact.upper), find(contact.lower))
                && a != b
            {
                let joined = groups.swap_remove(a.max(b));
                groups[a.min(b)].extend(joined);
            }
        }
        groups
    }

    /// Whether no box of a group is cut but along its joints.
    fn is_cut_at_joints(&self, group: &[u16]) -> bool {
        group.iter().all(|&object| {
            let truth = &self.rendered.truth.instance;
            let is_other = |i: usize| truth[i] != object && group.contains(&truth[i]);
            let inner =
                self.pixels(object).into_iter().filter(|&i| !around(i, truth.size(), JOINT_PX).any(is_other));
            let mut labels = BTreeMap::<u16, usize>::new();
            inner.for_each(|i| *labels.entry(self.found.labels[i]).or_default() += 1);
            let all: usize = labels.values().sum();
            let most = labels.iter().filter(|(label, _)| **label > 0).map(|(_, pixels)| *pixels).max();
            most.unwrap_or(0) as f64 >= ONE_LABEL * all as f64
        })
    }

    /// Whether an object has another colour than what is around it.
    fn is_contrasting(&self, object: u16) -> bool {
        let truth = &self.rendered.truth.instance;
        let color = self.rendered.frame.color().unwrap();
        let own = self.pixels(object);
        let mut beside = vec![false; truth.len()];
        for &i in &own {
            around(i, truth.size(), AROUND_PX).for_each(|k| beside[k] |= truth[k] != object);
        }
        let mean = |pixels: &mut dyn Iterator<Item = usize>| {
            let (sum, count) = pixels.fold((Vec3::ZERO, 0.0), |(sum, count), i| {
                (sum + Vec3::from(color[i].map(f32::from)), count + 1.0)
            });
            sum / f32::max(count, 1.0)
        };
        let around = mean(&mut (0..beside.len()).filter(|&i| beside[i]));
        mean(&mut own.into_iter()).distance(around) >= CONTRAST
    }

    /// The flat things that were found where less than half is an object.
    fn false_flats(&self) -> usize {
        let objects: Vec<u16> = self.world.objects().collect();
        let truth = self.rendered.truth.instance.as_slice();
        let is_false = |id: u16| {
            let own = (0..truth.len()).filter(|&i| self.found.labels[i] == id);
            let (on, all) =
                own.fold((0, 0), |(on, all), i| (on + usize::from(objects.contains(&truth[i])), all + 1));
            2 * on < all
        };
        self.found.objects.iter().filter(|object| object.is_flat && is_false(object.id.0)).count()
    }
}

/// The pixels at most so many columns and rows from a pixel.
fn around(i: usize, (width, height): (usize, usize), reach: usize) -> impl Iterator<Item = usize> {
    let (u, v) = (i % width, i / width);
    let columns = u.saturating_sub(reach)..(u + reach + 1).min(width);
    (v.saturating_sub(reach)..(v + reach + 1).min(height))
        .flat_map(move |v| columns.clone().map(move |u| v * width + u))
}

fn scenes() -> u64 {
    std::env::var("OBJECTHOOD_MANY").map_or(4, |text| text.parse().unwrap())
}

/// What was counted in scenes of a family.
fn counted<T: Send>(family: Family, count: impl Fn(&Seen) -> T + Sync) -> Vec<T> {
    (FIRST_SEED..FIRST_SEED + scenes()).into_par_iter().map(|seed| count(&Seen::of(family, seed))).collect()
}

/// Boxes that look alike and stand flush cannot be told apart. None may be cut but at its joints.
#[test]
fn boxes_that_look_alike_are_one_thing_or_cut_at_their_joints() {
    let mut groups = Share::default();
    for rights in counted(Family::FlushAlike, |seen| {
        let groups = seen.groups().into_iter();
        groups.map(|group| seen.is_cut_at_joints(&group)).collect::<Vec<bool>>()
    }) {
        rights.into_iter().for_each(|is_right| groups.count(is_right));
    }
    println!(
        "flush-alike: {} of {} groups have one label, or are cut at their joints ({:.3})",
        groups.0,
        groups.1,
        groups.of()
    );
    assert!(groups.of() >= 0.8, "{groups:?}");
}

#[test]
fn print_does_not_split_boxes() {
    let mut whole = Share::default();
    for verdicts in counted(Family::Printed, Seen::verdicts) {
        verdicts.values().for_each(|verdict| whole.count(*verdict != Verdict::Over));
    }
    println!("printed: {} of {} boxes are not split ({:.3})", whole.0, whole.1, whole.of());
    assert!(whole.of() >= 0.8, "{whole:?}");
}

#[test]
fn thin_things_are_found_by_thickness_and_colour() {
    let (mut thick, mut thin) = ([Share::default(); 2], [Share::default(); 2]);
    for things in counted(Family::Thin, |seen| {
        let verdicts = seen.verdicts().into_iter();
        let thing = |(object, verdict)| {
            let [low, high] = seen.world.solid(object).unwrap().bounds_m();
            (high[2] - low[2], seen.is_contrasting(object), verdict == Verdict::Correct)
        };
        verdicts.map(thing).collect::<Vec<(f64, bool, bool)>>()
    }) {
        for (height_m, is_contrasting, is_right) in things {
            let shares = if height_m >= THICK_M { &mut thick } else { &mut thin };
            shares[usize::from(is_contrasting)].count(is_right);
        }
    }
    for (name, [alike, other]) in [("2 mm and more", thick), ("less than 2 mm", thin)] {
        println!(
            "thin, {name}: of another colour {} of {} ({:.3}), of the colour of what is around {} of {}",
            other.0,
            other.1,
            other.of(),
            alike.0,
            alike.1
        );
    }
    assert!(thick[1].of() >= 0.7 && thin[1].of() >= 0.4, "{thick:?} {thin:?}");
}

#[test]
fn nothing_flat_is_found_on_patterns_and_shadows() {
    let counts = counted(Family::Patterned, Seen::false_flats);
    let (flats, images) = (counts.iter().sum::<usize>(), counts.len());
    println!(
        "patterned: {flats} false flat things in {images} images ({:.2} an image)",
        flats as f64 / images as f64
    );
    assert!(4 * flats <= images, "{flats} in {images} images");
}
