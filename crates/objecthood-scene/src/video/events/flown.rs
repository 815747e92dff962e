//! Airborne, fell, landed.

use super::{Event, EventKind, Tape, runs};

/// Shorter flights (frames) are not told.
pub(super) const LEAST_FRAMES: usize = 5;
/// Flights this close in time are the bounces of one (s).
const BOUNCE_S: f64 = 0.34;
/// What falls ends lower than it began by this (m), and rises no higher than that above where it began.
const FALL_M: f64 = 0.03;
/// What is seen to fall was in the image for so long before (s).
const SEEN_S: f64 = 0.15;

/// First and last frame of every flight within the image: in no step between them anything but gravity acted.
pub(super) fn flights(tape: &Tape<'_>, object: usize) -> Vec<(usize, usize)> {
    let free = runs(tape.frames(), |k| tape.video.recording[k][object].was_free);
    let mut flights = Vec::new();
    for (first, last) in free {
        // A state says what was since the frame before.
        let start = first.saturating_sub(1);
        let seen = runs(last + 1, |k| k >= start && tape.is_in_image(k, object));
        flights.extend(seen.into_iter().filter(|(start, end)| end - start + 1 >= LEAST_FRAMES));
    }
    flights
}

pub(super) fn events(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    let flights = flights(tape, object);
    let mut events = Vec::new();
    for (k, &(start, end)) in flights.iter().enumerate() {
        let airborne = tape.event(EventKind::Airborne, start, object, None);
        events.push(Event { start: Some(start), end: Some(end), ..airborne });
        let gap = tape.during(BOUNCE_S);
        let is_first = k == 0 || flights[k - 1].1 + gap < start;
        if is_first && is_fall(tape, object, start, end) {
            events.push(tape.event(EventKind::Fell, start, object, None));
        }
        let is_last = flights.get(k + 1).is_none_or(|next| end + gap < next.0);
        if is_last && end + 1 < tape.frames() && tape.is_in_image(end + 1, object) {
            events.push(tape.event(EventKind::Landed, end + 1, object, None));
        }
    }
    events
}

/// Whether a flight began where the thing was seen before, and led down.
fn is_fall(tape: &Tape<'_>, object: usize, start: usize, end: usize) -> bool {
    let height = |k: usize| tape.video.recording[k][object].center.z;
    let highest = (start..=end).map(height).fold(f64::NEG_INFINITY, f64::max);
    let since = start.checked_sub(tape.during(SEEN_S));
    let was_seen = since.is_some_and(|since| (since..=start).all(|k| tape.is_in_image(k, object)));
    was_seen && height(start) - height(end) > FALL_M && highest - height(start) < FALL_M
}
