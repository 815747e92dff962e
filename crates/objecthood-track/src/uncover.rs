//! Things that come out from behind a hand beside a known thing, so that a frame takes both for one.

use std::collections::BTreeMap;

use crate::associate::{HOLDS, Overlap, found_again};
use crate::memory::Memory;
use crate::scene::Key;
use crate::segment::{Measure, Segment, is_looked_at};

/// The part that belongs to no track is at least this share of the segment.
const LEAST_SHARE: f64 = 0.3;

impl Memory {
    /// Divides a segment that shows a known thing and a part that no track should show, if the part fits a
    /// known thing that is hidden, and is not where the first thing rested. The part gets a segment of its
    /// own. O(n).
    pub(crate) fn part_uncovered(
        &self,
        labels: &mut [u16],
        segments: &mut Vec<Segment>,
        overlap: &Overlap,
        predicted: &[Key],
        measure: &Measure<'_>,
    ) {
        let hidden: Vec<Key> =
            self.tracks.keys().copied().filter(|&key| self.is_hidden(key, overlap)).collect();
        if hidden.is_empty() {
            return;
        }
        let width = measure.view.size.0;
        let mut rests: BTreeMap<usize, Vec<usize>> = (0..segments.len())
            .filter(|&k| self.shows_more(k, segments[k].px, overlap))
            .map(|k| (k, Vec::new()))
            .collect();
        for (pixel, &label) in labels.iter().enumerate() {
            if let Some(k) = usize::from(label).checked_sub(1)
                && predicted[pixel] == 0
                && is_looked_at(pixel, width)
                && let Some(rest) = rests.get_mut(&k)
            {
                rest.push(pixel);
            }
        }
        for (k, pixels) in rests {
            let rest = measure.segment(&pixels);
            let fits = |&key: &Key| found_again(&rest, &self.tracks[&key], self.stamp_s, self.pace).is_some();
            let Ok(own) = u16::try_from(segments.len() + 1) else { return };
            // The hand may have hidden the thing itself.
            let rested = self.rested_surface(&pixels, measure.view);
            let stays = |key: &Key| self.tracks.get(key).is_some_and(|track| !track.has_drifted());
            let is_its_own = rested.filter(stays).is_some_and(|key| overlap.is_held_by(k, key));
            if is_its_own || !hidden.iter().any(fits) {
                continue;
            }
            let belongs = |label: u16, key: Key| usize::from(label) == k + 1 && key == 0;
            labels
                .iter_mut()
                .zip(predicted)
                .filter(|(label, key)| belongs(**label, **key))
                .for_each(|(label, _)| *label = own);
            segments[k].px = segments[k].px.saturating_sub(rest.px);
            segments.push(rest);
        }
    }

    /// Whether a known thing is predicted nowhere.
    fn is_hidden(&self, key: Key, overlap: &Overlap) -> bool {
        self.tracks[&key].rested_alone() && !overlap.predicted.contains_key(&key)
    }

    /// Whether a segment shows a known thing, and much that no track should show.
    fn shows_more(&self, k: usize, px: usize, overlap: &Overlap) -> bool {
        let (mut known, mut holds) = (0, false);
        for (&(_, key), &common) in overlap.common.range((k, 0)..=(k, Key::MAX)) {
            known += common;
            let predicted = overlap.predicted.get(&key).copied().unwrap_or(0);
            holds |= common as f64 > HOLDS * predicted as f64
                && self.tracks.get(&key).is_some_and(|track| track.rest.is_some() && !track.is_agent_part());
        }
        holds && px.saturating_sub(known) as f64 > LEAST_SHARE * px as f64
    }
}
