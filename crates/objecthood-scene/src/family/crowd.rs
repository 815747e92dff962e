//! A table with as many things as one likes: how the time of a frame grows with what is in it.

use super::setting::{self, TABLE_M};
use super::views::{kinect_at, lighting};
use crate::place::Region;
use crate::pose::Pose;
use crate::random::Rng;
use crate::thing;
use crate::world::World;

/// The part of the table that the camera sees whole.
const SEEN: Region = Region { center_m: [0.0, 0.0], half_m: [0.42, 0.30] };
/// Where the camera is and what it looks at (m): high enough that things hide little of each other.
const EYE_M: [f64; 3] = [0.0, -0.62, TABLE_M + 0.82];
const TARGET_M: [f64; 3] = [0.0, 0.0, TABLE_M];
/// Places tried for a thing before another is tried in its stead, and that often for each thing wanted.
const TRIES_A_THING: usize = 20;

/// A table with `objects` small boxes and balls that stand apart; with fewer when there is no room left: 80 fit.
///
/// The camera is always at the same place, so that scenes differ in what stands on the table alone. The same seed
/// gives the same scene on every machine.
pub fn crowd(objects: usize, seed: u64) -> World {
    let mut rng = Rng::new(seed, 1_000_000);
    let lighting = lighting(&mut rng);
    let mut layout = setting::with_table(&mut rng, false);
    for _ in 0..objects * TRIES_A_THING {
        if layout.placed().len() == objects {
            break;
        }
        let thing = if rng.chance(0.6) {
            thing::brick(&mut rng)
        } else {
            let radius_m = rng.range(0.018..0.03);
            thing::ball(&mut rng, radius_m)
        };
        layout.stand(&mut rng, &thing, SEEN);
    }
    let viewpoint = kinect_at(Pose::looking_at(EYE_M, TARGET_M));
    World::new(seed, layout.solids, layout.contacts, lighting, viewpoint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::View;

    #[test]
    fn all_are_there_and_seen() {
        for objects in [0, 1, 5, 20, 80] {
            for seed in 0..4 {
                let world = crowd(objects, seed);
                assert_eq!(world.objects().count(), objects, "seed {seed}");
                let visible = View::of(&world.at_quarter_size()).visible_fractions();
                let seen = world.objects().filter(|&k| visible[usize::from(k) - 1] > 0.3).count();
                assert!(seen * 20 >= objects * 19, "seed {seed}: {seen} of {objects} are seen");
            }
        }
    }
}
