//! Events before tracks have their numbers.

use serde::{Deserialize, Serialize};

use crate::scene::Key;
use crate::tracked::EventKind;

/// Who or what took part in an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Other {
    Nobody,
    /// The table, the floor, furniture.
    Ground,
    Track(Key),
    Agent(u32),
}

/// An event, before tracks have their numbers.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Happening {
    pub(crate) frame: u64,
    pub(crate) time_s: f64,
    pub(crate) kind: EventKind,
    pub(crate) object: Key,
    pub(crate) other: Other,
    pub(crate) span: Option<(u64, u64)>,
    pub(crate) confidence: f32,
    pub(crate) evidence: String,
}

impl Happening {
    /// What happened to a thing in a frame, and when (s).
    pub(crate) fn at(
        (frame, time_s): (u64, f64),
        object: Key,
        kind: EventKind,
        other: Other,
        confidence: f32,
        evidence: String,
    ) -> Self {
        Self { frame, time_s, kind, object, other, span: None, confidence, evidence }
    }
}
