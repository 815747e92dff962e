//! Picked up, placed, pushed.

use super::{Event, EventKind, Tape, joined_runs, runs};
use crate::video::SupportKind;

/// What is carried rises by this (m), what is pushed does not.
const LIFTED_M: f64 = 0.02;
/// A thing is picked up in the first frame in which it is higher than at rest by more than this (m).
const PICKED_M: f64 = 0.005;
/// What is pushed ends at least so far from where it was (m).
const PUSHED_M: f64 = 0.012;
/// A push begins in the first frame in which the thing is farther than this from where it was (m).
const BEGUN_M: f64 = 0.002;
/// Touches of one agent this close in time are one (s).
const PAUSE_S: f64 = 0.15;
/// What was let go a little too high comes to rest within this (s).
const SETTLED_S: f64 = 0.2;

pub(super) fn events(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    if tape.is_jointed(object) {
        return Vec::new();
    }
    let mut events = Vec::new();
    for agent in 0..tape.video.agents().len() {
        let states = &tape.video.recording;
        let is_moved_by = |k: usize| {
            let state = &states[k][object];
            state.holder == Some(agent) || state.pusher == Some(agent)
        };
        let moved = joined_runs(runs(tape.frames(), is_moved_by), tape.during(PAUSE_S));
        for (first, last) in moved {
            events.extend(of_touch(tape, object, agent, first, last));
        }
    }
    events
}

/// What an agent did with a thing from one frame to another.
fn of_touch(tape: &Tape<'_>, object: usize, agent: usize, first: usize, last: usize) -> Vec<Event> {
    let before = first.saturating_sub(1);
    let by = Some(tape.video.agent_instance(agent));
    let rise_m = |k: usize| tape.video.bottom_m(k, object) - tape.video.bottom_m(before, object);
    if (first..=last).all(|k| rise_m(k) <= LIFTED_M) {
        let after = (last + tape.during(SETTLED_S)).min(tape.frames() - 1);
        let begun = (first..=last).find(|&k| tape.moved_m(object, before, k) > BEGUN_M);
        let is_pushed = tape.moved_m(object, before, after) > PUSHED_M;
        let pushed = begun.filter(|_| is_pushed);
        return pushed.map(|k| tape.event(EventKind::Pushed, k, object, by)).into_iter().collect();
    }
    let mut events = Vec::new();
    let picked = (first..=last).find(|&k| rise_m(k) > PICKED_M).unwrap_or(first);
    if tape.truth.edge(before, object).is_some() {
        events.push(tape.event(EventKind::PickedUp, picked, object, by));
    }
    events.extend(set_down(tape, object, picked, last));
    events
}

/// Where a thing that was in a hand until a frame touches what holds it from then on; not if it flew there.
fn set_down(tape: &Tape<'_>, object: usize, picked: usize, last: usize) -> Option<Event> {
    let latest = (last + tape.during(SETTLED_S)).min(tape.frames() - 1);
    let held = |k: usize| tape.truth.edge(k, object);
    let mut frame = (last..=latest).find(|&k| held(k).is_some())?;
    let is_flight =
        super::flown::flights(tape, object).iter().any(|&(start, _)| start + 2 >= last && start <= frame);
    if is_flight {
        return None;
    }
    let edge = held(frame)?;
    while frame > picked + 1 && held(frame - 1).is_some() {
        frame -= 1;
    }
    let kind = EventKind::PlacedOn;
    (edge.kind == SupportKind::On).then(|| tape.event(kind, frame, object, Some(edge.parent)))
}
