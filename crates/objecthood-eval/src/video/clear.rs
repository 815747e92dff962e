//! MOTA, id switches, interruptions, and objects that keep one id.
//!
//! Objects and tracks are paired as by CLEAR MOT: K. Bernardin, R. Stiefelhagen, "Evaluating Multiple Object Tracking
//! Performance", EURASIP JIVP 2008. In each frame a pair of the frame before goes on while its `IoU` is at least 0.5; all other
//! pairs of such an `IoU` are made so that its sum is greatest. Switches are those of `TrackEval`.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use super::counts::{Counts, share};
use super::overlap::{FrameOverlap, Overlaps, SHOWN_IOU};
use crate::assignment::maximize;

/// Of the frames in which an object is seen, the share that its track has to show: "mostly tracked" of B. Wu, R. Nevatia,
/// CVPR 2006.
pub(super) const MOSTLY: f64 = 0.8;

/// How many things are found, and how steady their ids are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ClearCounts {
    /// Frames of objects that have a track, those that have none, and frames of tracks that have no object.
    pub pairs: Counts,
    /// How often an object is paired with another track than the last time.
    pub switches: u64,
    /// How often an object has no track for a while and then has one again.
    pub interruptions: u64,
    /// Objects that are paired with one track alone, in at least 0.8 of the frames in which they are seen.
    pub unbroken: u64,
    /// Objects.
    pub objects: u64,
}

/// What became of an object so far.
#[derive(Clone, Copy, Default)]
struct Life {
    seen: u64,
    shown: u64,
    first_track: Option<u16>,
    has_changed: bool,
    /// Runs of frames in which it has a track.
    runs: u64,
}

impl ClearCounts {
    /// Counts. One assignment a frame, O(r² c) for its r objects and c tracks.
    pub fn of(overlaps: &Overlaps) -> Self {
        let mut counts = Self::default();
        let mut lives: BTreeMap<u16, Life> = BTreeMap::new();
        let mut last: BTreeMap<u16, u16> = BTreeMap::new();
        let mut before: BTreeMap<u16, u16> = BTreeMap::new();
        for frame in &overlaps.frames {
            let pairs = pairs(frame, &before);
            let (right, objects, tracks) = (pairs.len(), frame.objects.len(), frame.tracks.len());
            counts.pairs += Counts {
                right: right as u64,
                wrong: (tracks - right) as u64,
                missed: (objects - right) as u64,
            };
            for (&object, &track) in &pairs {
                counts.switches += u64::from(last.insert(object, track).is_some_and(|old| old != track));
            }
            for seen in &frame.objects {
                let life = lives.entry(seen.id).or_default();
                life.seen += 1;
                if let Some(&track) = pairs.get(&seen.id) {
                    life.shown += 1;
                    life.has_changed |= *life.first_track.get_or_insert(track) != track;
                    life.runs += u64::from(!before.contains_key(&seen.id));
                }
            }
            // As TrackEval: a frame without objects or without tracks is passed over.
            if !frame.objects.is_empty() && !frame.tracks.is_empty() {
                before = pairs;
            }
        }
        let is_unbroken = |life: &Life| !life.has_changed && life.shown as f64 >= MOSTLY * life.seen as f64;
        counts.objects = lives.len() as u64;
        counts.unbroken = lives.values().filter(|life| is_unbroken(life)).count() as u64;
        counts.interruptions = lives.values().map(|life| life.runs.saturating_sub(1)).sum();
        counts
    }

    /// Multiple object tracking accuracy: 1 less the misses, the false tracks and the switches for each frame of an object; may
    /// be negative, and is `None` without objects.
    pub fn mota(&self) -> Option<f64> {
        let Counts { right, wrong, missed } = self.pairs;
        let errors = wrong + self.switches;
        (right + missed > 0).then(|| (right as f64 - errors as f64) / (right + missed) as f64)
    }

    /// Share of the objects that keep one id; `None` without objects.
    pub fn unbroken_share(&self) -> Option<f64> {
        share(self.unbroken, self.objects)
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

impl AddAssign for ClearCounts {
    fn add_assign(&mut self, other: Self) {
        self.pairs += other.pairs;
        self.switches += other.switches;
        self.interruptions += other.interruptions;
        self.unbroken += other.unbroken;
        self.objects += other.objects;
    }
}
