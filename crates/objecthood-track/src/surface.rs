//! The surface of a known thing while it is moved: points that stay until something is seen through them
//! (ours).
//!
//! A frame shows less and less of a thing in a hand. Without this memory, what one frame missed would never
//! be expected again.

use std::collections::{BTreeMap, VecDeque};

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use crate::hand::HandColors;
use crate::memory::Memory;
use crate::rigid::Rigid;
use crate::scene::{Key, Scene, THERE_M};
use crate::segment::is_looked_at;
use crate::track::Track;
use crate::view::{View, block};

/// Older points beyond this number are forgotten: a thing as large as an image of VGA size has as many.
const MOST_POINTS: usize = 80_000;
/// A point is there if the image shows a surface this close to it, in standard deviations of depth (by noise
/// it is rarely farther off),
const NOISES: f64 = 4.0;
/// or this close (m), because motions are found to a few millimetres; but at most [`THERE_M`].
const NEAREST_M: f32 = 0.006;
/// A thing is predicted where its surface is if at least this share of its points is there: about half of a
/// thing turns away from the camera, or is in the hand.
const EXPECTED_SHARE: f64 = 0.3;

/// Points (m) in the camera of the last frame; the newest last.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Surface {
    points: VecDeque<Vec3>,
}

/// What the image shows where a point should be.
#[derive(Clone, Copy)]
enum Shown {
    /// A surface at the place of the point, at this pixel.
    There(usize),
    /// Something nearer, nothing that could be measured, or something not far enough behind to decide.
    Unclear,
    /// Something farther.
    Through,
}

impl Surface {
    /// Moves the surface. O(points).
    pub(crate) fn carry(&mut self, motion: &Rigid) {
        for point in &mut self.points {
            *point = motion.point(point.as_dvec3()).as_vec3();
        }
    }

    /// The pixels at which the image shows a surface where a point should be.
    fn there(&self, view: &View) -> impl Iterator<Item = usize> {
        self.points.iter().filter_map(|point| match shown(point.as_dvec3(), view) {
            Shown::There(pixel) => Some(pixel),
            _ => None,
        })
    }

    /// Adds what is seen of the thing. Points known before stay if the image hides them, or if it shows them
    /// at a pixel for which `stays` holds. O(points).
    fn learn(&mut self, seen: &[DVec3], view: &View, stays: impl Fn(usize) -> bool) {
        self.points.retain(|point| match shown(point.as_dvec3(), view) {
            Shown::There(pixel) => stays(pixel),
            Shown::Unclear => true,
            Shown::Through => false,
        });
        let fresh = seen.iter().step_by(seen.len().div_ceil(MOST_POINTS).max(1));
        let old = self.points.len().min((self.points.len() + fresh.len()).saturating_sub(MOST_POINTS));
        self.points.drain(..old);
        self.points.extend(fresh.map(|point| point.as_vec3()));
    }
}

fn shown(point: DVec3, view: &View) -> Shown {
    let Some(pixel) = view.pixel_of(point) else { return Shown::Unclear };
    let inverse = view.inverse[pixel];
    let farther_m = if inverse > 0.0 { 1.0 / inverse - point.z as f32 } else { f32::NEG_INFINITY };
    let there_m = ((NOISES * view.sigma_m(point.z)) as f32).clamp(NEAREST_M, THERE_M);
    match farther_m {
        farther_m if farther_m >= THERE_M => Shown::Through,
        farther_m if farther_m.abs() < there_m => Shown::There(pixel),
        _ => Shown::Unclear,
    }
}

/// Known things that do not rest are also predicted where their surfaces are, unless another thing is there,
/// or what rested there before. If a thing went another way while hidden, few of its points seem to be there,
/// and it is not predicted. O(points).
pub(crate) fn expect(predicted: &mut [Key], scene: &Scene, view: &View, tracks: &BTreeMap<Key, Track>) {
    let is_thing = |key: Key| tracks.get(&key).is_some_and(|track| !track.is_agent_part());
    let does_not_rest = |track: &Track| {
        track.is_known() && !track.is_open() && track.part_of.is_none() && track.rest_s == 0.0
    };
    for (&key, track) in tracks.iter().filter(|(_, track)| does_not_rest(track)) {
        let may_show = |predicted: &[Key], pixel: usize| {
            (predicted[pixel] == key || !is_thing(predicted[pixel])) && !scene.is_in_place(view, pixel)
        };
        let there: Vec<usize> =
            track.surface.there(view).filter(|&pixel| may_show(predicted, pixel)).collect();
        if (there.len() as f64) < EXPECTED_SHARE * track.surface.points.len() as f64 {
            continue;
        }
        for pixel in there {
            for to in block((pixel % view.size.0, pixel / view.size.0), view.size) {
                let is_there = (1.0 / view.inverse[to] - 1.0 / view.inverse[pixel]).abs() < THERE_M;
                if is_there && may_show(predicted, to) {
                    predicted[to] = key;
                }
            }
        }
    }
}

impl Memory {
    /// Every known thing adds what is seen of it, and loses points that are seen through. It does not add
    /// pixels that may be the hand's by their colour: a finger that was added would move along with the thing
    /// for as long as it is held. O(n + points).
    pub(crate) fn learn_surfaces(&mut self, view: &View, hand: &HandColors<'_>) {
        let mut seen: BTreeMap<Key, Vec<DVec3>> = BTreeMap::new();
        for (pixel, &key) in self.scene.seen.iter().enumerate().filter(|&(_, &key)| key > 0) {
            if is_looked_at(pixel, view.size.0)
                && let Some(track) = self.tracks.get(&key).filter(|track| track.is_known())
                && !hand.is_of_hand(pixel, track, false)
                && let Some(point) = view.point(pixel)
            {
                seen.entry(key).or_default().push(point);
            }
        }
        let scene = &self.scene;
        let is_free = |pixel: usize| scene.seen[pixel] == 0 && !scene.is_in_place(view, pixel);
        for (key, track) in &mut self.tracks {
            track.surface.learn(seen.get(key).map_or(&[], Vec::as_slice), view, is_free);
        }
    }
}

#[cfg(test)]
mod tests {
    use objecthood::{Camera, Frame, Raster};

    use super::*;

    const SIZE: (usize, usize) = (40, 30);

    /// A wall 1 m away; the columns `other` show something at another distance (m).
    fn view(other: std::ops::Range<usize>, other_m: f32) -> View {
        let depth_m = (0..SIZE.0 * SIZE.1).map(|i| if other.contains(&(i % SIZE.0)) { other_m } else { 1.0 });
        let depth_m = Raster::from_vec(SIZE.0, SIZE.1, depth_m.collect()).unwrap();
        View::of(&Frame::new(depth_m, None, Camera::new(30.0, 30.0, 19.5, 14.5).unwrap()).unwrap(), 1.0)
    }

    /// A surface that fills the columns 10 to 29 and the rows 5 to 24.
    fn surface() -> Surface {
        let view = view(0..0, 1.0);
        let pixels = (0..SIZE.0 * SIZE.1)
            .filter(|pixel| (10..30).contains(&(pixel % SIZE.0)) && (5..25).contains(&(pixel / SIZE.0)));
        let mut surface = Surface::default();
        surface.learn(&pixels.map(|pixel| view.point(pixel).unwrap()).collect::<Vec<_>>(), &view, |_| true);
        surface
    }

    #[test]
    fn what_is_hidden_stays_and_what_is_seen_through_goes() {
        let (mut surface, all) = (surface(), 20 * 20);
        assert_eq!((surface.points.len(), surface.there(&view(0..0, 1.0)).count()), (all, all));
        // A hand before half of it.
        let hand = view(20..40, 0.8);
        surface.learn(&[], &hand, |_| true);
        assert_eq!((surface.points.len(), surface.there(&hand).count()), (all, all / 2));
        // A wall far behind where half of it should be.
        let wall = view(20..40, 2.0);
        surface.learn(&[], &wall, |_| true);
        assert_eq!((surface.points.len(), surface.there(&wall).count()), (all / 2, all / 2));
        // What the image shows there is another thing's.
        surface.learn(&[], &wall, |_| false);
        assert_eq!(surface.points.len(), 0);
    }

    #[test]
    fn a_surface_goes_with_its_thing() {
        let mut surface = surface();
        surface.carry(&Rigid::step(DVec3::ZERO, DVec3::new(0.0, 0.0, -0.2), DVec3::ZERO));
        let shown = view(0..0, 1.0);
        assert_eq!(surface.there(&shown).count(), 0, "0.2 m before the wall");
        surface.learn(&[], &shown, |_| true);
        assert_eq!(surface.points.len(), 0, "seen through");
    }
}
