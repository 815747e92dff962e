//! When a thing was taken that a hand hid, and what is reported about it.

use crate::happening::{Happening, Other};
use crate::scene::Key;
use crate::support::Parent;
use crate::track::{AS_WHOLE, Rest, Sample, Track};
use crate::tracked::{EventKind, Relation};

/// A thing that a hand hid for this long (s), and that then rests this far away (m), was carried.
pub(crate) const UNSEEN_S: f64 = 0.2;
pub(crate) const CARRIED_M: f64 = 0.05;

/// The event of a thing lifted by an agent in a frame, at a time (s), out of the vessel that held it.
pub(crate) fn picked_up(
    key: Key,
    at: (u64, f64),
    agent: u32,
    held_by: Option<(Parent, Relation)>,
    confidence: f32,
    evidence: String,
) -> Vec<Happening> {
    let mut lift =
        vec![Happening::at(at, key, EventKind::PickedUp, Other::Agent(agent), confidence, evidence)];
    if let Some((Some(vessel), Relation::In)) = held_by {
        let evidence = "it lay in it before it was lifted".to_owned();
        lift.push(Happening::at(at, key, EventKind::TakenOut, Other::Track(vessel), confidence, evidence));
    }
    lift
}

/// Frame and time (s) at which a thing was taken that was hidden and is far away now: midway between when it
/// was last seen and when its place was bare. If nobody saw its place bare: when it was last seen. `None` if
/// it was not taken.
pub(crate) fn taken_unseen(track: &Track, before: Rest) -> Option<(u64, f64)> {
    // A thing that the border cuts seems to move when a hand hides part of it.
    let is_far = (track.last.center - before.center).length() > CARRIED_M && !track.last.at_border;
    let seen: Vec<&Sample> = track.since(before.frame).collect();
    let hidden_s = |pair: &&[&Sample]| pair[1].stamp_s - pair[0].stamp_s;
    let longest = seen.windows(2).max_by(|a, b| hidden_s(a).total_cmp(&hidden_s(b)))?;
    let hidden = longest[0].frame..longest[1].frame;
    let gone = track.gone_since.filter(|(frame, _)| hidden.contains(frame));
    // A thing that lies farther away, or on another face than before, shows fewer pixels.
    let is_whole = gone.is_some() || track.last.px as f64 > AS_WHOLE * before.px as f64;
    let taken = gone.map_or(longest[0].when(), |gone| taken_at(longest[0], gone));
    (is_far && is_whole && hidden_s(&longest) > UNSEEN_S).then_some(taken)
}

/// Frame and time (s) at which a thing was taken while nobody saw it: midway between when it was last seen
/// and when its place was bare.
pub(crate) fn taken_at(last_seen: &Sample, (bare, bare_s): (u64, f64)) -> (u64, f64) {
    (u64::midpoint(last_seen.frame, bare), f64::midpoint(last_seen.stamp_s, bare_s))
}
