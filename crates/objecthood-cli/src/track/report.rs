//! The report of `track`: frames with their tracks, where each track was, and what happened.

use std::path::Path;

use anyhow::Result;
use objecthood::{Params, Pipeline};
use objecthood_io::Capture;
use objecthood_io::output::Growing;
use objecthood_page::{Film, Page, Report, Shown};
use objecthood_track::{Event, Tracked};

use crate::shell::words_of_frames;

/// A report has at most so many frames of a video, evenly spread; all events are in it.
const MOST_FRAMES: usize = 100;

/// A report that is written while the video is followed.
pub(super) struct Filming {
    report: Report,
    /// Looks at the frames again, for the layers of the stages.
    pipeline: Pipeline,
    /// Frames of the video, and every so many one is shown.
    frames: usize,
    step: usize,
    film: Film,
}

impl Filming {
    /// Begins the report of a video of so many frames.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn begin(path: &Path, params: &Params, frames: usize) -> Result<Self> {
        Ok(Self {
            report: Report::begin(Growing::create(path)?, words_of_frames("track"), params)?,
            pipeline: Pipeline::default(),
            frames,
            step: frames.div_ceil(MOST_FRAMES).max(1),
            film: Film::default(),
        })
    }

    /// Takes in a frame, and shows it if it is one of those that are shown.
    ///
    /// # Errors
    /// As the method; when the file cannot be written.
    pub(super) fn frame(
        &mut self,
        number: usize,
        name: &str,
        params: &Params,
        capture: &Capture,
        tracked: &Tracked,
    ) -> Result<()> {
        self.film.take(tracked);
        if !number.is_multiple_of(self.step) {
            return Ok(());
        }
        let (number, frames) = (self.film.frames(), self.frames.div_ceil(self.step));
        self.film.show(tracked);
        let followed = Some((&tracked.labels, &self.film));
        let shown = Shown { name, capture, number, frames, laps: None, followed };
        Ok(self.report.add(&Page::new(&mut self.pipeline, params, &shown)?)?)
    }

    /// Ends the report; `late` became certain when the video ended.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn finish(mut self, late: &[Event]) -> Result<()> {
        late.iter().for_each(|event| self.film.tell(event));
        self.report.film(self.film);
        Ok(self.report.finish()?)
    }
}
