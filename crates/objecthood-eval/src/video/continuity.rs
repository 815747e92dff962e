//! Id switches, and objects that keep one id.
//!
//! Objects and tracks are paired as by CLEAR MOT: K. Bernardin, R. Stiefelhagen, "Evaluating Multiple Object Tracking
//! Performance", EURASIP JIVP 2008. In each frame a pair of the frame before goes on while its `IoU` is at least 0.5; all other
//! pairs of such an `IoU` are made so that its sum is greatest. Switches are those of `TrackEval`.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use super::overlap::{FrameOverlap, Overlaps, SHOWN_IOU};
use crate::assignment::maximize;
use crate::support::LEAST_SEEN_PX;

/// Of the frames in which an object is seen, the share that its track has to show: "mostly tracked" of B. Wu, R. Nevatia,
/// CVPR 2006.
const MOSTLY: f64 = 0.8;

/// How steady ids are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContinuityCounts {
    /// How often an object is paired with another track than the last time.
    pub switches: u64,
    /// Objects that are paired with one track alone, in at least 0.8 of the frames in which [`LEAST_SEEN_PX`] of them are seen.
    pub unbroken: u64,
    /// Objects of which so much is seen in any frame.
    pub objects: u64,
}

/// What became of an object so far, in the frames in which enough of it is seen.
#[derive(Clone, Copy, Default)]
struct Life {
    seen: u64,
    shown: u64,
    track: Option<u16>,
    changed: bool,
}

impl ContinuityCounts {
    /// Counts. One assignment a frame, O(r² c) for its r objects and c tracks.
    pub fn of(overlaps: &Overlaps) -> Self {
        let mut counts = Self::default();
        let mut lives: BTreeMap<u16, Life> = BTreeMap::new();
        let mut last: BTreeMap<u16, u16> = BTreeMap::new();
        let mut before: BTreeMap<u16, u16> = BTreeMap::new();
        for frame in &overlaps.frames {
            let pairs = pairs(frame, &before);
            for (&object, &track) in &pairs {
                counts.switches += u64::from(last.insert(object, track).is_some_and(|old| old != track));
            }
            for seen in frame.objects.iter().filter(|seen| seen.px >= LEAST_SEEN_PX) {
                let life = lives.entry(seen.id).or_default();
                life.seen += 1;
                if let Some(&track) = pairs.get(&seen.id) {
                    life.shown += 1;
                    life.changed |= *life.track.get_or_insert(track) != track;
                }
            }
            // As TrackEval: a frame without objects or without tracks is passed over.
            if !frame.objects.is_empty() && !frame.tracks.is_empty() {
                before = pairs;
            }
        }
        let is_unbroken = |life: &Life| !life.changed && life.shown as f64 >= MOSTLY * life.seen as f64;
        counts.objects = lives.len() as u64;
        counts.unbroken = lives.values().filter(|life| is_unbroken(life)).count() as u64;
        counts
    }
}

/// The track of each object that has one; `before`: the pairs of the last frame.
fn pairs(frame: &FrameOverlap, before: &BTreeMap<u16, u16>) -> BTreeMap<u16, u16> {
    let value = frame.matrix(|pair| {
        let (object, track) = frame.ids(pair);
        let goes_on = before.get(&object) == Some(&track);
        let iou = frame.iou(pair);
        if iou >= SHOWN_IOU - f64::EPSILON { iou + if goes_on { 1000.0 } else { 0.0 } } else { 0.0 }
    });
    let columns = frame.tracks.len();
    let pairs = maximize(&value, frame.objects.len(), columns).into_iter();
    pairs
        .filter(|&(row, column)| value[row * columns + column] > 0.0)
        .map(|(row, column)| (frame.objects[row].id, frame.tracks[column].id))
        .collect()
}

impl AddAssign for ContinuityCounts {
    fn add_assign(&mut self, other: Self) {
        self.switches += other.switches;
        self.unbroken += other.unbroken;
        self.objects += other.objects;
    }
}
