//! Segments that show a piece of a known thing (ours).

use std::collections::BTreeMap;

use crate::associate::Overlap;
use crate::memory::Memory;
use crate::rested::Beside;
use crate::scene::Key;
use crate::segment::Segment;
use crate::track::{RESTING_CHANGE, Track};
use crate::view::View;

/// A segment shows a thing as it rested when this share of its pixels or more lies on the surface of that.
const AS_IT_RESTED: f64 = 0.6;

impl Memory {
    /// The resting track of which a segment without a track of its own is a fragment: most of its pixels belong to it, and it shows itself
    /// elsewhere too. Either an agent stands before it; or no agent is near, nothing has changed, and most frames showed it as one.
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

    /// Of the `open` segments, those that show the surface of a thing as it last rested, and the thing: an arm that passes leaves pieces to be seen, too
    /// small to be known by their looks. Nobody has lifted the thing, it does not move, and no segment shows it: else it may be two, as a box and
    /// its lid are. `pixels`: of each segment, those that are looked at. O(pixels of the open segments).
    pub(crate) fn as_they_rested(
        &self,
        open: &[usize],
        pixels: &[Vec<usize>],
        view: &View,
        tracks_of: &[Option<Key>],
    ) -> BTreeMap<usize, Key> {
        let mut resting = BTreeMap::new();
        let rests = |key: Key| {
            let is_free = |track: &Track| {
                track.rest.is_some() && track.part_of.is_none() && !track.is_agent_part() && !track.is_moving
            };
            let is_hidden = !tracks_of.contains(&Some(key)) && !self.happenings.is_lifted(key);
            is_hidden && self.tracks.get(&key).is_some_and(is_free)
        };
        for &k in open {
            let mut there: BTreeMap<Key, usize> = BTreeMap::new();
            for &pixel in &pixels[k] {
                if let Some((key, Beside::There)) = self.rested.at(pixel, view) {
                    *there.entry(key).or_default() += 1;
                }
            }
            let most = there.into_iter().max_by_key(|&(key, px)| (px, std::cmp::Reverse(key)));
            let is_it =
                |&(key, px): &(Key, usize)| px as f64 >= AS_IT_RESTED * pixels[k].len() as f64 && rests(key);
            resting.extend(most.filter(is_it).map(|(key, _)| (k, key)));
        }
        resting
    }
}
