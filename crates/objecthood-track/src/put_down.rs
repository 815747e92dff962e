//! When, and on what, a lifted thing was put down.

use crate::happening::{Happening, Other};
use crate::pace::Pace;
use crate::scene::Key;
use crate::taken::UNSEEN_S;
use crate::track::{AS_WHOLE, Deed, Sample, Track};
use crate::tracked::{EventKind, Relation};

/// A thing is put down if no motion was found for this long (s).
pub(crate) const STILL_S: f64 = 0.3;
/// A thing lies as high as where it came to rest if its lowest point is within this height (m): a hand at its
/// foot disturbs the height by as much.
const DOWN_M: f64 = 0.010;
/// A thing that is put down while unseen is taken to be put down when one part in this many of the unseen
/// time is left,
const UNSEEN_PARTS: u64 = 3;
/// and at most this long (s) before it is seen again.
const UNSEEN_DOWN_S: f64 = 0.5;

/// Frame and time (s) at which a thing was put down after the frame `begun`: those of the sample that first
/// shows it down, minus a third of the time for which it was not seen before. (A hand carries a thing, then
/// lets it go.)
fn put_down_at(first_seen: &Sample, track: &Track, begun: u64, pace: Pace) -> (u64, f64) {
    let before = track.samples.iter().rev().find(|sample| sample.frame < first_seen.frame);
    let Some(before) = before.filter(|before| first_seen.stamp_s - before.stamp_s > UNSEEN_S) else {
        return first_seen.when();
    };
    let unseen = first_seen.frame - before.frame.max(begun).min(first_seen.frame);
    let earlier = (unseen / UNSEEN_PARTS).min(pace.frames(UNSEEN_DOWN_S) as u64);
    let frame_s = (first_seen.stamp_s - before.stamp_s) / (first_seen.frame - before.frame) as f64;
    (first_seen.frame - earlier, first_seen.stamp_s - earlier as f64 * frame_s)
}

/// Whether a thing of a size (m) lies where it came to rest. It lies no farther away than its size, because a
/// hand that hides part of it shifts its mean visible point. While a hand hides part of it, its motion counts
/// too.
fn is_down(sample: &Sample, rest: &Sample, size_m: f64) -> bool {
    let (apart, above) = ((sample.center - rest.center).length(), (sample.bottom_m - rest.bottom_m).abs());
    let is_whole = sample.px as f64 > AS_WHOLE * rest.px as f64;
    // A hand before the lower part of a thing does not lift its top.
    let is_above = (sample.bottom_m - rest.bottom_m).min(sample.top_m - rest.top_m) > DOWN_M;
    apart < size_m && (above < DOWN_M || !is_whole && !is_above && !sample.moves)
}

/// How a thing that was lifted after the frame `begun` came to rest, unless it was dropped.
pub(crate) fn put_down(key: Key, track: &mut Track, begun: u64, pace: Pace) -> Option<Happening> {
    let is_seen = track.last.frame > begun;
    if !is_seen || !track.is_still_for(STILL_S, pace.frame_s) || track.flew_since(begun) {
        return None;
    }
    // A hand that leaves may disturb a frame.
    let is_up = |sample: &Sample| !is_down(sample, &track.last, track.area_m2.sqrt());
    let recent = track.samples.iter().rev();
    let moved = recent.clone().zip(recent.skip(1)).find(|(later, earlier)| is_up(later) && is_up(earlier));
    let down = moved.map_or(begun, |(sample, _)| sample.frame.max(begun)) + 1;
    let at = put_down_at(track.since(down).next().unwrap_or(&track.last), track, begun, pace);
    let (kind, other) = match track.votes.winner() {
        Some((Some(vessel), Relation::In)) => (EventKind::PutIn, Other::Track(vessel)),
        Some((Some(below), _)) => (EventKind::PlacedOn, Other::Track(below)),
        _ => (EventKind::PlacedOn, Other::Ground),
    };
    track.note(Deed::PutDown);
    Some(Happening::at(at, key, kind, other, 0.85, "it rests again after it was lifted".to_owned()))
}
