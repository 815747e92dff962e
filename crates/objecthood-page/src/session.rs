//! What a page is about.

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

/// The frames, the parameters to begin with, and what the page says of them.
pub struct Session {
    /// What is looked at, in a few words.
    pub title: String,
    /// The words of a command line that name the frames, for "copy as command line".
    pub words: Vec<String>,
    /// The frames, in order.
    pub frames: Vec<FrameSource>,
    /// The parameters to begin with.
    pub params: Params,
}

/// What the page is told once, when it is opened.
#[derive(Serialize)]
pub(crate) struct Greeting<'a> {
    version: &'static str,
    title: &'a str,
    words: &'a [String],
    frames: Vec<&'a str>,
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
        frames: Vec<&'a str>,
        params: &Params,
    ) -> Result<Self> {
        Ok(Self {
            version: env!("CARGO_PKG_VERSION"),
            title,
            words,
            frames,
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
        let last = self.frames.len().saturating_sub(1);
        let source = self.frames.get(frame).ok_or(Error::NoFrame { frame, last })?;
        (source.read)().map_err(Error::Unreadable)
    }

    /// # Errors
    /// [`Error::Json`].
    pub(crate) fn greeting(&self) -> Result<Greeting<'_>> {
        let frames = self.frames.iter().map(|frame| frame.name.as_str()).collect();
        Greeting::new(&self.title, &self.words, frames, &self.params)
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
