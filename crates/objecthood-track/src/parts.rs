//! Tracks that turn out to be one, and tracks that come apart.

use std::collections::BTreeSet;

use glam::DVec3;

use crate::happening::{Happening, Other};
use crate::happenings::{REACHED_S, STAYS};
use crate::ingredient::Ingredient;
use crate::memory::{Look, Memory};
use crate::scene::Key;
use crate::track::{Deed, Track, are_alike};
use crate::tracked::EventKind;
use crate::whole::Sight;

/// A part that came off is a thing if it is seen in at least this share of the frames from then on.
const SEEN: f64 = 0.3;
/// Tracks touch if they are this close (px at VGA size).
const TOUCH_PX: f64 = 3.0;

impl Memory {
    /// Learns from tracks that touch.
    pub(crate) fn compare(&mut self, look: &Look<'_>) {
        let (width, height) = look.view.size;
        let reach = look.view.length_px(TOUCH_PX);
        let mut touching = BTreeSet::new();
        for v in 0..height {
            for u in 0..width {
                let pixel = v * width + u;
                let key = self.scene.seen[pixel];
                if key == 0 {
                    continue;
                }
                let right = (u + reach < width).then(|| pixel + reach);
                let below = (v + reach < height).then(|| pixel + reach * width);
                for other in [right, below].into_iter().flatten().map(|at| self.scene.seen[at]) {
                    if other > 0 && other != key {
                        touching.insert((key.min(other), key.max(other)));
                    }
                }
            }
        }
        if self.has(Ingredient::Knowledge) {
            for (a, b) in self.knowledge.learn(&touching, &self.tracks, look.place.moves) {
                let px = |key: Key| self.tracks[&key].last.px;
                let whole = if px(b) > px(a) { self.join(b, a) } else { self.join(a, b) };
                self.tracks.entry(whole).and_modify(|track| track.note(Deed::PartsMovedAsOne));
            }
        }
        self.touched = touching;
    }

    /// Two tracks turned out to be one. The one that is seen goes on, with the lower of their numbers;
    /// otherwise what is known about it would never be updated. Returns it.
    pub(crate) fn join(&mut self, seen: Key, other: Key) -> Key {
        let (whole, part) = (self.root(seen), self.root(other));
        let [own, parts] = [whole, part].map(|key| self.tracks[&key].id);
        if parts.is_some_and(|parts| own.is_none_or(|own| parts < own)) {
            self.tracks.entry(whole).and_modify(|track| track.id = parts);
            self.tracks.entry(part).and_modify(|track| track.id = own);
        }
        self.make_part(whole, part);
        whole
    }

    /// Makes one track part of another, both of them roots, so that no circle arises.
    fn make_part(&mut self, whole: Key, part: Key) {
        if whole == part {
            return;
        }
        let Some(of_part) = self.tracks.get_mut(&part) else { return };
        of_part.part_of = Some(whole);
        let (was_there_first, told_appeared) = (of_part.was_there_first, of_part.told_appeared);
        let (deeds, number) = (std::mem::take(&mut of_part.seen_to), of_part.id);
        let parts = std::mem::take(&mut of_part.parts);
        self.happenings.hand_over(part, whole);
        self.tracks.entry(whole).and_modify(|track| {
            track.was_there_first |= was_there_first;
            track.told_appeared |= told_appeared;
            deeds.into_iter().for_each(|deed| track.note(deed));
            track.parts.extend(number.into_iter().chain(parts));
        });
    }

    /// Whether the last frame showed a track or a part of it.
    pub(crate) fn shown_now(&self) -> BTreeSet<Key> {
        let seen = self.tracks.iter().filter(|(_, track)| track.last.frame == self.frame);
        seen.map(|(&key, _)| self.root(key)).collect()
    }

    /// What stood before a thing is gone, and one surface shows the part of the thing too.
    pub(crate) fn merge(&mut self, owner: Key, part: Key) {
        let (whole, own) = (self.root(owner), self.root(part));
        if whole == own {
            return;
        }
        self.make_part(whole, own);
        self.tracks.entry(whole).and_modify(|track| track.sight = Sight::Whole);
        self.happenings.tell(Happening {
            frame: self.frame,
            time_s: self.stamp_s,
            kind: EventKind::Merged,
            object: owner,
            other: Other::Track(part),
            span: None,
            confidence: 0.9,
            evidence: "what stood before it is gone, and both parts are one surface".to_owned(),
        });
    }

    /// Reports partings and lifts once they cannot be those of a lid.
    pub(crate) fn tell_no_lids(&mut self, now_s: f64) {
        let stayed = |part: Key, since: u64| {
            let frames = self.frame.saturating_sub(since).max(1) as f64;
            self.tracks.get(&part).is_some_and(|track| track.since(since).count() as f64 > SEEN * frames)
        };
        self.happenings.tell_no_lids(now_s, stayed);
    }

    /// Handles a track that came off another thing and moved against it: it was one with the thing before.
    pub(crate) fn tell_partings(&mut self) {
        const PARTED_M: f64 = 0.005;
        // A slow push shows no motion from frame to frame. A thing that an agent pushed off has moved if its
        // middle has moved by this much while as much of it was seen.
        const SHIFTED_M: f64 = 0.01;
        const SEEN_LATE_S: f64 = 0.2;
        let mut parted = Vec::new();
        for (&key, track) in &self.tracks {
            let Some(from) = track.came_off else { continue };
            let Some(other) = self.tracks.get(&from) else { continue };
            if track.last.frame != self.frame
                || other.last.frame != self.frame
                || !track.is_confirmed()
                || track.is_agent_part()
            {
                continue;
            }
            let moved = |track: &Track, since: DVec3| (track.last.center - since).length();
            let (own, others) = (
                moved(track, track.first.center),
                other
                    .samples
                    .iter()
                    .find(|s| s.frame >= track.first.frame)
                    .map_or(0.0, |s| moved(other, s.center)),
            );
            // From elsewhere other parts of a thing are seen, and its middle seems to move.
            let moved_one = if own > others { track } else { other };
            let camera_moved = self.camera_moved.is_some_and(|frame| frame >= track.first.frame);
            let may_have_moved = !camera_moved || moved_one.last.in_place < STAYS;
            if may_have_moved
                && own.max(others) > PARTED_M
                && (own - others).abs() > PARTED_M
                && (track.drift.length().max(other.drift.length()) > PARTED_M
                    || track.is_off_thing && own > SHIFTED_M && are_alike(track.first.px, track.last.px)
                    || !self.has(Ingredient::Motion) && track.rests())
            {
                parted.push((key, from, own > others));
            }
        }
        for (key, from, own_moved) in parted {
            let track = &self.tracks[&key];
            // The parts may have moved for a while before the frame showed them as two.
            let rested = self.tracks.get(&from).and_then(|other| other.rest).map_or(0, |rest| rest.frame + 1);
            let early = track.first.frame.saturating_sub(self.pace.frames(SEEN_LATE_S) as u64);
            let frame = rested.clamp(early, track.first.frame);
            let time_s = track.first.stamp_s - (track.first.frame - frame) as f64 * self.pace.frame_s;
            let (object, other) = if own_moved { (key, from) } else { (from, key) };
            self.knowledge.part(key, from);
            let happening = |kind, other, evidence: &str| {
                let evidence = evidence.to_owned();
                Happening { frame, time_s, kind, object, other, span: None, confidence: 0.8, evidence }
            };
            let split = happening(EventKind::Split, Other::Track(other), "one moved against the other");
            let pushed = self.tracks[&object].reached_within(REACHED_S).map(|agent| {
                happening(EventKind::Pushed, Other::Agent(agent), "it came off in reach of the agent")
            });
            self.happenings.part(
                from,
                key,
                (self.frame, self.stamp_s),
                std::iter::once(split).chain(pushed).collect(),
            );
            if let Some(track) = self.tracks.get_mut(&key) {
                track.came_off = None;
            }
        }
    }
}
