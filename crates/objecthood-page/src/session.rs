//! What a page is about.

use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use objecthood::{Method, ParameterInfo, Params, Stage};
use objecthood_io::Capture;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::settings::Settings;

type ReadFrame = Box<dyn Fn() -> Result<Capture, String> + Send + Sync>;

/// A frame that can be read.
pub struct FrameSource {
    /// The file, as the user would name it.
    pub name: String,
    read: ReadFrame,
}

impl FrameSource {
    /// A frame that `read` reads, as often as it is called; its error is a line for people.
    pub fn new(name: String, read: impl Fn() -> Result<Capture, String> + Send + Sync + 'static) -> Self {
        Self { name, read: Box::new(read) }
    }
}

/// The frames of a session, in order. Those of a stream are added while the page is shown.
pub struct FrameList {
    frames: RwLock<Vec<Arc<FrameSource>>>,
    /// Of a stream, how many frames are kept, the last ones.
    kept: Option<usize>,
}

impl FrameList {
    /// Frames that are known.
    pub fn of(frames: Vec<FrameSource>) -> Self {
        Self { frames: RwLock::new(frames.into_iter().map(Arc::new).collect()), kept: None }
    }

    /// A stream, of which the last `kept` frames can be read.
    pub fn stream(kept: usize) -> Self {
        Self { frames: RwLock::default(), kept: Some(kept) }
    }

    /// Adds a frame behind the others. Of a stream, the oldest one that was kept can be read no longer.
    pub fn push(&self, frame: FrameSource) {
        // A push that a panic cut off leaves the list as it was.
        let mut frames = self.frames.write().unwrap_or_else(PoisonError::into_inner);
        frames.push(Arc::new(frame));
        let forgotten = self.kept.and_then(|kept| frames.len().checked_sub(kept + 1));
        if let (Some(place), Some(kept)) = (forgotten, self.kept) {
            let gone =
                move || Err(format!("this frame is gone: the last {kept} frames of a stream are kept"));
            frames[place] = Arc::new(FrameSource::new(frames[place].name.clone(), gone));
        }
    }

    /// A frame.
    ///
    /// # Errors
    /// [`Error::NoFrame`].
    pub(crate) fn get(&self, frame: usize) -> Result<Arc<FrameSource>> {
        let frames = self.all();
        let last = frames.len().saturating_sub(1);
        frames.get(frame).cloned().ok_or(Error::NoFrame { frame, last })
    }

    fn all(&self) -> RwLockReadGuard<'_, Vec<Arc<FrameSource>>> {
        self.frames.read().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The frames, the parameters to begin with, and what the page says of them.
pub struct Session {
    /// What is looked at, in a few words.
    pub title: String,
    /// The words of a command line that name the frames, for "copy as command line".
    pub words: Vec<String>,
    /// The frames.
    pub frames: Arc<FrameList>,
    /// The parameters to begin with.
    pub params: Params,
}

/// What the page is told once, when it is opened.
#[derive(Serialize)]
pub(crate) struct Greeting<'a> {
    version: &'static str,
    title: &'a str,
    words: &'a [String],
    frames: Vec<String>,
    /// Whether more frames come.
    grows: bool,
    settings: Settings,
    parameters: Vec<Parameter>,
}

/// A line of the table of parameters, as the page needs it.
#[derive(Serialize)]
struct Parameter {
    #[serde(flatten)]
    info: ParameterInfo,
    /// The least and the greatest value of a number.
    limits: Option<(f64, f64)>,
    /// Whether a number has no digits behind the point.
    is_whole: bool,
    choices: Vec<String>,
    /// The first stage that reads it, of `context` and of `paper`.
    stages: [Option<Stage>; 2],
}

impl<'a> Greeting<'a> {
    /// # Errors
    /// [`Error::Json`].
    pub(crate) fn new(
        title: &'a str,
        words: &'a [String],
        (frames, grows): (Vec<String>, bool),
        params: &Params,
    ) -> Result<Self> {
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            title,
            words,
            frames,
            grows,
            settings: Settings::of(params)?,
            parameters: Params::table().into_iter().map(Parameter::from).collect(),
        })
    }
}

impl Session {
    /// Reads a frame.
    ///
    /// # Errors
    /// [`Error::NoFrame`], [`Error::Unreadable`].
    pub fn read(&self, frame: usize) -> Result<Capture> {
        (self.frames.get(frame)?.read)().map_err(Error::Unreadable)
    }

    /// # Errors
    /// [`Error::Json`].
    pub(crate) fn greeting(&self) -> Result<Greeting<'_>> {
        let frames = self.frames.all().iter().map(|frame| frame.name.clone()).collect();
        Greeting::new(&self.title, &self.words, (frames, self.frames.kept.is_some()), &self.params)
    }
}

impl From<ParameterInfo> for Parameter {
    fn from(info: ParameterInfo) -> Self {
        let limits = info.limits();
        let takes = |number: f64| Params::default().with_number(&info.name, number).is_some();
        let is_whole = limits.is_some_and(|(least, _)| takes(least + 1.0) && !takes(least + 0.5));
        let choices = info.choices().into_iter().map(str::to_owned).collect();
        let stages = [Method::Context, Method::Paper].map(|method| info.first_stage(method));
        Self { limits, is_whole, choices, stages, info }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_stream_the_last_frames_can_be_read() {
        let stream = FrameList::stream(2);
        for name in ["a", "b", "c"] {
            stream.push(FrameSource::new(name.to_owned(), || Err("read".to_owned())));
        }
        let said = |k: usize| (stream.get(k).unwrap().read)().unwrap_err();
        assert!(said(0).contains("the last 2 frames"), "{}", said(0));
        assert_eq!([said(1), said(2)], ["read", "read"]);
        assert!(matches!(stream.get(3), Err(Error::NoFrame { frame: 3, last: 2 })));
    }
}
