//! What happens to a thing: derived from where it was, how it moved and who reached it.

use std::collections::BTreeMap;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::flight::Flight;
use crate::happening::{Happening, Other};
use crate::pace::Pace;
use crate::put_down::{STILL_S, put_down};
use crate::scene::Key;
use crate::support::Parent;
use crate::taken::{CARRIED_M, picked_up, taken_at, taken_unseen};
use crate::track::{AS_WHOLE, Deed, Rest, Sample, Track, are_alike};
use crate::tracked::{EventKind, Relation};
use crate::vessel::Lay;

/// A thing is lifted if its lowest point rose by this (m), and its mean point by half of this.
pub(crate) const LIFTED_M: f64 = 0.02;
/// At least this share of the rise is explained by motions that were found.
const LEAST_FOUND: f64 = 0.5;
/// A thing stays where it is if at least this share of its pixels shows what rested there.
pub(crate) const STAYS: f64 = 0.8;
/// A thing begins to rise when it has moved up by this (m).
const OFF_M: f64 = 0.005;
/// A thing is displaced if it moved by this between rest and rest (m), half of it by motions that were found.
/// The displacement begins when it has moved by the second,
const PUSHED_M: f64 = 0.012;
const BEGUN_M: f64 = 0.003;
/// or by this share of the whole.
const BEGUN_SHARE: f64 = 0.15;
/// An agent that reached a thing at most this long ago (s) may have moved it.
pub(crate) const REACHED_S: f64 = 0.33;
/// A thing that has rested for this long (s) is not being pushed, even by an agent that still touches it.
const UNTOUCHED_S: f64 = 0.6;
/// A thing is in a hand if at least this share of its pixels belongs to an agent's region.
const OF_AGENT: f64 = 0.5;
/// The things under a lid are seen within this time (s) after the lid was lifted.
const LID_S: f64 = 0.6;
/// Flights with less time between them (s) are bounces of one flight.
const BOUNCE_S: f64 = 0.34;
/// A fall goes down by more than this (m), and up by less.
const FALL_M: f64 = 0.03;
/// A thing that falls was seen before for this long (s).
const SEEN_BEFORE_S: f64 = 0.15;

/// A thing that an agent handles.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Handling {
    before: Rest,
    agent: u32,
    /// What held it, and how.
    held_by: Option<(Parent, Relation)>,
    /// Whether it was lifted only because the thing that holds it was.
    goes_along: bool,
    begun: u64,
    /// When its lift began (s), once that is sure.
    lifted_s: Option<f64>,
    /// The lift, until it is sure that it is not that of a lid.
    lift: Vec<Happening>,
}

/// Events of a part that came off the thing, until it is sure that the part is not its lid.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Parting {
    whole: Key,
    part: Key,
    since: u64,
    since_s: f64,
    told: Vec<Happening>,
}

/// Follows what happens to all tracks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Happenings {
    handled: BTreeMap<Key, Handling>,
    partings: Vec<Parting>,
    told: Vec<Happening>,
}

impl Happenings {
    pub(crate) fn tell(&mut self, happening: Happening) {
        self.told.push(happening);
    }

    /// The events that have become certain since the last call.
    pub(crate) fn take(&mut self) -> Vec<Happening> {
        std::mem::take(&mut self.told)
    }

    pub(crate) fn forget(&mut self, key: Key) {
        self.handled.remove(&key);
    }

    /// A track turned out to be part of another: what is done to the part is done to the other.
    pub(crate) fn hand_over(&mut self, part: Key, whole: Key) {
        if let Some(handling) = self.handled.remove(&part) {
            self.handled.entry(whole).or_insert(handling);
        }
    }

    /// The agents that have lifted something and have not let it go.
    pub(crate) fn lifting(&self) -> impl Iterator<Item = u32> {
        self.carried().map(|(_, agent)| agent)
    }

    /// The things that agents have lifted and not let go, each with its agent.
    pub(crate) fn carried(&self) -> impl Iterator<Item = (Key, u32)> {
        let lifted = self.handled.iter().filter(|(_, handling)| handling.lifted_s.is_some());
        lifted.map(|(&key, handling)| (key, handling.agent))
    }

    /// The things that agents handle, each with its agent.
    pub(crate) fn handled(&self) -> impl Iterator<Item = (Key, u32)> {
        self.handled.iter().map(|(&key, handling)| (key, handling.agent))
    }

    pub(crate) fn is_handled(&self, key: Key) -> bool {
        self.handled.contains_key(&key)
    }

    pub(crate) fn is_lifted(&self, key: Key) -> bool {
        self.handled.get(&key).is_some_and(|handling| handling.lifted_s.is_some())
    }

    /// Whether its lift, which is not reported yet, was that of the thing that held it: both were lifted at
    /// about the same time.
    fn is_lifted_along(&self, key: Key) -> bool {
        let Some(handling) = self.handled.get(&key) else { return false };
        let carrier = handling.held_by.and_then(|(parent, _)| self.handled.get(&parent?));
        let goes_along = |carrier: &Handling| {
            let apart_s = carrier.lifted_s.zip(handling.lifted_s).map(|(one, other)| (one - other).abs());
            carrier.agent == handling.agent && apart_s.is_some_and(|apart_s| apart_s < LID_S)
        };
        !handling.lift.is_empty() && carrier.is_some_and(goes_along)
    }

    /// Examines a track that is seen, after its new sample. `is_carried`: whether what it lies in or stands
    /// on moves.
    pub(crate) fn look(&mut self, key: Key, track: &mut Track, is_carried: bool, up: DVec3, pace: Pace) {
        if track.is_agent_part() {
            return;
        }
        // A thing that was opened is neither lifted nor pushed.
        if !is_carried && !track.told_opened {
            self.begin(key, track);
        }
        self.lift(key, track, up);
        if self.is_lifted(key) && self.is_put_down(key, track) && track.is_still_for(STILL_S, pace.frame_s) {
            self.end(key, track, pace, false);
        }
        let is_let_go = !self.is_lifted(key) && track.reached_within(REACHED_S).is_none();
        if self.is_handled(key) && is_let_go {
            self.end(key, track, pace, false);
        }
        if track.rests() || track.forgets_soon() {
            self.fly(key, track);
        }
        if track.rests() {
            if track.is_still_for(STILL_S, pace.frame_s) {
                self.end(key, track, pace, false);
            }
            // A thing that lies farther away, or on another face than before, shows fewer pixels.
            let is_whole = track.rest.is_none_or(|rest| track.last.px as f64 > AS_WHOLE * rest.px as f64);
            let is_over = is_whole || track.is_left_alone() && track.rest_s > UNTOUCHED_S;
            if !self.handled.contains_key(&key) && is_over {
                track.settle();
            }
        }
    }

    /// Whether a thing is put down. In a hand that keeps still it is not, unless something is seen to hold
    /// it. The ground does not reach up.
    fn is_put_down(&self, key: Key, track: &Track) -> bool {
        let is_low = self
            .handled
            .get(&key)
            .is_some_and(|handling| track.last.bottom_m < handling.before.bottom_m + LIFTED_M);
        let is_held_from_below = track.votes.winner().is_some_and(|(parent, _)| parent.is_some() || is_low);
        track.last.of_agent < OF_AGENT || is_held_from_below
    }

    /// Closes a track: it is gone, or the video ends.
    pub(crate) fn close(&mut self, key: Key, track: &mut Track, pace: Pace) {
        self.fly(key, track);
        if let Some(since) = track.gone_since.filter(|&(frame, _)| frame > track.last.frame) {
            self.take_unseen(key, track, since);
        }
        self.end(key, track, pace, true);
    }

    /// Begins to follow a thing that was at rest and moves within an agent's reach.
    fn begin(&mut self, key: Key, track: &Track) {
        let (Some(before), false) = (track.rest, self.handled.contains_key(&key)) else { return };
        let last = track.last;
        let shift_m = (last.center - before.center).length();
        // A thing far from where it rested was moved, even if a hand hides how.
        let is_gone = track.gone_since.is_some() && shift_m > CARRIED_M;
        let is_far = is_gone || shift_m > LIFTED_M && are_alike(last.px, before.px);
        let is_displaced = shift_m > BEGUN_M && track.is_moving || is_far;
        let agent = track.reached_within(REACHED_S).or_else(|| track.taken_by(REACHED_S));
        let Some(agent) = agent else { return };
        if track.rest_s == 0.0 && (is_displaced || last.bottom_m - before.bottom_m > OFF_M && track.is_moving)
        {
            let (held_by, begun) = (track.votes.winner(), last.frame);
            let (goes_along, lifted_s, lift) = (false, None, Vec::new());
            let handling = Handling { before, agent, held_by, goes_along, begun, lifted_s, lift };
            self.handled.insert(key, handling);
        }
    }

    /// An agent hid a thing that is now seen nowhere, and the place of the thing has been bare since a frame
    /// and time (s). So the agent has it.
    pub(crate) fn take_unseen(&mut self, key: Key, track: &mut Track, since: (u64, f64)) {
        let (Some(before), Some(agent)) = (track.rest, track.taken_by(REACHED_S)) else { return };
        // A thing that was pushed or fell away before it was hidden left its place by itself.
        let was_low = track.last.bottom_m - before.bottom_m < LIFTED_M;
        let went = track.is_away() && track.last.in_place < STAYS && was_low;
        if self.is_lifted(key) || track.last.at_border || track.is_open() || went {
            return;
        }
        let (begun, lifted_s) = taken_at(&track.last, since);
        let held_by = track.votes.winner();
        let evidence = "a hand hid it, and its place is bare".to_owned();
        let lift = picked_up(key, (begun, lifted_s), agent, held_by, 0.6, evidence);
        let lifted_s = Some(lifted_s);
        let handling = Handling { before, agent, held_by, goes_along: false, begun, lifted_s, lift };
        self.handled.insert(key, handling);
        track.note(Deed::Lifted);
        track.votes.clear();
    }

    /// Reports a lift as soon as it is sure.
    fn lift(&mut self, key: Key, track: &mut Track, up: DVec3) {
        let Some(handling) = self.handled.get_mut(&key) else { return };
        let before = handling.before;
        // A hand before the lower part of a thing only seems to lift it: no motion is found, and its top does
        // not rise.
        let [rise_m, top_m] = [track.last.bottom_m - before.bottom_m, track.last.top_m - before.top_m];
        let rises_as_one = are_alike(track.last.px, before.px) && (top_m - rise_m).abs() < LIFTED_M / 2.0;
        let found_m = track.drift.dot(up);
        let is_found = found_m > LIFTED_M / 2.0 && (found_m > rise_m * LEAST_FOUND || top_m > LIFTED_M);
        let climbs = is_found || rises_as_one;
        // If a thing is lifted along its own face, much of it is still seen where it rested; a hand before it
        // does not lift its top.
        let is_off = |sample: &Sample, by_m: f64| {
            sample.in_place < STAYS
                || sample.top_m - before.top_m > by_m && sample.bottom_m - before.bottom_m > by_m
        };
        let is_up = |sample: &Sample| {
            climbs
                && is_off(sample, LIFTED_M)
                && sample.bottom_m - before.bottom_m > LIFTED_M
                && sample.height_m - before.height_m > LIFTED_M / 2.0
        };
        let up = track.samples.iter().rev().take(2).filter(|sample| is_up(sample)).count();
        if handling.lifted_s.is_some() || up < 2 {
            return;
        }
        let rises = |sample: &&Sample| is_off(sample, OFF_M) && sample.height_m - before.height_m > OFF_M;
        let since = track
            .samples
            .iter()
            .rev()
            .take_while(|sample| sample.frame > before.frame && rises(sample))
            .last();
        let first = since.copied().unwrap_or(track.last);
        handling.lifted_s = Some(first.stamp_s);
        let evidence = format!("its lowest point rose by {:.0} mm in reach of the agent", 1000.0 * rise_m);
        handling.lift = picked_up(key, first.when(), handling.agent, handling.held_by, 0.9, evidence);
        track.note(Deed::Lifted);
        track.votes.clear();
    }

    /// A part came off a thing.
    pub(crate) fn part(&mut self, whole: Key, part: Key, (since, since_s): (u64, f64), told: Vec<Happening>) {
        self.partings.push(Parting { whole, part, since, since_s, told });
    }

    /// Reports lifts and partings that are not those of lids. `stayed`: whether a part has been seen
    /// continuously since a frame, because fingers come and go.
    pub(crate) fn tell_no_lids(&mut self, now_s: f64, stayed: impl Fn(Key, u64) -> bool) {
        for parting in self.partings.extract_if(.., |parting| now_s - parting.since_s > LID_S) {
            if stayed(parting.part, parting.since) {
                self.told.extend(parting.told);
            }
        }
        let goes_along: Vec<Key> =
            self.handled.keys().copied().filter(|&key| self.is_lifted_along(key)).collect();
        for key in goes_along {
            self.handled.entry(key).and_modify(|handling| {
                handling.goes_along = true;
                handling.lift.clear();
            });
        }
        for handling in self.handled.values_mut() {
            if handling.lift.first().is_some_and(|lift| now_s - lift.time_s > LID_S) {
                self.told.append(&mut handling.lift);
            }
        }
    }

    /// A thing was opened: what seemed to be its own lift was that of its lid, and what came off it is the
    /// lid.
    pub(crate) fn opens(&mut self, key: Key) {
        self.handled.remove(&key);
        self.partings.retain(|parting| parting.whole != key);
    }

    /// Reports how a handled thing came to rest.
    fn end(&mut self, key: Key, track: &mut Track, pace: Pace, is_last_word: bool) {
        let Some(handling) = self.handled.get(&key).cloned() else { return };
        if handling.goes_along || self.is_lifted_along(key) {
            track.settle();
        } else if handling.lifted_s.is_some() {
            // A video may end while a hand holds it still.
            let is_down = !is_last_word || self.is_put_down(key, track);
            self.told.extend(handling.lift);
            self.told.extend(is_down.then(|| put_down(key, track, handling.begun, pace)).flatten());
            track.lay = Some(Lay::after_handling(track, track.flew_since(handling.begun)));
            track.settle();
        } else {
            let net_m = (track.last.center - handling.before.center).length();
            let is_free = track.last.reached_by.is_none() || is_last_word || track.rest_s > UNTOUCHED_S;
            if !is_free && net_m > PUSHED_M {
                return;
            }
            match taken_unseen(track, handling.before) {
                Some(_) if !is_last_word && !track.is_still_for(STILL_S, pace.frame_s) => return,
                Some((frame, time_s)) => {
                    let evidence = "a hand hid it, and it rests elsewhere now".to_owned();
                    let (agent, held_by) = (handling.agent, handling.held_by);
                    self.told.extend(picked_up(key, (frame, time_s), agent, held_by, 0.6, evidence));
                    self.told.extend(put_down(key, track, frame, pace));
                    track.lay = Some(Lay::after_handling(track, track.flew_since(frame)));
                }
                None => self.told.extend(pushed(key, track, &handling, pace)),
            }
            if track.last.px as f64 >= AS_WHOLE * handling.before.px as f64 {
                track.settle();
            }
        }
        self.handled.remove(&key);
    }

    /// Reports flights since the last call.
    pub(crate) fn fly(&mut self, key: Key, track: &mut Track) {
        let found = track.flights_since(track.analysed_to);
        track.analysed_to = track.last.frame;
        let (Some(first), Some(last)) = (found.first(), found.last()) else { return };
        let time_of = |frame: u64| {
            track
                .samples
                .iter()
                .find(|sample| sample.frame >= frame)
                .map_or(track.last.stamp_s, |sample| sample.stamp_s)
        };
        let happening = |frame: u64, kind, span, evidence: String| Happening {
            frame,
            time_s: time_of(frame),
            kind,
            object: key,
            other: Other::Nobody,
            span,
            confidence: 0.9,
            evidence,
        };
        let told_of = |flight: &Flight| {
            format!(
                "acceleration {:.1} m/s² downwards, {:.0} mm off the parabola",
                flight.acceleration,
                1000.0 * flight.rms_m
            )
        };
        let mut told = Vec::new();
        for flight in &found {
            told.push(happening(
                flight.first,
                EventKind::Airborne,
                Some((flight.first, flight.last)),
                told_of(flight),
            ));
        }
        let was_seen = first.start_s - track.first.stamp_s >= SEEN_BEFORE_S;
        if was_seen && first.from_m - first.to_m > FALL_M && first.highest_m - first.from_m < FALL_M {
            told.push(happening(first.first, EventKind::Fell, None, told_of(first)));
        }
        let after = track
            .since(last.last + 1)
            .filter(|sample| sample.stamp_s < time_of(last.last) + BOUNCE_S)
            .count();
        if after >= 4 {
            let evidence = "heights stay after the flight".to_owned();
            told.push(happening(last.last + 1, EventKind::Landed, None, evidence));
        }
        track.note(Deed::Flew);
        self.told.extend(told);
    }
}

/// The push of a thing that was displaced without being lifted.
fn pushed(key: Key, track: &mut Track, handling: &Handling, pace: Pace) -> Option<Happening> {
    let (before, last) = (handling.before, track.last);
    let net_m = (last.center - before.center).length();
    let is_moved = are_alike(before.px, last.px) && net_m > PUSHED_M && track.drift.length() > PUSHED_M / 2.0;
    let is_over =
        track.is_still_for(STILL_S / 2.0, pace.frame_s) || track.reached_within(REACHED_S).is_none();
    if !is_moved || !is_over || track.flew_since(before.frame) {
        return None;
    }
    let begun_m = BEGUN_M.max(BEGUN_SHARE * net_m);
    let is_there = |sample: &&Sample| (sample.center - before.center).length() < begun_m;
    let stayed = track.samples.iter().rev().find(is_there).map_or(before.frame, |sample| sample.frame);
    let first = track.since(stayed + 1).next().copied().unwrap_or(last);
    track.note(Deed::Pushed);
    let evidence = format!("displaced by {:.0} mm in reach of the agent, without rising", 1000.0 * net_m);
    let other = Other::Agent(handling.agent);
    Some(Happening::at(first.when(), key, EventKind::Pushed, other, 0.8, evidence))
}
