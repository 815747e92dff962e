//! Things that go into a vessel, or out of it, without being handled: poured, or dropped (ours).

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::happening::{Happening, Other};
use crate::memory::Memory;
use crate::scene::Key;
use crate::track::{Deed, Sample, Track, are_alike};
use crate::tracked::{EventKind, Relation};

/// The place of a thing counts once the thing has rested for this long (s): until then the votes of earlier
/// frames may win.
const LIES_S: f64 = 0.6;
/// A thing lies elsewhere than before if it has moved by more than this (m).
const MOVED_M: f64 = 0.05;
/// A thing is down if its mean point is this close (m) to where it comes to rest.
const DOWN_M: f64 = 0.015;
/// A thing is outside if it is farther from the vessel's mean point than this share of the vessel's size (the
/// root of its area).
const OUTSIDE_SHARE: f64 = 0.6;

/// Where a thing lay when it last rested for a while.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lay {
    frame: u64,
    center: DVec3,
    /// The vessel in which it lay.
    vessel: Option<Key>,
}

impl Lay {
    fn of(track: &Track) -> Self {
        let vessel = match track.votes.winner() {
            Some((vessel, Relation::In)) => vessel,
            _ => None,
        };
        Self { frame: track.last.frame, center: track.last.center, vessel }
    }

    /// Resets the place after an agent lifted the thing: a thing that was put down lies where it is, and a
    /// thing that was dropped lay in nothing.
    pub(crate) fn after_handling(track: &Track, flew: bool) -> Self {
        let lay = Self::of(track);
        if flew { Self { center: DVec3::INFINITY, vessel: None, ..lay } } else { lay }
    }
}

impl Memory {
    /// Reports things that came to rest in a vessel, or out of one, and that no agent handled.
    /// `is_last_word`: the video ends.
    pub(crate) fn tell_vessels(&mut self, is_last_word: bool) {
        let least_s = if is_last_word { f64::MIN_POSITIVE } else { LIES_S };
        let is_thing =
            |track: &Track| !track.is_agent_part() && track.part_of.is_none() && track.is_confirmed();
        let lies = |track: &Track| track.rest_s >= least_s && track.last.frame + 1 >= self.frame;
        let keys: Vec<Key> = self
            .tracks
            .iter()
            .filter(|(_, track)| is_thing(track) && lies(track))
            .map(|(&key, _)| key)
            .collect();
        for key in keys {
            let track = &self.tracks[&key];
            let now = Lay::of(track);
            // A handled thing was reported with its handling.
            let told =
                if self.happenings.is_handled(key) { Vec::new() } else { self.passages(key, track, now) };
            told.into_iter().for_each(|happening| self.happenings.tell(happening));
            self.tracks.entry(key).and_modify(|track| track.lay = Some(now));
        }
    }

    /// What happened between where a thing lay before and where it lies now.
    fn passages(&self, key: Key, track: &Track, now: Lay) -> Vec<Happening> {
        // A thing that flew into the image lay in nothing.
        let before = track.lay.or(track.seen_to.contains(&Deed::Flew).then_some(Lay { vessel: None, ..now }));
        let is_elsewhere =
            track.lay.is_none_or(|lay| (lay.center - now.center).length() > MOVED_M) && are_whole(track);
        // A frame may have reported that a thing in a vessel lies on it.
        let goes_along =
            |before: &Lay| now.vessel.is_some_and(|vessel| self.went_along(vessel, *before, now));
        let Some(before) =
            before.filter(|before| is_elsewhere && before.vessel != now.vessel && !goes_along(before))
        else {
            return Vec::new();
        };
        let passage = |sample: &Sample, kind, vessel, evidence: &str| {
            Happening::at(sample.when(), key, kind, Other::Track(vessel), 0.6, evidence.to_owned())
        };
        let mut told = Vec::new();
        if let Some(vessel) = before.vessel {
            let evidence = "it lay in it, and came to rest elsewhere";
            told.push(passage(&self.outside(track, vessel), EventKind::TakenOut, vessel, evidence));
        }
        if let Some(vessel) = now.vessel {
            let evidence = "it came to rest in it";
            told.push(passage(&down(track), EventKind::PutIn, vessel, evidence));
        }
        told
    }

    /// Whether a vessel was moved as far as a thing.
    fn went_along(&self, vessel: Key, before: Lay, now: Lay) -> bool {
        let Some(vessel) = self.tracks.get(&self.root(vessel)) else { return false };
        let then =
            vessel.samples.iter().rfind(|sample| sample.frame <= before.frame).unwrap_or(&vessel.first);
        ((now.center - before.center) - (vessel.last.center - then.center)).length() < MOVED_M
    }

    /// The first sample after which a thing stayed outside of a vessel.
    fn outside(&self, track: &Track, vessel: Key) -> Sample {
        let vessel = self.tracks.get(&self.root(vessel));
        let is_inside = |sample: &&Sample| {
            vessel.is_some_and(|vessel| {
                let near = vessel.samples.iter().rfind(|other| other.frame <= sample.frame);
                let reach_m = OUTSIDE_SHARE * vessel.area_m2.sqrt();
                near.is_some_and(|near| (near.center - sample.center).length() < reach_m)
            })
        };
        let last = track.samples.iter().rfind(is_inside).map_or(0, |sample| sample.frame + 1);
        track.since(last).next().copied().unwrap_or(track.last)
    }
}

/// The first sample from which on a thing lay where it lies now.
fn down(track: &Track) -> Sample {
    let is_down = |sample: &&Sample| (sample.center - track.last.center).length() < DOWN_M;
    track.samples.iter().rev().take_while(is_down).last().copied().unwrap_or(track.last)
}

/// Whether a thing is seen as much as when it last rested.
fn are_whole(track: &Track) -> bool {
    track.rest.is_some_and(|rest| are_alike(rest.px, track.last.px))
}
