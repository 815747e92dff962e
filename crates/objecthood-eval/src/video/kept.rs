//! What motion has shown, and whether it is kept to the end.
//!
//! A case is judged from one second after the frame in which the truth shows it. It is right when the last frame is, and at least
//! 0.8 of the frames are, with the same tracks as in the last. Frames in which not all of its things are seen are passed over; a
//! case without frames is none. Ours.

use std::ops::AddAssign;

use serde::Serialize;

use super::clear::MOSTLY;
use super::clip::{Group, Joint, TrueClip};
use super::counts::Cases;
use super::shows::Shows;

/// So long after it was shown, a tracker has to know (s).
const GRACE_S: f64 = 1.0;
/// What was hidden at least this long has to keep its id (s).
const LONG_HIDDEN_S: f64 = 2.0;
/// The track of what was hidden is the one that shows it most in this time (s).
const RETURN_S: f64 = 1.0;

/// What was kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct KeptCounts {
    /// Flush things that moved apart: a track each.
    pub split: Cases,
    /// Lids and drawers that moved away from what they close: a track each.
    pub opened: Cases,
    /// Things that count as one and never part: one track alone.
    pub together: Cases,
    /// Objects that were cut in pieces by what stood before them and are seen whole: one track alone.
    pub merged: Cases,
    /// Objects that were hidden for at least 2 s: the same track as before.
    pub returned: Cases,
}

impl KeptCounts {
    /// Counts. O(c f) for c cases in f frames.
    pub(crate) fn of(clip: &TrueClip, shows: &Shows<'_>) -> Self {
        let mut counts = Self::default();
        for group in &clip.groups {
            let (cases, from) = match (group.apart_from, group.joint) {
                (None, _) => (&mut counts.together, 0),
                (Some(apart), Joint::Flush) => (&mut counts.split, apart),
                (Some(apart), Joint::Closed) => (&mut counts.opened, apart),
            };
            let is_right = match group.apart_from {
                None => is_kept(clip, from, |k| one_track(shows, group.members[0], k)),
                Some(_) => is_kept(clip, from, |k| own_tracks(shows, group, k)),
            };
            if let Some(is_right) = is_right {
                cases.add(is_right);
            }
        }
        for event in clip.events.iter().filter(|event| event.kind == "merged") {
            if let Some(is_right) = is_kept(clip, event.frame, |k| one_track(shows, event.object, k)) {
                counts.merged.add(is_right);
            }
        }
        for event in clip.events.iter().filter(|event| event.kind == "occluded") {
            let (first, last) = super::events::interval(event);
            let is_long = last < clip.frames.len() && clip.seconds(first, last) >= LONG_HIDDEN_S;
            if is_long && let Some(is_right) = returned(clip, shows, event.object, (first, last)) {
                counts.returned.add(is_right);
            }
        }
        counts
    }
}

/// What is there in a frame: `None` where the things are not seen, `Some(None)` where it is wrong.
type State<T> = Option<Option<T>>;

/// Whether what is right is kept from a frame on; `None` without frames to judge.
fn is_kept<T: PartialEq>(clip: &TrueClip, from: usize, state: impl Fn(usize) -> State<T>) -> Option<bool> {
    let after = (from..clip.frames.len()).filter(|&k| clip.seconds(from, k) >= GRACE_S);
    let states: Vec<Option<T>> = after.filter_map(state).collect();
    let last = states.last()?;
    let alike = states.iter().filter(|state| *state == last).count();
    Some(last.is_some() && alike as f64 >= MOSTLY * states.len() as f64)
}

/// The tracks of the members, if each has its own.
fn own_tracks(shows: &Shows<'_>, group: &Group, frame: usize) -> State<Vec<u16>> {
    if !group.members.iter().all(|&member| shows.is_seen(member, frame)) {
        return None;
    }
    let tracks: Option<Vec<u16>> =
        group.members.iter().map(|&member| shows.track_of(member, frame)).collect();
    Some(tracks.filter(|tracks| (1..tracks.len()).all(|k| !tracks[..k].contains(&tracks[k]))))
}

fn one_track(shows: &Shows<'_>, instance: u16, frame: usize) -> State<u16> {
    shows.is_seen(instance, frame).then(|| shows.only_track_of(instance, frame))
}

/// Whether a thing comes back under the track that showed it last before it was hidden; `None` when it does not come back.
fn returned(clip: &TrueClip, shows: &Shows<'_>, object: u16, (first, last): (usize, usize)) -> Option<bool> {
    let back = (last + 1..clip.frames.len()).find(|&k| shows.is_seen(object, k))?;
    let before = (0..first).rev().find_map(|k| shows.track_of(object, k));
    let second = (back..clip.frames.len()).take_while(|&k| clip.seconds(back, k) < RETURN_S);
    let seen: Vec<usize> = second.filter(|&k| shows.is_seen(object, k)).collect();
    let same = seen.iter().filter(|&&k| before.is_some() && shows.track_of(object, k) == before).count();
    Some(2 * same > seen.len())
}

impl AddAssign for KeptCounts {
    fn add_assign(&mut self, other: Self) {
        self.split += other.split;
        self.opened += other.opened;
        self.together += other.together;
        self.merged += other.merged;
        self.returned += other.returned;
    }
}
