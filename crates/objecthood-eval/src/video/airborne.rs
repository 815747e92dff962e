//! Free flight, frame by frame.

use std::collections::BTreeSet;
use std::ops::AddAssign;

use serde::Serialize;

use super::clip::{Event, TrueClip};
use super::counts::Counts;
use super::events::{AIRBORNE, interval};
use super::shows::Shows;

/// What was said about flights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct AirborneCounts {
    /// Frames of objects. Those in which an object flies, but which belong to no flight of the truth because it is too short or
    /// out of the image, are neither asked for nor wrong.
    pub frames: Counts,
    /// Flights that were said to be in clips in which nothing flies.
    pub in_still_clips: u64,
}

impl AirborneCounts {
    /// Counts. O(k log f) for k frames of flights.
    pub(crate) fn of(said: &[Event], clip: &TrueClip, shows: &Shows<'_>) -> Self {
        let flights = |events: &'_ [Event]| -> Vec<Event> {
            events.iter().filter(|event| event.kind == AIRBORNE).cloned().collect()
        };
        let (said, there) = (flights(said), flights(&clip.events));
        let frames = |event: &Event| {
            let (first, last) = interval(event);
            first..(last + 1).min(clip.frames.len())
        };
        let mut asked: BTreeSet<(u16, usize)> = BTreeSet::new();
        for event in &there {
            asked.extend(frames(event).map(|k| (shows.name_of(event.object, k), k)));
        }
        let mut told: BTreeSet<(u16, usize)> = BTreeSet::new();
        let mut counts = Self::default();
        for event in &said {
            for k in frames(event) {
                match shows.object_of(event.object, k) {
                    Some(object) => _ = told.insert((object, k)),
                    None => counts.frames.wrong += 1,
                }
            }
        }
        let flies = |&(object, k): &(u16, usize)| {
            clip.frames[k].airborne.iter().any(|&instance| shows.name_of(instance, k) == object)
        };
        counts.frames.right = told.intersection(&asked).count() as u64;
        counts.frames.missed = asked.difference(&told).count() as u64;
        counts.frames.wrong += told.difference(&asked).filter(|place| !flies(place)).count() as u64;
        if clip.frames.iter().all(|frame| frame.airborne.is_empty()) {
            counts.in_still_clips = said.len() as u64;
        }
        counts
    }
}

impl AddAssign for AirborneCounts {
    fn add_assign(&mut self, other: Self) {
        self.frames += other.frames;
        self.in_still_clips += other.in_still_clips;
    }
}
