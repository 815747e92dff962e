//! Which object a track shows, and which track an object has.

use std::collections::BTreeMap;

use super::overlap::{Common, FrameOverlap, Overlaps, SHOWN_IOU};

/// When each track shows which object: in the frames in which their `IoU` is at least 0.5.
pub(crate) struct Shows<'a> {
    overlaps: &'a Overlaps,
    /// Frame and object, by track, ascending.
    by_track: BTreeMap<u16, Vec<(usize, u16)>>,
}

impl<'a> Shows<'a> {
    /// O(p) for p pairs in all frames.
    pub(crate) fn of(overlaps: &'a Overlaps) -> Self {
        let mut by_track: BTreeMap<u16, Vec<(usize, u16)>> = BTreeMap::new();
        for (k, frame) in overlaps.frames.iter().enumerate() {
            for pair in best_pairs(frame, |pair| pair.track) {
                let (object, track) = frame.ids(pair);
                by_track.entry(track).or_default().push((k, object));
            }
        }
        Self { overlaps, by_track }
    }

    /// What a track shows in the frame nearest to this one in which it shows anything, the earlier of two; by its name in this
    /// frame. `None` when it never shows anything.
    pub(crate) fn object_of(&self, track: u16, frame: usize) -> Option<u16> {
        let shown = self.by_track.get(&track)?;
        let after = shown.partition_point(|&(k, _)| k <= frame);
        let near = shown[after.saturating_sub(1)..].iter().take(2);
        let (_, object) = near.min_by_key(|(k, _)| (k.abs_diff(frame), *k))?;
        Some(self.name_of(*object, frame))
    }

    /// The object that stands for an instance in a frame.
    pub(crate) fn name_of(&self, instance: u16, frame: usize) -> u16 {
        self.overlaps.frames.get(frame).map_or(instance, |overlap| overlap.name_of(instance))
    }

    /// Whether enough of the thing that stands for an instance is seen in a frame.
    pub(crate) fn is_seen(&self, instance: u16, frame: usize) -> bool {
        self.overlaps.frames.get(frame).is_some_and(|overlap| overlap.seen_px(instance) > 0)
    }

    /// The track that shows an instance, or the group that it is part of, in a frame.
    pub(crate) fn track_of(&self, instance: u16, frame: usize) -> Option<u16> {
        let overlap = &self.overlaps.frames[frame];
        let name = overlap.name_of(instance);
        let pairs = best_pairs(overlap, |pair| pair.object);
        let pair = pairs.into_iter().find(|pair| overlap.objects[pair.object].id == name)?;
        Some(overlap.tracks[pair.track].id)
    }

    /// The same, but only if no other track lies there: with more than half of its pixels on the thing, and not a crumb of it.
    pub(crate) fn only_track_of(&self, instance: u16, frame: usize) -> Option<u16> {
        /// Less of a thing than this share is a crumb.
        const CRUMB: f64 = 0.05;
        let overlap = &self.overlaps.frames[frame];
        let (name, track) = (overlap.name_of(instance), self.track_of(instance, frame)?);
        let is_other = |pair: &&Common| {
            let (object, other) = overlap.ids(pair);
            let (thing_px, own_px) = (overlap.objects[pair.object].px, overlap.tracks[pair.track].px);
            let is_there = 2 * pair.px > own_px && f64::from(pair.px) >= CRUMB * f64::from(thing_px);
            object == name && other != track && is_there
        };
        (!overlap.common.iter().any(|pair| is_other(&pair))).then_some(track)
    }

    /// Whether a track is one that is not judged in a frame.
    pub(crate) fn is_unpunished(&self, track: u16, frame: usize) -> bool {
        self.overlaps.frames.get(frame).is_some_and(|overlap| overlap.unpunished.contains(&track))
    }
}

/// The pairs of an `IoU` of at least 0.5, of those with one `side` the best. Two of exactly 0.5 are possible: the first counts.
fn best_pairs(frame: &FrameOverlap, side: impl Fn(&Common) -> usize) -> Vec<&Common> {
    let mut best: BTreeMap<usize, &Common> = BTreeMap::new();
    for pair in frame.common.iter().filter(|pair| frame.iou(pair) >= SHOWN_IOU) {
        let held = best.entry(side(pair)).or_insert(pair);
        if frame.iou(pair) > frame.iou(held) {
            *held = pair;
        }
    }
    best.into_values().collect()
}
