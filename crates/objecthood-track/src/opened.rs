//! Lids, doors and drawers: a part of a thing is moved, the rest stays, and the inside of the thing is seen
//! (ours).

use std::collections::{BTreeMap, BTreeSet};

use crate::happening::{Happening, Other};
use crate::happenings::REACHED_S;
use crate::memory::{Look, Memory};
use crate::rested::Remains;
use crate::scene::Key;
use crate::track::{Sample, Track, are_alike};
use crate::tracked::EventKind;

/// A thing is open if at least this share of what is seen where it rested is its inside,
const OPEN: f64 = 0.05;
/// for this long (s);
const OPEN_S: f64 = 0.1;
/// it begins to be open at this share: gaps and noise show less.
const AJAR: f64 = 0.03;
/// The rest stays if at least this share of where the thing rested is still in place.
const STAYS: f64 = 0.2;
/// A thing is closed while this share of its pixels is in place. Its inside is seen within this time (s)
/// after it was last closed.
const CLOSED: f64 = 0.9;
const OPENING_S: f64 = 0.6;
/// The front of a drawer was pulled at least this far (m).
const PULLED_M: f64 = 0.02;
/// The front of a drawer is ahead of its inside by this (m), and the inside is lower by this (m); both by
/// their mean points.
const AHEAD_M: f64 = 0.01;
const LOWER_M: f64 = 0.003;
/// With fewer pixels (at VGA size) nothing is reported.
const LEAST_PX: f64 = 400.0;

impl Memory {
    /// What is seen where things rested.
    pub(crate) fn remains(&self, look: &Look<'_>) -> BTreeMap<Key, Remains> {
        let openable = self.tracks.iter().filter(|(_, track)| may_open(track)).map(|(&key, _)| key).collect();
        self.rested.remains(look, &self.agents.region, &openable)
    }

    /// The inside of a thing belongs to the part that was moved if that part reaches lower, as a drawer does.
    /// A lid lies higher.
    pub(crate) fn join_drawers(&mut self) {
        let is_seen = |track: &Track| track.last.frame == self.frame && track.part_of.is_none();
        let mut joined = Vec::new();
        for (&key, track) in self.tracks.iter().filter(|(_, track)| is_seen(track)) {
            if let Some(part) = track.inside_of.and_then(|whole| self.lid_of(whole))
                && let Some(moved) = self.tracks.get(&part).filter(|moved| is_seen(moved))
                && moved.last.bottom_m < track.last.height_m
                && self.touched.contains(&(key.min(part), key.max(part)))
            {
                joined.push((part, key));
            }
        }
        for (part, inside) in joined {
            self.join(part, inside);
        }
    }

    /// The moved part of a thing, if it has a number of its own: the one that was seen longest.
    fn lid_of(&self, key: Key) -> Option<Key> {
        let is_lid = |(_, track): &(&Key, &Track)| {
            track.moved_off == Some(key) && track.part_of.is_none() && track.id.is_some()
        };
        let lids = self.tracks.iter().filter(is_lid);
        lids.max_by_key(|(_, track)| track.hits).map(|(&lid, _)| lid)
    }

    /// Reports that a thing was opened, once its inside is seen.
    pub(crate) fn tell_openings(&mut self, look: &Look<'_>, remains: &BTreeMap<Key, Remains>) {
        let is_off = |part: &Track| (part.last.center - part.first.center).length() > PULLED_M;
        let parts = self.tracks.values().filter(|part| !part.rests() || is_off(part));
        let on_the_way: BTreeSet<Key> = parts.filter_map(|part| part.moved_off).collect();
        for (&key, of) in remains {
            let Some(track) = self.tracks.get_mut(&key) else { continue };
            let seen = of.all - of.hidden;
            let share = of.hollow as f64 / seen.max(1) as f64;
            let stays = of.stays as f64 > STAYS * of.all as f64;
            if share < AJAR
                || !stays
                || was_moved(track, self.frame)
                || (seen as f64) < look.view.px(LEAST_PX) as f64
            {
                track.ajar_since = None;
                if track.rests() && !may_open(track) && !on_the_way.contains(&key) {
                    (track.told_opened, track.lost_part) = (false, false);
                }
                continue;
            }
            let (frame, time_s) = *track.ajar_since.get_or_insert((self.frame, self.stamp_s));
            if share < OPEN || track.told_opened || self.stamp_s - time_s < OPEN_S {
                continue;
            }
            let percent = 100.0 * share;
            let evidence =
                format!("part of it was moved, and its inside is {percent:.0} % of what is seen there");
            self.tell_opened(key, (frame, time_s), evidence);
        }
    }

    /// Reports that a thing was opened. Its inside has been seen since a frame and time (s).
    fn tell_opened(&mut self, key: Key, (frame, time_s): (u64, f64), evidence: String) {
        self.tracks.entry(key).and_modify(|track| track.told_opened = true);
        self.happenings.opens(key);
        for (&part, track) in self.tracks.iter_mut().filter(|(_, part)| part.moved_off == Some(key)) {
            track.came_off = None;
            self.knowledge.part(part, key);
        }
        let lid = self.lid_of(key);
        let Some(track) = self.tracks.get(&key) else { return };
        // The lid says nothing about an earlier opening.
        let lid_s = lid.map(|lid| self.tracks[&lid].first.stamp_s);
        let seen_s =
            lid_s.filter(|lid_s| time_s - lid_s < OPENING_S).map_or(time_s, |lid_s| lid_s.min(time_s));
        let (frame, time_s) = closed_at(track, seen_s).unwrap_or((frame, time_s));
        self.happenings.tell(Happening {
            frame,
            time_s,
            kind: EventKind::Opened,
            object: lid.unwrap_or(key),
            other: lid.map_or(Other::Nobody, |_| Other::Track(key)),
            span: None,
            confidence: 0.7,
            evidence,
        });
    }

    /// Finds drawers: of two parts that came off a thing, one, the front, goes ahead, and the other lies
    /// lower.
    pub(crate) fn tell_drawers(&mut self) {
        let is_seen = |track: &Track| track.last.frame == self.frame && track.part_of.is_none();
        let parts: Vec<(Key, Key)> = self
            .tracks
            .iter()
            .filter_map(|(&key, track)| Some((key, track.moved_off.filter(|_| is_seen(track))?)))
            .collect();
        for &(front, whole) in &parts {
            let inside = parts.iter().find(|&&(inside, other)| {
                other == whole
                    && self.touched.contains(&(inside.min(front), inside.max(front)))
                    && is_front_of(&self.tracks[&front], &self.tracks[&inside])
            });
            let is_known = self.tracks.get(&whole).is_some_and(|track| !track.told_opened);
            let (Some(&(inside, _)), true) = (inside, is_known) else { continue };
            let since = self.tracks[&front].first;
            self.join(front, inside);
            let pulled_mm = 1000.0 * (self.tracks[&front].last.center - since.center).length();
            let evidence = format!("its front was pulled by {pulled_mm:.0} mm, and its inside lies lower");
            self.tell_opened(whole, (since.frame, since.stamp_s), evidence);
        }
    }
}

/// Whether a part that moves horizontally goes ahead of another, which lies lower.
fn is_front_of(front: &Track, inside: &Track) -> bool {
    let moved = front.last.center - front.first.center;
    let ahead_m = moved.try_normalize().map_or(0.0, |way| way.dot(front.last.center - inside.last.center));
    let rose_m = (front.last.height_m - front.first.height_m).abs();
    let is_pulled = moved.length() > PULLED_M && rose_m < 0.5 * moved.length();
    is_pulled && ahead_m > AHEAD_M && inside.last.height_m < front.last.height_m - LOWER_M
}

/// The last frame and time (s) in which a thing was seen closed, shortly before a time (s).
fn closed_at(track: &Track, before_s: f64) -> Option<(u64, f64)> {
    let is_before = |sample: &&Sample| sample.stamp_s < before_s && sample.stamp_s > before_s - OPENING_S;
    let closed = track.samples.iter().rev().filter(is_before).find(|sample| sample.in_place > CLOSED);
    closed.map(|sample| (sample.frame, sample.stamp_s))
}

/// Whether a thing is seen as a whole elsewhere than where it rested.
fn was_moved(track: &Track, frame: u64) -> bool {
    let is_whole = track.rest.is_some_and(|rest| are_alike(track.last.px, rest.px));
    track.last.frame == frame && track.is_away() && is_whole && !track.lost_part
}

/// Whether an agent may be opening a thing.
pub(crate) fn may_open(track: &Track) -> bool {
    track.rest.is_some()
        && track.reached_within(REACHED_S).is_some()
        && !track.is_agent_part()
        && track.part_of.is_none()
}
