//! A stream of frames: buffers and outputs stay from one to the next.

use std::sync::{Arc, Mutex, PoisonError};

use objecthood::Params;
use pyo3::prelude::*;

use crate::capture::Capture;
use crate::errors::core;
use crate::estimates::Estimates;
use crate::found::Found;
use crate::parameters::{parse, to_json};
use crate::run::{Stoppable, Threads};

/// Finds the objects of frames, and keeps the outputs of all stages for the last one.
#[pyclass(frozen, module = "objecthood._native")]
pub(crate) struct Pipeline {
    state: Mutex<State>,
}

struct State {
    pipeline: objecthood::Pipeline,
    params: Arc<Params>,
    threads: Threads,
    /// The last frame.
    last: Option<(Arc<objecthood_io::Capture>, String)>,
}

#[pymethods]
impl Pipeline {
    /// With parameters in JSON, on so many threads.
    #[new]
    #[pyo3(signature = (params, threads))]
    fn new(params: &str, threads: Option<usize>) -> PyResult<Self> {
        let (params, threads) = (Arc::new(parse(params)?), Threads::new(threads)?);
        let state = State { pipeline: objecthood::Pipeline::default(), params, threads, last: None };
        Ok(Self { state: Mutex::new(state) })
    }

    /// Finds the objects of a frame, by what earlier frames told, if that is given.
    #[pyo3(signature = (capture, estimates))]
    fn discover(&self, py: Python<'_>, capture: &Capture, estimates: Option<&Estimates>) -> PyResult<Found> {
        let known = capture.with_estimates(estimates.map(|earlier| earlier.inner));
        let frame = (known.inner, known.source);
        py.detach(|| {
            // A lock is poisoned by a mistake of ours; the pipeline itself is whole all the same.
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.last = Some(frame);
            state.look()
        })
    }

    /// Takes other parameters, in JSON; looks at the last frame again, if there is one.
    fn set(&self, py: Python<'_>, params: &str) -> PyResult<Option<Found>> {
        let params = Arc::new(parse(params)?);
        py.detach(|| {
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            state.params = params;
            state.last.is_some().then(|| state.look()).transpose()
        })
    }

    /// The parameters in force, in JSON.
    #[getter]
    fn params(&self, py: Python<'_>) -> PyResult<String> {
        let params = py.detach(|| {
            let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(&state.params)
        });
        to_json(&params)
    }
}

impl State {
    /// Looks at the last frame. Called without the interpreter.
    fn look(&mut self) -> PyResult<Found> {
        let Self { pipeline, params, threads, last } = self;
        let (capture, source) = last.clone().unwrap_or_else(|| unreachable!("no frame was handed over"));
        let discovered = threads.run(|stop| {
            let mut observer = Stoppable { stop, next: &mut () };
            pipeline.discover_observed(&capture.frame, params, &mut observer).cloned()
        });
        let discovery = discovered.inspect_err(|_| pipeline.forget())?.map_err(core)?;
        Ok(Found { capture, source, params: Arc::clone(params), discovery })
    }
}
