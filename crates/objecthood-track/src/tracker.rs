//! The tracker.

use std::collections::BTreeSet;

use objecthood::{Discovery, Estimates, Frame, Params, Pipeline};

use crate::doubtful::Doubtful;
use crate::error::Result;
use crate::ingredient::Ingredient;
use crate::memory::Memory;
use crate::numbering::Numbering;
use crate::rigid::Rigid;
use crate::tracked::{Event, TrackNotice, Tracked};
use crate::view::View;

/// Follows objects through a video. It is the only type that remembers earlier frames.
///
/// Memory: about 40 bytes a pixel, and 20 kB and at most 1 MB of surface a track. Confirmed tracks are
/// forgotten after 30 s if something hides them, and after 5 s if they are not seen for another reason.
#[derive(Debug)]
pub struct Tracker {
    params: Params,
    pipeline: Pipeline,
    pub(crate) without: BTreeSet<Ingredient>,
    pub(crate) estimates: Option<Estimates>,
    pub(crate) memory: Option<Memory>,
    pub(crate) numbering: Numbering,
}

impl Tracker {
    /// A new tracker. `params`: those of the discovery.
    pub fn new(params: Params) -> Self {
        let (pipeline, without, numbering) = (Pipeline::default(), BTreeSet::new(), Numbering::default());
        Self { params, pipeline, without, estimates: None, memory: None, numbering }
    }

    /// The same tracker without some of its ingredients, to measure what each gains. Without all of them,
    /// tracks are paired with objects by their overlap with the last frame alone.
    #[must_use]
    pub fn without(mut self, ingredients: impl IntoIterator<Item = Ingredient>) -> Self {
        self.without.extend(ingredients);
        self
    }

    /// Forgets everything. Numbers begin at 1 again.
    pub fn reset(&mut self) {
        (self.memory, self.estimates, self.numbering) = (None, None, Numbering::default());
    }

    /// Passes over a frame that could not be read or shows nothing. The frame is counted, but not processed.
    pub fn skip(&mut self) {
        self.numbering.skip();
    }

    /// Processes the next frame: finds its objects and follows them. `stamp_s`: when it was taken; stamps
    /// have to rise. `pose`: maps points of the camera to the world, if that is known; otherwise the camera's
    /// motion is estimated. Estimates of noise and up are handed on from frame to frame.
    ///
    /// # Errors
    /// As [`Pipeline::discover`]; [`Error::Stamp`](crate::Error::Stamp) if the stamp does not rise. The frame
    /// is then not counted.
    pub fn update(&mut self, frame: &Frame, stamp_s: f64, pose: Option<Rigid>) -> Result<Tracked> {
        // This is done before the objects are found, which changes the estimates.
        crate::error::check_stamp(stamp_s, self.last_stamp_s())?;
        let mut pipeline = std::mem::take(&mut self.pipeline);
        let known = frame.clone().with_estimates(self.estimates);
        let mut doubtful = Doubtful::new(&self.params);
        let found = pipeline.discover_observed(&known, &self.params, &mut doubtful);
        let hypotheses = doubtful.hypotheses;
        let tracked = found.map_err(Into::into).and_then(|found| {
            self.estimates = found.estimates.or(self.estimates);
            self.follow(frame, (found, &hypotheses), stamp_s, pose)
        });
        self.pipeline = pipeline;
        tracked
    }

    /// As [`Self::update`], with objects from any source. Known things are not searched among refused
    /// hypotheses.
    ///
    /// # Errors
    /// [`Error::Stamp`](crate::Error::Stamp) when the stamp does not rise, [`Error::Size`](crate::Error::Size) when the labels have another size than the
    /// frame.
    pub fn update_found(
        &mut self,
        frame: &Frame,
        found: &Discovery,
        stamp_s: f64,
        pose: Option<Rigid>,
    ) -> Result<Tracked> {
        self.follow(frame, (found, &[]), stamp_s, pose)
    }

    /// Follows the objects of a frame, and known things among the refused hypotheses.
    fn follow(
        &mut self,
        frame: &Frame,
        (found, doubtful): (&Discovery, &[Vec<usize>]),
        stamp_s: f64,
        pose: Option<Rigid>,
    ) -> Result<Tracked> {
        crate::error::check_stamp(stamp_s, self.last_stamp_s())?;
        crate::error::check_labels(frame, found)?;
        let noise =
            found.estimates.map_or(1.0, |estimates| estimates.noise.white.max(estimates.noise.waves()));
        let mut view = View::of(frame, (noise as f32).clamp(1.0, 5.0)).with_planes(found);
        let (mut notices, mut ended) = (Vec::new(), Vec::new());
        if self.memory.as_ref().is_some_and(|memory| memory.scene.size() != view.size) {
            notices.push(TrackNotice::OtherSize);
            ended = self.finish();
            self.numbering.begin_anew();
            let numbers = self.memory.take().map(|memory| memory.numbers);
            let fresh = Memory::new(view.size, stamp_s, self.without.clone());
            self.memory = Some(Memory { numbers: numbers.unwrap_or_default().without_agents(), ..fresh });
        }
        let memory = self.memory.get_or_insert_with(|| Memory::new(view.size, stamp_s, self.without.clone()));
        view.field = memory.fields.widen(view.field, stamp_s);
        self.numbering.take(memory.frame);
        let mut tracked = memory.update(&view, (found, doubtful), stamp_s, pose, notices);
        self.number(&mut tracked.events);
        tracked.frame = self.numbering.of(tracked.frame);
        tracked.events.splice(0..0, ended);
        Ok(tracked)
    }

    fn last_stamp_s(&self) -> Option<f64> {
        self.memory.as_ref().map(|memory| memory.stamp_s)
    }

    /// Events that become certain when the video ends.
    pub fn finish(&mut self) -> Vec<Event> {
        let mut events = self.memory.as_mut().map_or_else(Vec::new, Memory::finish);
        self.number(&mut events);
        events
    }

    /// Gives events the numbers of the frames that were given.
    fn number(&self, events: &mut [Event]) {
        for event in events {
            event.frame = self.numbering.of(event.frame);
            (event.start, event.end) = (
                event.start.map(|frame| self.numbering.of(frame)),
                event.end.map(|frame| self.numbering.of(frame)),
            );
        }
    }
}
