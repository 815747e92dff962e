//! Finds things in a hand that no segment shows, by their colours in the agents' region (ours).
//!
//! Of a small thing in a hand, a frame shows only corners between fingers, which are no convex shapes with a
//! support.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::bits::Bits;
use crate::face::{BESIDE_IT, OTHER_FACE};
use crate::hand::HandColors;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::seen::is_piece;
use crate::segment::is_looked_at;
use crate::track::Track;
use crate::view::View;

/// Least size of the largest part that is seen (px at VGA size).
const LEAST_PX: f64 = 100.0;
/// Least share of a thing's area that is seen: less may be a button.
const LEAST_SHARE: f64 = 0.1;
/// Parts up to this width are edges, where colours mix (px at VGA size). In images of less than VGA size this
/// is not applied: things in them are as narrow.
const NARROW_PX: f64 = 2.0;

impl Memory {
    /// Searches for the things that agents handle and no segment shows, each in the pixels of its agent. O(n)
    /// if there are any. Does nothing without colour.
    pub(crate) fn find_in_hands(
        &mut self,
        look: &Look<'_>,
        hand: &HandColors<'_>,
        pieces: &mut BTreeMap<Key, Vec<usize>>,
    ) {
        let is_shown =
            |key: Key| look.keys.contains(&key) || pieces.get(&key).is_some_and(|piece| is_piece(piece));
        let is_lost = |&(key, _): &(Key, u32)| {
            let track = self.tracks.get(&key).filter(|track| track.is_known() && track.part_of.is_none());
            track.is_some() && !is_shown(key)
        };
        let lost: Vec<(Key, u32)> = self.happenings.handled().filter(is_lost).collect();
        if lost.is_empty() {
            hand.teach(&mut self.agents.look);
        }
        for (key, number) in lost {
            let pixels = self.seen_in_hand(&self.tracks[&key], number, look.view, hand);
            self.show(key, &pixels, pieces);
        }
    }

    /// The pixels that show a thing in the hand of an agent: the largest part that has colours of the thing
    /// and not of the hand, and what is beside this part. None if they are more than the thing can show, or
    /// too few for a piece.
    fn seen_in_hand(&self, track: &Track, number: u32, view: &View, hand: &HandColors<'_>) -> Vec<usize> {
        let Some(agent) = self.agents.sure().find(|agent| agent.number == number) else { return Vec::new() };
        let edge = view.length_px(NARROW_PX) / 2;
        let of_it = Bits::of(view.size, |pixel| {
            agent.mask.has(pixel) && self.is_free(pixel) && hand.is_of_thing(pixel, track, &self.agents.look)
        });
        let mut parts = of_it.eroded(edge).dilated(edge).components();
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
        let looked_at: Vec<usize> =
            pixels.iter().copied().filter(|&pixel| is_looked_at(pixel, view.size.0)).collect();
        if fits && is_piece(&looked_at) { pixels } else { Vec::new() }
    }
}
