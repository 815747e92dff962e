//! All figures of a clip, and their sum over clips.

use std::ops::AddAssign;
use std::path::Path;

use serde::Serialize;

use super::airborne::AirborneCounts;
use super::clear::ClearCounts;
use super::clip::{Said, TrueClip};
use super::close::CloseSum;
use super::counts::Counts;
use super::edges::edge_counts;
use super::events::EventCounts;
use super::flicker::{FlickerCounter, FlickerCounts};
use super::frame::LabelledFrame;
use super::hota::HotaCounts;
use super::identity::IdentityCounts;
use super::kept::KeptCounts;
use super::overlap::{OverlapCounter, Overlaps};
use super::shows::Shows;
use crate::error::{Error, Result};

/// What the figures of a clip are made of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipScore {
    /// Number of frames.
    pub frames: usize,
    /// Finding and following.
    pub hota: HotaCounts,
    /// The right id.
    pub identity: IdentityCounts,
    /// Misses, switches, unbroken ids.
    pub clear: ClearCounts,
    /// %75.
    pub close: CloseSum,
    /// Pixels that change without reason.
    pub flicker: FlickerCounts,
    /// What was kept to the end.
    pub kept: KeptCounts,
    /// What happened; `None` when the tracker does not tell.
    pub events: Option<EventCounts>,
    /// What flew; `None` when the tracker tells no events.
    pub airborne: Option<AirborneCounts>,
    /// What stood on what; `None` when the tracker does not tell.
    pub support: Option<Counts>,
}

impl ClipScore {
    /// Reads a clip and what a tracker says of it, one frame after the other.
    ///
    /// # Errors
    /// As [`TrueClip::read`] and [`Said::read`]; [`Error::InScene`] when a frame cannot be scored.
    pub fn read(truth: &Path, tracks: &Path) -> Result<Self> {
        let (clip, said) = (TrueClip::read(truth)?, Said::read(tracks)?);
        let (mut overlaps, mut flicker) = (OverlapCounter::default(), FlickerCounter::default());
        for (k, frame) in clip.frames.iter().enumerate() {
            let (instances, tracks) = (clip.instances(k)?, said.tracks(frame)?);
            let roles = clip.roles(k, &instances);
            let labelled = LabelledFrame { tracks, instances };
            overlaps.add(&labelled, &roles).map_err(|error| {
                let scene = truth.join(format!("truth/{}.png", frame.stem)).display().to_string();
                Error::InScene { scene, error: Box::new(error) }
            })?;
            flicker.add(&labelled, &roles);
        }
        Self::of(&clip, &said, &overlaps.finish(), flicker.finish())
    }

    /// The figures of a clip whose frames have been counted.
    ///
    /// # Errors
    /// [`Error::TooManyRegions`] when there are more objects and tracks than memory should hold.
    pub fn of(clip: &TrueClip, said: &Said, overlaps: &Overlaps, flicker: FlickerCounts) -> Result<Self> {
        let shows = Shows::of(overlaps);
        let events = said.events.as_ref();
        Ok(Self {
            frames: overlaps.len(),
            hota: HotaCounts::of(overlaps),
            identity: IdentityCounts::of(overlaps)?,
            clear: ClearCounts::of(overlaps),
            close: CloseSum::of(overlaps),
            flicker,
            kept: KeptCounts::of(clip, &shows),
            events: events.map(|events| EventCounts::of(events, clip, &shows)),
            airborne: events.map(|events| AirborneCounts::of(events, clip, &shows)),
            support: said.edges.as_ref().map(|edges| edge_counts(edges, clip, &shows)),
        })
    }

    /// The figures.
    pub fn figures(&self) -> VideoFigures {
        let hota = self.hota.figures();
        let events = self.events.clone();
        VideoFigures {
            frames: self.frames,
            objects: self.clear.objects,
            hota: hota.map(|hota| hota.hota),
            det_a: hota.map(|hota| hota.det_a),
            ass_a: hota.map(|hota| hota.ass_a),
            owta: hota.and_then(|hota| hota.owta),
            idf1: self.identity.f1(),
            mota: self.clear.mota(),
            id_switches: self.clear.switches,
            interruptions: self.clear.interruptions,
            unbroken: self.clear.unbroken_share(),
            p75: self.close.mean(),
            flicker: self.flicker.share(),
            flicker_on_objects: self.flicker.share_on_objects(),
            kept: self.kept,
            all_events: events.as_ref().map(EventCounts::all),
            flights: events.as_ref().map(|events| events.of_kind(super::events::AIRBORNE)),
            events,
            airborne: self.airborne,
            support: self.support,
        }
    }
}

/// The figures of a clip, or of several. Shares are in [0, 1], and `null` in JSON where they are about nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VideoFigures {
    /// Number of frames.
    pub frames: usize,
    /// Number of objects; of several clips, their sum.
    pub objects: u64,
    /// HOTA.
    pub hota: Option<f64>,
    /// Its part of finding.
    pub det_a: Option<f64>,
    /// Its part of following.
    pub ass_a: Option<f64>,
    /// As HOTA, without punishment for what is found beside the objects.
    pub owta: Option<f64>,
    /// IDF1.
    pub idf1: Option<f64>,
    /// MOTA; may be negative.
    pub mota: Option<f64>,
    /// How often the track of an object changes.
    pub id_switches: u64,
    /// How often an object loses its track and has one again.
    pub interruptions: u64,
    /// Share of the objects that keep one id.
    pub unbroken: Option<f64>,
    /// %75: share of the objects of a frame that are close to what was found; mean over frames.
    pub p75: Option<f64>,
    /// Share of the pixels that change their track without reason, a frame.
    pub flicker: Option<f64>,
    /// The same of pixels on objects.
    pub flicker_on_objects: Option<f64>,
    /// What was kept to the end.
    pub kept: KeptCounts,
    /// Events of all kinds.
    pub all_events: Option<Counts>,
    /// Events by kind.
    pub events: Option<EventCounts>,
    /// Flights as intervals: the kind `airborne` of `events`.
    pub flights: Option<Counts>,
    /// Flights, frame by frame.
    pub airborne: Option<AirborneCounts>,
    /// Edges of support.
    pub support: Option<Counts>,
}

impl AddAssign<&Self> for ClipScore {
    /// What one of both does not tell is not told by the sum.
    fn add_assign(&mut self, other: &Self) {
        if self.frames == 0 {
            *self = other.clone();
            return;
        }
        self.frames += other.frames;
        self.hota += other.hota;
        self.identity += other.identity;
        self.clear += other.clear;
        self.close += other.close;
        self.flicker += other.flicker;
        self.kept += other.kept;
        self.events = self.events.take().zip(other.events.as_ref()).map(|(mut sum, events)| {
            sum += events;
            sum
        });
        self.airborne = sum(self.airborne, other.airborne);
        self.support = sum(self.support, other.support);
    }
}

fn sum<T: AddAssign>(a: Option<T>, b: Option<T>) -> Option<T> {
    a.zip(b).map(|(mut a, b)| {
        a += b;
        a
    })
}
