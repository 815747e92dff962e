//! Runs a method and keeps the outputs of its stages. After a change, only the stages that depend on it run again.

use crate::buffers::Keeper;
use crate::discovery::Discovery;
use crate::error::Result;
use crate::frame::Frame;
use crate::method::{context, paper};
use crate::observe::Observer;
use crate::outputs::{ContextOutputs, PaperOutputs};
use crate::params::{Method, Params};

/// Finds the objects of frames, and keeps the outputs of all stages for the last frame.
///
/// * A stream of frames: each frame reuses the memory of the frame before. New memory from the system would cost about a tenth
///   of the time.
/// * One frame with other parameters: only the first stage that reads a changed parameter and the stages after it run again.
///   [`ParameterInfo::readers`](crate::ParameterInfo::readers) lists the first reader of each parameter.
///
/// The result never depends on earlier frames. A clone shares the outputs until one of the two gets another frame or other
/// parameters.
///
/// ```
/// # use objecthood::{Camera, Frame, Params, Pipeline, Raster};
/// # let camera = Camera::new(52.5, 52.5, 31.5, 23.5)?;
/// # let frame = Frame::new(Raster::filled(64, 48, 1.2)?, None, camera)?;
/// let mut pipeline = Pipeline::default();
/// let mut params = Params::default();
/// let found = pipeline.discover(&frame, &params)?;
/// assert!(found.objects.is_empty());
///
/// params.objectness.threshold = 0.4;
/// let found_again = pipeline.discover(&frame, &params)?; // only the last stage runs
/// # assert!(found_again.objects.is_empty());
/// # Ok::<(), objecthood::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Pipeline {
    last: Option<Last>,
    /// The last field, hence dropped last: the images of the outputs go back to the kept buffers before.
    _buffers: Keeper,
}

/// The last frame, with its parameters and outputs.
#[derive(Clone, Debug)]
struct Last {
    frame: Frame,
    params: Params,
    outputs: Outputs,
}

/// The outputs of a method.
#[derive(Clone, Debug)]
enum Outputs {
    Context(ContextOutputs),
    Paper(PaperOutputs),
}

impl Pipeline {
    /// As [`discover`](crate::discover). A stage does not run again when its inputs are unchanged since the last call: the frame is
    /// the same or a clone of it, and neither this stage nor an earlier one reads a changed parameter.
    ///
    /// # Errors
    /// As [`discover`](crate::discover).
    pub fn discover(&mut self, frame: &Frame, params: &Params) -> Result<&Discovery> {
        self.discover_observed(frame, params, &mut ())
    }

    /// As [`Self::discover`]; also shows the output of every stage to `observer`, whether the stage ran again or not.
    ///
    /// # Errors
    /// As [`discover`](crate::discover).
    pub fn discover_observed(
        &mut self,
        frame: &Frame,
        params: &Params,
        observer: &mut dyn Observer,
    ) -> Result<&Discovery> {
        params.validate()?;
        let outputs = self.last.take().and_then(|last| last.still_valid(frame, params));
        let outputs = outputs.unwrap_or_else(|| Outputs::none(params.method));
        let last = self.last.insert(Last { frame: frame.clone(), params: params.clone(), outputs });
        match &mut last.outputs {
            Outputs::Context(outputs) => context(frame, params, outputs, observer),
            Outputs::Paper(outputs) => paper(frame, params, outputs, observer),
        }
    }

    /// Drops the last frame and its outputs. The memory of the outputs is kept for the next frame of any pipeline in the process, until the
    /// last pipeline is dropped.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// The outputs of `context`; `None` before the first frame or after another method.
    pub(crate) fn context_outputs(&self) -> Option<&ContextOutputs> {
        match &self.last.as_ref()?.outputs {
            Outputs::Context(outputs) => Some(outputs),
            Outputs::Paper(_) => None,
        }
    }
}

impl Last {
    /// The outputs that are still valid for this frame and these parameters; `None` when none is.
    fn still_valid(self, frame: &Frame, params: &Params) -> Option<Outputs> {
        if !self.frame.is_clone_of(frame) || self.params.method != params.method {
            return None;
        }
        let mut outputs = self.outputs;
        if let Some(stage) = self.params.first_reader_of_change(params, params.method) {
            match &mut outputs {
                Outputs::Context(outputs) => outputs.forget_from(stage),
                Outputs::Paper(outputs) => outputs.forget_from(stage),
            }
        }
        Some(outputs)
    }
}

impl Outputs {
    fn none(method: Method) -> Self {
        match method {
            Method::Context => Self::Context(ContextOutputs::default()),
            Method::Paper => Self::Paper(PaperOutputs::default()),
        }
    }
}
