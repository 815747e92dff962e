//! Events: what was said to happen, against what happened.
//!
//! A statement is right when an event of its kind happened to the object that the track shows, at the same time: within 0.2 s,
//! or, if it is a flight, when both intervals overlap in at least half of what they cover together. Statements and events are
//! paired one to one. Ours.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

use serde::Serialize;

use super::clip::{Event, TrueClip};
use super::counts::{Cases, Counts};
use super::shows::Shows;
use crate::assignment::maximize;

/// Events this near in time may be the same (s).
const SAME_TIME_S: f64 = 0.2;
/// Times are written to a millionth (s).
const ROUNDING_S: f64 = 1e-5;
/// Flights may be the same when this share of the frames of either is in both.
const SAME_FLIGHT_IOU: f64 = 0.5;
/// The kind of flights.
pub(crate) const AIRBORNE: &str = "airborne";

/// Right, wrong and missed events by kind.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EventCounts {
    /// By the name of the kind.
    pub by_kind: BTreeMap<String, Counts>,
    /// Of the right events in which another object or the table had part, those that name it.
    pub other_named: Cases,
}

impl EventCounts {
    /// Pairs and counts. O(k t log f) to name k statements and events of tracks of f frames, and an assignment a kind.
    pub(crate) fn of(said: &[Event], clip: &TrueClip, shows: &Shows<'_>) -> Self {
        let mut counts = Self::default();
        let kinds: BTreeSet<&str> =
            said.iter().chain(&clip.events).map(|event| event.kind.as_str()).collect();
        for kind in kinds {
            let of_kind = |events: &'_ [Event]| -> Vec<Event> {
                events.iter().filter(|event| event.kind == kind).cloned().collect()
            };
            let (said, there) = (of_kind(said), of_kind(&clip.events));
            let alike = |(s, t): (&Event, &Event)| if is_of(s, t, shows) { alike(s, t, clip) } else { 0.0 };
            let values: Vec<f64> =
                said.iter().flat_map(|s| there.iter().map(move |t| alike((s, t)))).collect();
            let pairs = maximize(&values, said.len(), there.len());
            let mut right = 0;
            for (s, t) in pairs.into_iter().filter(|&(s, t)| values[s * there.len() + t] > 0.0) {
                right += 1;
                if let Some(is_named) = names_other(&said[s], &there[t], clip, shows) {
                    counts.other_named.add(is_named);
                }
            }
            let (wrong, missed) = (said.len() as u64 - right, there.len() as u64 - right);
            counts.by_kind.insert(kind.to_owned(), Counts { right, wrong, missed });
        }
        counts
    }

    /// Over all kinds.
    pub fn all(&self) -> Counts {
        self.by_kind.values().fold(Counts::default(), |mut sum, &counts| {
            sum += counts;
            sum
        })
    }

    /// Of one kind.
    pub fn of_kind(&self, kind: &str) -> Counts {
        self.by_kind.get(kind).copied().unwrap_or_default()
    }
}

/// Whether a statement is about the object of an event. What parts or becomes one is either of both.
fn is_of(said: &Event, there: &Event, shows: &Shows<'_>) -> bool {
    let is_shown = |track: u16, instance: u16| {
        shows.object_of(track, said.frame) == Some(shows.name_of(instance, said.frame))
    };
    let is_mutual = matches!(there.kind.as_str(), "split" | "merged");
    let other = there.other.filter(|&other| is_mutual && other > 0);
    is_shown(said.object, there.object) || other.is_some_and(|other| is_shown(said.object, other))
}

/// How near a statement and an event are, 0 when too far.
fn alike(said: &Event, there: &Event, clip: &TrueClip) -> f64 {
    if there.kind == AIRBORNE {
        let iou = interval_iou(interval(said), interval(there));
        return if iou >= SAME_FLIGHT_IOU { iou } else { 0.0 };
    }
    if said.frame.max(there.frame) >= clip.frames.len() {
        return 0.0;
    }
    let apart_s = clip.seconds(there.frame, said.frame).abs();
    // Every pair counts more than the nearness of any.
    if apart_s <= SAME_TIME_S + ROUNDING_S { 2.0 - apart_s / (2.0 * SAME_TIME_S) } else { 0.0 }
}

/// Whether a right statement names who or what else had part in it; `None` when nobody did, and for agents, who are not
/// tracked by their pixels.
fn names_other(said: &Event, there: &Event, clip: &TrueClip, shows: &Shows<'_>) -> Option<bool> {
    let other = there.other.filter(|other| *other == 0 || clip.objects.contains(other))?;
    let named = said.other.map(|track| match track {
        0 => Some(0),
        _ => shows.object_of(track, said.frame),
    });
    let name = |instance| shows.name_of(instance, said.frame);
    let is_mutual = matches!(there.kind.as_str(), "split" | "merged");
    let names = |instance: u16| named == Some(Some(if instance == 0 { 0 } else { name(instance) }));
    Some(names(other) || (is_mutual && names(there.object)))
}

/// First and last frame.
pub(crate) fn interval(event: &Event) -> (usize, usize) {
    (event.start.unwrap_or(event.frame), event.end.unwrap_or(event.frame))
}

fn interval_iou(a: (usize, usize), b: (usize, usize)) -> f64 {
    let frames = |first: usize, last: usize| (last + 1).saturating_sub(first) as f64;
    let both = frames(a.0.max(b.0), a.1.min(b.1));
    both / (frames(a.0, a.1) + frames(b.0, b.1) - both).max(1.0)
}

impl AddAssign<&Self> for EventCounts {
    fn add_assign(&mut self, other: &Self) {
        for (kind, &counts) in &other.by_kind {
            *self.by_kind.entry(kind.clone()).or_default() += counts;
        }
        self.other_named += other.other_named;
    }
}
