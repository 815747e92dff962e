//! Appeared, left, occluded, merged.

use super::{Event, EventKind, Tape, joined_runs, runs};
use crate::video::instance;
use crate::video::sight::hider;

/// A thing has appeared when it is seen in so many pixels of an image of 160 x 120.
const APPEARED_PX: u32 = 10;
/// A thing is hidden when less than this share of it is seen, after more than the other was.
const HIDDEN: f64 = 0.1;
const OPEN: f64 = 0.5;
/// For less than this (s) nothing is hidden, nor seen whole.
const BRIEF_S: f64 = 0.1;
/// A thing that was seen in pieces stays whole for this (s).
const WHOLE_S: f64 = 0.3;

pub(super) fn events(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    let mut events = passages(tape, object);
    events.extend(occlusions(tape, object));
    events.extend(merged(tape, object));
    events
}

/// Through the border of the image.
fn passages(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    let inside = joined_runs(runs(tape.frames(), |k| tape.is_in_image(k, object)), tape.during(BRIEF_S));
    let mut events = Vec::new();
    for (first, last) in inside {
        let seen = (first..=last).find(|&k| tape.truth.seen(k, object).seen_px >= APPEARED_PX);
        let Some(appeared) = seen else { continue };
        if first > 0 {
            events.push(tape.event(EventKind::Appeared, appeared, object, None));
        }
        if last + 1 < tape.frames() {
            events.push(tape.event(EventKind::Left, last + 1, object, None));
        }
    }
    events
}

fn occlusions(tape: &Tape<'_>, object: usize) -> Vec<Event> {
    let share = |k: usize| {
        let seen = tape.one_with(k, object).map(|part| tape.truth.seen(k, part));
        let (seen_px, alone_px) = seen.fold((0, 0), |(a, b), seen| (a + seen.seen_px, b + seen.alone_px));
        f64::from(seen_px) / f64::from(alone_px.max(1))
    };
    let names = |k: usize| tape.one_with(k, object).next() == Some(object);
    let is_hidden = |k: usize| names(k) && tape.is_in_image(k, object) && share(k) < HIDDEN;
    let mut events = Vec::new();
    for (start, end) in runs(tape.frames(), is_hidden) {
        let was_open = (0..start).any(|k| share(k) >= OPEN);
        if was_open && end + 1 - start >= tape.during(BRIEF_S) {
            let by = hider(&tape.video.world(start), instance(object));
            let event = tape.event(EventKind::Occluded, start, object, Some(by));
            events.push(Event { start: Some(start), end: Some(end), ..event });
        }
    }
    events
}

/// When a thing that was cut in pieces from the first is seen whole.
fn merged(tape: &Tape<'_>, object: usize) -> Option<Event> {
    let pieces = |k: usize| tape.truth.seen(k, object).pieces;
    let is_cut = (0..tape.during(BRIEF_S).min(tape.frames())).all(|k| pieces(k) > 1);
    let whole = runs(tape.frames(), |k| pieces(k) == 1);
    let stays = |(first, last): &&(usize, usize)| last - first >= tape.during(WHOLE_S);
    let (first, _) = whole.iter().find(stays).filter(|_| is_cut)?;
    Some(tape.event(EventKind::Merged, *first, object, None))
}
