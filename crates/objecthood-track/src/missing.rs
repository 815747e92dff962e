//! Tracks that are not seen, and new tracks.

use std::collections::BTreeMap;

use crate::happening::{Happening, Other};
use crate::happenings::LIFTED_M;
use crate::memory::{Look, Memory};
use crate::rested::Remains;
use crate::scene::Key;
use crate::track::{Deed, Track};
use crate::tracked::EventKind;

/// Something nearer than a thing by this (m) stands before it.
const BEFORE_M: f64 = 0.02;
/// A thing is hidden if this share of the pixels where it rested is hidden,
const HIDDEN: f64 = 0.9;
/// for this long (s).
const HIDDEN_S: f64 = 0.1;
/// A thing is not where it rested if this share of the pixels of its place is bare.
const BARE: f64 = 0.5;
/// A thing that an agent hid is taken by the agent once its place is bare, and the thing unseen, for this
/// long (s). A thing that is pushed is seen again sooner.
const TAKEN_S: f64 = 1.0;
/// A thing is gone if it is not seen for this long (s).
const GONE_S: f64 = 0.1;
/// A thing that leaves the image has gone this far (m) from where it rested: an arm that comes in hides what
/// lies at the border bit by bit.
const LEAVING_M: f64 = 0.05;
/// When it was last seen it moved, or this share of its pixels changed.
const LEAVING_CHANGED: f64 = 0.35;
/// It moves faster than this (m/s).
const LEAVING_M_PER_S: f64 = 0.02;
/// A new thing is a thing of its own once it has rested for this long (s).
const SETTLED_S: f64 = 0.25;

/// Why a track is not seen.
struct Absence {
    /// The first frame in which it is not seen, and the number of such frames.
    since: u64,
    frames: u64,
    /// Whether something stands before where it was, and what.
    is_covered: bool,
    by: Other,
    /// Share of where it rested that something nearer hides.
    hidden: f64,
    /// Share of where it rested at which something farther is seen now.
    bare: f64,
}

impl Memory {
    /// Examines the tracks that are not seen: what stands before them?
    pub(crate) fn miss(&mut self, look: &Look<'_>, remains: &BTreeMap<Key, Remains>) {
        let shown = self.shown_now();
        let is_missing = |(key, track): &(&Key, &Track)| track.part_of.is_none() && !shown.contains(key);
        let missing: Vec<Key> = self.tracks.iter().filter(is_missing).map(|(&key, _)| key).collect();
        let carried = self.carried();
        for key in missing {
            let absence = self.absence(key, look, remains.get(&key).copied().unwrap_or_default());
            self.tell_absence(key, &absence, carried.contains(&key));
        }
    }

    /// Why a track is not seen.
    fn absence(&self, key: Key, look: &Look<'_>, remains: Remains) -> Absence {
        let track = &self.tracks[&key];
        let since = track.hidden_since.unwrap_or(self.frame);
        // Where it was, as seen from here.
        let at = look.place.world_from_camera.inverse().point(track.last.center);
        let pixel = look.view.pixel_of(at);
        let is_covered = pixel.is_some_and(|pixel| {
            let inverse = f64::from(look.view.inverse[pixel]);
            self.agents.region.has(pixel) || inverse > 0.0 && 1.0 / inverse < at.z - BEFORE_M
        });
        let by = pixel.and_then(|pixel| {
            let agent = self.agents.sure().find(|agent| agent.mask.has(pixel));
            let other = self.root(self.scene.seen[pixel]);
            let thing = (other > 0 && other != key).then_some(Other::Track(other));
            agent.map(|agent| Other::Agent(agent.number)).or(thing)
        });
        let share = |px: usize| px as f64 / remains.all.max(1) as f64;
        let (hidden, bare) = (share(remains.hidden), share(remains.bare));
        let (frames, by) = (self.frame - since + 1, by.unwrap_or(Other::Nobody));
        Absence { since, frames, is_covered, by, hidden, bare }
    }

    /// Reports that a track went behind something or out of the image, once that is sure. `is_carried`: what
    /// carries it moves, so it is not where it rested.
    fn tell_absence(&mut self, key: Key, absence: &Absence, is_carried: bool) {
        let gone_frames = self.pace.frames(GONE_S) as u64;
        let Some(track) = self.tracks.get_mut(&key) else { return };
        let happening = |frame, time_s, kind, other, evidence: &str| Happening {
            frame,
            time_s,
            kind,
            object: key,
            other,
            span: None,
            confidence: 0.8,
            evidence: evidence.to_owned(),
        };
        let is_known = track.rest.is_some() && !track.is_agent_part();
        let was_raised = track.rest.is_some_and(|rest| track.last.bottom_m - rest.bottom_m > LIFTED_M);
        if track.gone_since.is_some_and(|(frame, _)| frame <= track.last.frame) && !was_raised {
            // It was seen again since then, and not in a hand.
            track.gone_since = None;
        }
        if absence.bare > BARE && is_known && !is_carried {
            let &mut (frame, time_s) = track.gone_since.get_or_insert((self.frame, self.stamp_s));
            if self.stamp_s - time_s > TAKEN_S {
                self.happenings.take_unseen(key, track, (frame, time_s));
            }
        }
        let from = match track.covered_since {
            _ if absence.hidden < HIDDEN => None,
            None => Some((self.frame, self.stamp_s)),
            known => known,
        };
        track.covered_since = from;
        let covered =
            from.filter(|&(frame, _)| (self.frame - frame + 1) as usize >= self.pace.frames(HIDDEN_S));
        let is_in_hand = self.happenings.is_lifted(key) || track.gone_since.is_some();
        let is_there = is_known && !is_carried && !is_in_hand && !track.is_scenery();
        let is_hidden = absence.is_covered && !track.told_hidden && is_there;
        if let Some((frame, time_s)) = covered.filter(|_| is_hidden) {
            track.told_hidden = true;
            let evidence = "something nearer hides nine tenths of where it rested";
            let kind = EventKind::Occluded;
            self.happenings.tell(happening(frame, time_s, kind, absence.by, evidence));
        }
        let is_thing = track.told_appeared || track.rest.is_some();
        let went = track.last.moves || track.last.changed > LEAVING_CHANGED;
        let has_left = track.last.at_border
            && !track.told_left
            && is_thing
            && went
            && !track.is_agent_part()
            && absence.frames >= gone_frames
            && !absence.is_covered
            && track.velocity.length() > LEAVING_M_PER_S
            && track.rest.is_none_or(|rest| (track.last.center - rest.center).length() > LEAVING_M);
        if has_left {
            track.told_left = true;
            let (frame, time_s) = (track.last.frame + 1, track.last.stamp_s + self.pace.frame_s);
            let evidence = "it moved at the border of the image";
            self.happenings.tell(happening(frame, time_s, EventKind::Left, Other::Nobody, evidence));
        }
        track.hidden_since = Some(absence.since);
        track.is_covered = absence.is_covered;
        track.rest_s = if absence.is_covered { track.rest_s } else { 0.0 };
        if absence.frames == gone_frames + 1 {
            self.happenings.fly(key, track);
        }
    }

    /// Reports new tracks that came into view as things of their own.
    pub(crate) fn tell_appearances(&mut self) {
        for (&key, track) in &mut self.tracks {
            let is_new = !track.told_appeared
                && track.is_confirmed()
                && !track.is_agent_part()
                && track.part_of.is_none();
            let has_settled = track.rest_s > SETTLED_S || track.seen_to.contains(&Deed::Flew);
            // A thing that rolls through the image never rests.
            let went_by_itself = track.was_free(self.pace) && track.path_m > track.area_m2.sqrt();
            if is_new && (has_settled || went_by_itself) {
                track.told_appeared = true;
                let came = track.samples.iter().take(6).any(|sample| sample.changed > 0.5);
                if came {
                    self.happenings.tell(Happening {
                        frame: track.first.frame,
                        time_s: track.first.stamp_s,
                        kind: EventKind::Appeared,
                        object: key,
                        other: Other::Nobody,
                        span: None,
                        confidence: 0.6,
                        evidence: "it was not there before, and is a thing of its own".to_owned(),
                    });
                }
            }
        }
    }
}
