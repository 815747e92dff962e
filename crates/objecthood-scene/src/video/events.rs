//! What happened, read from the motion that came out; `docs/VIDEO_TRUTH.md` says in which frame an event lies.

mod flown;
mod handled;
mod parted;
mod sighted;
mod stayed;

use std::fmt;

use super::truth::{ClipTruth, Group};
use super::{Video, instance};

pub(super) use parted::groups;

/// What can happen to an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EventKind {
    /// It came into the image.
    Appeared,
    /// It went out of the image.
    Left,
    /// The other, an agent, lifted it.
    PickedUp,
    /// It was set down on the other; 0 = the table.
    PlacedOn,
    /// It came to lie in the other.
    PutIn,
    /// It lies in the other no more.
    TakenOut,
    /// The other, an agent, moved it without lifting it.
    Pushed,
    /// From start to end nothing but gravity acted on it.
    Airborne,
    /// After a flight it touched something.
    Landed,
    /// It left what held it and went down.
    Fell,
    /// From start to end the other hid it.
    Occluded,
    /// It moved apart from the other, with which it counted as one.
    Split,
    /// Its pieces, between which something stood, are seen as one.
    Merged,
    /// It, a lid or a drawer, moved apart from the other, which it closed.
    Opened,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Event {
    /// The frame in which it lies, from 0.
    pub frame: usize,
    /// The time of that (s).
    #[serde(rename = "time")]
    pub time_s: f64,
    /// What.
    #[serde(rename = "type")]
    pub kind: EventKind,
    /// Instance number of the object it happened to.
    pub object: u16,
    /// Instance number of who or what else had part in it; 0 = the table or other furniture.
    pub other: Option<u16>,
    /// First and last frame of what lasts.
    pub start: Option<usize>,
    /// See `start`.
    pub end: Option<usize>,
}

impl EventKind {
    /// Every kind there is.
    pub const ALL: [Self; 14] = [
        Self::Appeared,
        Self::Left,
        Self::PickedUp,
        Self::PlacedOn,
        Self::PutIn,
        Self::TakenOut,
        Self::Pushed,
        Self::Airborne,
        Self::Landed,
        Self::Fell,
        Self::Occluded,
        Self::Split,
        Self::Merged,
        Self::Opened,
    ];

    /// Its name, as in the files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Appeared => "appeared",
            Self::Left => "left",
            Self::PickedUp => "picked_up",
            Self::PlacedOn => "placed_on",
            Self::PutIn => "put_in",
            Self::TakenOut => "taken_out",
            Self::Pushed => "pushed",
            Self::Airborne => "airborne",
            Self::Landed => "landed",
            Self::Fell => "fell",
            Self::Occluded => "occluded",
            Self::Split => "split",
            Self::Merged => "merged",
            Self::Opened => "opened",
        }
    }
}

impl fmt::Display for EventKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What happened to the objects of a video, by frame, then by kind and object.
pub(super) fn events(video: &Video, truth: &ClipTruth) -> Vec<Event> {
    let tape = Tape { video, truth };
    let mut events = parted::events(&tape);
    for object in video.objects() {
        events.extend(handled::events(&tape, object));
        events.extend(stayed::events(&tape, object));
        events.extend(flown::events(&tape, object));
        events.extend(sighted::events(&tape, object));
    }
    events.sort_by_key(|event| (event.frame, event.kind, event.object));
    events
}

/// What events are read from.
struct Tape<'a> {
    video: &'a Video,
    truth: &'a ClipTruth,
}

impl Tape<'_> {
    fn frames(&self) -> usize {
        self.video.frames()
    }

    /// So many frames last this long, at least one.
    fn during(&self, time_s: f64) -> usize {
        (time_s * self.video.fps()).round().max(1.0) as usize
    }

    fn event(&self, kind: EventKind, frame: usize, object: usize, other: Option<u16>) -> Event {
        let time_s = self.video.time_s(frame);
        Event { frame, time_s, kind, object: instance(object), other, start: None, end: None }
    }

    /// How far the centre of a thing moved between two frames (m).
    fn moved_m(&self, object: usize, from: usize, to: usize) -> f64 {
        let center = |frame: usize| self.video.recording[frame][object].center;
        (center(to) - center(from)).length()
    }

    /// Whether it is a lid or a drawer or what these close.
    fn is_jointed(&self, object: usize) -> bool {
        let joins = |group: &&Group| group.joint == super::Joint::Closed;
        self.truth.groups.iter().filter(joins).any(|group| group.members.contains(&instance(object)))
    }

    /// The things that count as one with a thing in a frame, itself among them. The first of them names all.
    fn one_with(&self, frame: usize, object: usize) -> impl Iterator<Item = usize> {
        let groups = self.video.script.groups.iter().zip(&self.truth.groups);
        let mut closed = groups.filter(|(_, known)| known.apart_from.is_none_or(|apart| frame < apart));
        let group = closed.find(|(group, _)| group.members.contains(&object));
        group.map_or(vec![object], |(group, _)| group.members.clone()).into_iter()
    }

    fn is_in_image(&self, frame: usize, object: usize) -> bool {
        self.truth.seen(frame, object).alone_px > 0
    }
}

/// First and last index of every run of frames in which something holds.
fn runs(frames: usize, holds: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for k in (0..frames).filter(|&k| holds(k)) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == k => *last = k,
            _ => runs.push((k, k)),
        }
    }
    runs
}

/// The same with gaps of up to `gap` frames closed.
fn joined_runs(runs: Vec<(usize, usize)>, gap: usize) -> Vec<(usize, usize)> {
    let mut joined: Vec<(usize, usize)> = Vec::new();
    for (first, last) in runs {
        match joined.last_mut() {
            Some((_, end)) if first <= *end + gap + 1 => *end = last,
            _ => joined.push((first, last)),
        }
    }
    joined
}
