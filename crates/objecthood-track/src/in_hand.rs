//! Things that a hand has and no segment shows: their colours are found in the agents' region (ours).
//!
//! Of a small thing in a hand a frame shows corners between fingers, which are no convex shapes with a support.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::bits::Bits;
use crate::face::{BESIDE_IT, OTHER_FACE};
use crate::hand::HandColors;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::segment::is_looked_at;
use crate::track::Track;
use crate::view::View;

/// Least size of a part that is seen (px at VGA size).
const LEAST_PX: f64 = 100.0;
/// The least share of a thing's area that is seen: less may be a button.
const LEAST_SHARE: f64 = 0.1;
/// Parts up to this width are edges, where colours mix (px at VGA size). Images of less than VGA size have none: things in them are as narrow.
const NARROW_PX: f64 = 2.0;

impl Memory {
    /// Looks in the region of all agents for the things that agents handle and no segment shows. O(n) if there are any. Does nothing without colour.
    pub(crate) fn find_in_hands(
        &mut self,
        look: &Look<'_>,
        hand: &HandColors<'_>,
        pieces: &mut BTreeMap<Key, Vec<usize>>,
    ) {
        let is_lost = |key: Key, track: &Track| {
            self.happenings.is_handled(key)
                && track.is_known()
                && track.part_of.is_none()
                && !look.keys.contains(&key)
                && !pieces.contains_key(&key)
        };
        let lost: Vec<Key> =
            self.tracks.iter().filter(|&(&key, track)| is_lost(key, track)).map(|(&key, _)| key).collect();
        if lost.is_empty() {
            hand.teach(&mut self.agents.look);
        }
        for key in lost {
            for pixel in self.seen_in_hand(&self.tracks[&key], look.view, hand) {
                self.scene.seen[pixel] = key;
                if is_looked_at(pixel, look.view.size.0) {
                    pieces.entry(key).or_default().push(pixel);
                }
            }
        }
    }

    /// The pixels that show a thing in a hand: the largest part that has colours of it and not of the hand, and what is beside that. None if they are
    /// more than the thing can show.
    fn seen_in_hand(&self, track: &Track, view: &View, hand: &HandColors<'_>) -> Vec<usize> {
        let is_free = |key: Key| key == 0 || self.tracks.get(&key).is_some_and(Track::is_agent_part);
        let narrow = view.length_px(NARROW_PX) / 2;
        let of_it = Bits::of(view.size, |pixel| {
            is_free(self.scene.seen[pixel]) && hand.holds(pixel, track, &self.agents.look)
        });
        let mut parts = of_it.eroded(narrow).dilated(narrow).components();
        parts.sort_by_key(|part| std::cmp::Reverse(part.len()));
        let middle = |part: &[usize]| {
            let points: Vec<DVec3> = part.iter().filter_map(|&pixel| view.point(pixel)).collect();
            points.iter().sum::<DVec3>() / points.len().max(1) as f64
        };
        let Some(largest) = parts.first().filter(|part| part.len() >= view.px(LEAST_PX)) else {
            return Vec::new();
        };
        let at = middle(largest);
        let is_beside = |part: &&Vec<usize>| middle(part).distance(at) < BESIDE_IT * track.area_m2.sqrt();
        let pixels: Vec<usize> = parts.iter().filter(is_beside).flatten().copied().collect();
        let area_m2 = pixels.len() as f64 * at.z * at.z / (view.camera.fx_px * view.camera.fy_px);
        let fits = (LEAST_SHARE..OTHER_FACE).contains(&(area_m2 / track.area_m2));
        if fits { pixels } else { Vec::new() }
    }
}
