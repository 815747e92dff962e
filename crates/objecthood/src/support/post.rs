//! Posts: upright things much longer than wide, such as the legs of tables and chairs, and whether they go on
//! out of sight (docs/CONTEXT.md 6.7.4).

use glam::{DVec3, Quat};

use crate::oriented_box::fit_oriented_box;
use crate::support::column::{LEAST_AIR_M, Place, STEP_M, places, steps_in};
use crate::support::load::level_plane;
use crate::support::scene::SupportScene;

/// A post is at least this many times as long as wide. Whole bottles reach four times.
const SLIM: f32 = 4.0;
/// The visible part of a post is at least this long (m), longer than a pen.
const LONG_M: f32 = 0.15;
/// Less is seen of a post that something hides at both ends: at least this length (m), and this many times as
/// long as wide.
const GLIMPSE_M: f32 = 0.1;
const SLIM_BETWEEN: f32 = 2.5;
/// A post that leaves the image is at least this many times as long as wide: only a part of it is seen.
const SLIM_OUTSIDE: f32 = 6.0;
/// Its long side makes an angle with up whose cosine is at least this (26 degrees): legs may be splayed.
const UPRIGHT: f64 = 0.9;
/// The line of sight to a post has at least this level share: from straight above, its length lies along the noise of depth.
const LEAST_AHEAD: f64 = 0.2;
/// A column is followed up for at most this length (m), the height of a table.
const HIGHEST_M: f64 = 0.8;

/// An upright thing at least [`SLIM_BETWEEN`] times as long as wide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Post {
    /// The length of its visible part, over its width.
    slimness: f32,
    /// Whether it is long and slim enough for a post even if one of its ends is seen.
    pub(super) is_slim: bool,
}

impl Post {
    /// The post that these points show; `None` if they show none. Length and width are measured in the
    /// upright plane across the line of sight, because depth is noisy along it. O(points).
    pub(super) fn of(points_m: &[[f32; 3]], up: DVec3) -> Option<Self> {
        let sum: DVec3 = points_m.iter().map(|&point| DVec3::from(point.map(f64::from))).sum();
        let ahead = sum - up * sum.dot(up);
        if ahead.length() < LEAST_AHEAD * sum.length() {
            return None;
        }
        // Its "up" is the level direction to the thing, so x and y lie in that plane.
        let seen = fit_oriented_box(points_m, ahead.normalize().as_vec3().to_array());
        let [long_m, wide_m, _] = seen.extents_m;
        let along = Quat::from_array(seen.rotation_xyzw).as_dquat() * DVec3::X;
        let is_slim = |least_m: f32, slim: f32| long_m >= least_m.max(slim * wide_m);
        let is_post = is_slim(GLIMPSE_M, SLIM_BETWEEN) && along.dot(up).abs() >= UPRIGHT;
        is_post.then_some(Self { slimness: long_m / wide_m, is_slim: is_slim(LONG_M, SLIM) })
    }

    /// Whether the post goes on, out of sight, above its pixel `i`. It does in three cases:
    ///
    /// - A region, the first that does so, hides 4 cm of the column above, and the column then meets this
    ///   region.
    /// - This region is a level surface of the structure, and the column passes its height without 4 cm of
    ///   air, for example where something stands on it.
    /// - The column leaves the image through the post, or behind something, and the post is at least
    ///   [`SLIM_OUTSIDE`] times as long as wide.
    ///
    /// Places without depth count as air.
    ///
    /// O(steps). Source: ours, because a thing as slim as a leg seldom stands by itself, and a thing that
    /// hides only its upper end overhangs it.
    pub(super) fn goes_on(self, scene: &SupportScene<'_>, up: DVec3, i: usize, thing: usize) -> bool {
        let point = scene.point_at(i);
        let (mut steps, mut air_m, mut ends_in_sight) = (0, 0.0, false);
        // What hides the column, and how much of it (m).
        let (mut before, mut hidden_m) = (None, 0.0);
        for Place { region, farther_m, behind_m } in places(scene, i, up, HIGHEST_M) {
            steps += 1;
            let region = region.map(|region| region.index());
            ends_in_sight = false;
            if region == Some(thing) {
                continue;
            }
            let is_hidden = farther_m < -behind_m;
            if farther_m.is_nan() || farther_m > behind_m {
                (air_m, ends_in_sight) = (air_m + STEP_M, true);
                if air_m >= LEAST_AIR_M {
                    return false;
                }
                continue;
            }
            if is_hidden && region.is_some() && hidden_m < LEAST_AIR_M {
                hidden_m = if region == before { hidden_m + STEP_M } else { STEP_M };
                before = region;
            }
            let Some(over) = before.filter(|_| hidden_m >= LEAST_AIR_M) else { continue };
            let is_crossed = level_plane(scene, up, over).is_some_and(|plane| {
                plane.height_m(point) < -LEAST_AIR_M
                    && plane.height_m(point + up * (steps as f64 * STEP_M)) > 0.0
            });
            if is_crossed || !is_hidden && region == before {
                return true;
            }
        }
        self.slimness >= SLIM_OUTSIDE && !ends_in_sight && steps < steps_in(HIGHEST_M)
    }
}

/// Whether the first other thing in a direction from pixel `i` of a thing is nearer, and so hides it; `None`
/// where the image ends. Holes are skipped. O(steps).
pub(super) fn is_hidden_beyond(scene: &SupportScene<'_>, way: DVec3, i: usize, thing: usize) -> Option<bool> {
    let is_other = |place: &Place| {
        place.region.is_none_or(|region| region.index() != thing) && !place.farther_m.is_nan()
    };
    let place = places(scene, i, way, HIGHEST_M).find(is_other)?;
    Some(place.farther_m < -place.behind_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::testing::{pixels_of, table_scene};

    /// What is seen of these things of the scene as posts, and the share of the pixels of each above which it goes on, in an image that begins at this
    /// column and row.
    fn posts(first: [usize; 2], things: &[usize]) -> Vec<Option<f64>> {
        table_scene(0.0, first, true, |scene, up| {
            let share = |&thing: &usize| {
                let pixels: Vec<usize> = pixels_of(scene, thing).collect();
                let points_m: Vec<[f32; 3]> = pixels.iter().map(|&i| scene.points_m[i]).collect();
                let post = Post::of(&points_m, up)?;
                let on = pixels.iter().filter(|&&i| post.goes_on(scene, up, i, thing)).count();
                Some(on as f64 / pixels.len() as f64)
            };
            things.iter().map(share).collect()
        })
    }

    /// The back legs of tables and chairs were objects: their upper end is hidden, less than 40 cm above the rest.
    #[test]
    fn a_leg_behind_a_table_goes_on() {
        let [back, stands_on, free] = posts([0, 0], &[3, 4, 5])[..] else { unreachable!() };
        assert!(back > Some(0.9), "behind the table, and what stands on it hides where they meet: {back:?}");
        assert_eq!(
            [stands_on, free],
            [None, Some(0.0)],
            "a box on the table; a post of which the end is seen"
        );
    }

    #[test]
    fn what_leaves_the_image_goes_on_if_it_is_slimmer_than_a_bottle() {
        // A front leg, 5 cm wide, that ends below the image too.
        let of = |first_row| posts([0, first_row], &[6])[0];
        assert!(of(160) > Some(0.9), "51 cm of it are seen: {:?}", of(160));
        assert_eq!(of(210), Some(0.0), "19 cm");
    }

    #[test]
    fn what_hides_the_next_place_above_or_below_is_seen() {
        table_scene(0.0, [0, 0], true, |scene, up| {
            let shares = |thing: usize| {
                let pixels: Vec<usize> = pixels_of(scene, thing).collect();
                [up, -up].map(|way| {
                    let hidden = |&&i: &&usize| is_hidden_beyond(scene, way, i, thing) == Some(true);
                    pixels.iter().filter(hidden).count() as f64 / pixels.len() as f64
                })
            };
            // The leg behind the table stands on the floor, the free post ends in sight.
            let [leg, free] = [shares(3), shares(5)];
            assert!(leg[0] > 0.75 && leg[1] == 0.0, "{leg:?}");
            assert_eq!(free, [0.0, 0.0]);
        });
    }

    #[test]
    fn a_rod_that_lies_is_no_post() {
        let rod = |k: usize| [0.004 * k as f32, 0.5, 1.5];
        let lying: Vec<[f32; 3]> = (0..100).map(rod).collect();
        let upright: Vec<[f32; 3]> = lying.iter().map(|&[x, y, z]| [y, x, z]).collect();
        assert!(Post::of(&lying, DVec3::NEG_Y).is_none() && Post::of(&upright, DVec3::NEG_Y).is_some());
        let is_slim = |by: f32| {
            let shorter: Vec<[f32; 3]> = upright.iter().map(|point| point.map(|x| x / by)).collect();
            Post::of(&shorter, DVec3::NEG_Y).map(|post| post.is_slim)
        };
        assert_eq!(
            [is_slim(2.0), is_slim(3.0), is_slim(5.0)],
            [Some(true), Some(false), None],
            "20, 13 and 8 cm"
        );
    }
}
