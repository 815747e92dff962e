//! How a long call runs: on threads of its own, without the interpreter, and Ctrl-C ends it.

use std::panic::{self, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use objecthood::{Observer, Output};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::ParameterError;

/// How often the interpreter is asked whether Ctrl-C was pressed. It also asks at once when a call ends, so short calls never wait for it.
const PATIENCE: Duration = Duration::from_millis(50);

/// The threads of a pipeline.
pub(crate) struct Threads {
    count: usize,
    pool: ThreadPool,
    /// The process that started them: a fork has none of them.
    process: u32,
}

impl Threads {
    /// So many threads, at most one a core; `None`: one a core.
    ///
    /// # Errors
    /// `ParameterError` for none, and when the system gives no threads.
    pub(crate) fn new(asked: Option<usize>) -> PyResult<Self> {
        if asked == Some(0) {
            return Err(ParameterError::new_err("threads = 0: give at least 1, or None for one a core"));
        }
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let count = asked.unwrap_or(cores).min(cores);
        let pool = ThreadPoolBuilder::new().num_threads(count).build();
        let pool = pool.map_err(|e| {
            ParameterError::new_err(format!("cannot start {count} threads ({e}): give fewer"))
        })?;
        Ok(Self { count, pool, process: std::process::id() })
    }

    /// Does `work` on these threads while the calling one waits. When Ctrl-C is pressed the work is asked to stop and the
    /// exception raised. Called without the interpreter.
    ///
    /// # Errors
    /// `KeyboardInterrupt`, or what a signal's handler raises.
    pub(crate) fn run<R: Send>(&mut self, work: impl FnOnce(&Stop) -> R + Send) -> PyResult<R> {
        if self.process != std::process::id() {
            // The pool of the parent cannot be ended here: its threads do not exist.
            std::mem::forget(std::mem::replace(self, Self::new(Some(self.count))?));
        }
        let stop = Stop::default();
        let (sender, ended) = mpsc::channel();
        let mut raised = None;
        let result = self.pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                // The receiver waits until this is sent.
                let _ = sender.send(panic::catch_unwind(AssertUnwindSafe(|| work(&stop))));
            });
            loop {
                if let Ok(result) = ended.recv_timeout(PATIENCE) {
                    return result;
                }
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    raised = Some(error);
                    stop.0.store(true, Ordering::Relaxed);
                }
            }
        });
        match (raised, result) {
            (Some(error), _) => Err(error),
            (None, Ok(result)) => Ok(result),
            (None, Err(panicked)) => panic::resume_unwind(panicked),
        }
    }
}

/// Asks work to stop.
#[derive(Default)]
pub(crate) struct Stop(AtomicBool);

/// Passes outputs on, and ends the run between two stages when it is asked to. It unwinds the stack, as nobody who waits for the result is left.
pub(crate) struct Stoppable<'a> {
    pub(crate) stop: &'a Stop,
    pub(crate) next: &'a mut dyn Observer,
}

impl Observer for Stoppable<'_> {
    fn observe(&mut self, output: Output<'_>) {
        self.next.observe(output);
        if self.stop.0.load(Ordering::Relaxed) {
            panic::resume_unwind(Box::new("stopped"));
        }
    }
}
