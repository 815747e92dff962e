//! Segments that show a piece of a known thing (ours).

use std::collections::BTreeMap;

use crate::associate::Overlap;
use crate::memory::Memory;
use crate::rested::Beside;
use crate::scene::Key;
use crate::segment::Segment;
use crate::track::RESTING_CHANGE;
use crate::view::View;

/// A segment shows a thing as it rested if at least this share of its pixels lies on the surface that the
/// thing then had.
const AS_IT_RESTED: f64 = 0.6;

impl Memory {
    /// The resting track of which a segment without a track is a fragment. Most pixels of the segment belong
    /// to the track, and the track also shows itself elsewhere. Besides, either an agent stands before it, or
    /// no agent is near, nothing has changed, and most frames showed it as one.
    pub(crate) fn fragment_of(
        &self,
        k: usize,
        segment: &Segment,
        overlap: &Overlap,
        tracks_of: &[Option<Key>],
    ) -> Option<Key> {
        const MOST_OF_IT: f64 = 0.6;
        let parts = overlap.common.range((k, 0)..=(k, Key::MAX));
        let (&(_, key), &common) =
            parts.max_by_key(|&(&(_, key), &common)| (common, std::cmp::Reverse(key)))?;
        let track = self.tracks.get(&key)?;
        let is_part = common as f64 > MOST_OF_IT * segment.px as f64 && segment.changed < 0.5;
        let is_seen = tracks_of.contains(&Some(key));
        let is_behind_agent = track.rest.is_some() && track.rests() && track.last.reached_by.is_some();
        let is_as_before = track.is_left_alone() && segment.changed < RESTING_CHANGE && track.oneness.holds();
        (is_part && is_seen && (is_behind_agent || is_as_before)).then_some(key)
    }

    /// Finds, among the `open` segments, those that show the surface of a thing as it last rested, and
    /// returns the thing for each. An arm that passes leaves pieces visible that are too small to be
    /// recognised by their looks. Nobody has lifted the thing. Either the thing does not move and no segment
    /// shows it; or the segment that shows it lies on the same surface, so neither has moved, and an arm
    /// reaches the thing or most frames showed it as one. Otherwise there may be two things, like a box and
    /// its lid. `pixels`: the sampled pixels of each segment. O(pixels of the open segments and of those that
    /// show their things).
    pub(crate) fn as_they_rested(
        &self,
        open: &[usize],
        pixels: &[Vec<usize>],
        view: &View,
        tracks_of: &[Option<Key>],
    ) -> BTreeMap<usize, Key> {
        let mut resting = BTreeMap::new();
        for &k in open {
            let Some(key) = self.rested_surface(&pixels[k], view) else { continue };
            let Some(track) = self.tracks.get(&key).filter(|track| track.rest.is_some()) else { continue };
            if track.part_of.is_some() || track.is_agent_part() || self.happenings.is_lifted(key) {
                continue;
            }
            let shown = tracks_of.iter().position(|&known| known == Some(key));
            let is_whole = match shown {
                None => !track.is_moving,
                Some(shown) => {
                    (track.last.reached_by.is_some() || track.oneness.holds())
                        && self.rested_surface(&pixels[shown], view) == Some(key)
                }
            };
            if is_whole {
                resting.insert(k, key);
            }
        }
        resting
    }

    /// The thing on whose surface, as it last rested, most of a segment's pixels lie. O(pixels).
    pub(crate) fn rested_surface(&self, pixels: &[usize], view: &View) -> Option<Key> {
        let mut there: BTreeMap<Key, usize> = BTreeMap::new();
        for &pixel in pixels {
            if let Some((key, Beside::There)) = self.rested.at(pixel, view) {
                *there.entry(key).or_default() += 1;
            }
        }
        let most = there.into_iter().max_by_key(|&(key, px)| (px, std::cmp::Reverse(key)));
        most.filter(|&(_, px)| px as f64 >= AS_IT_RESTED * pixels.len() as f64).map(|(key, _)| key)
    }
}
