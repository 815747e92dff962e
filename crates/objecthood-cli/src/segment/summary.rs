//! What `segment --summary` tells of all frames together.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Result;
use objecthood_io::output;
use objecthood_io::scene::fingerprint;
use serde::Serialize;

use super::{Plan, Step};
use crate::inputs::Input;

/// Its name in the folder for outputs.
const NAME: &str = "summary.json";

/// How the frames of a run ended.
pub(super) struct Summary {
    start: Instant,
    counts: Counts,
    failures: Vec<Failure>,
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Counts {
    /// Frames that are done, now or before.
    done: usize,
    /// Those of them that an earlier run did.
    before: usize,
    failed: usize,
    /// In all frames that are done.
    objects: usize,
}

/// A frame that failed, or a file of which no frame could be made.
#[derive(Debug, Serialize)]
struct Failure {
    #[serde(skip_serializing_if = "Option::is_none")]
    source: Option<String>,
    error: String,
}

#[derive(Serialize)]
struct File<'a> {
    version: &'a str,
    parameters_fingerprint: String,
    /// All that were asked for.
    frames: usize,
    #[serde(flatten)]
    counts: Counts,
    seconds: f64,
    frames_per_second: f64,
    failures: &'a [Failure],
}

impl Summary {
    /// Of no frame, but files that hold none.
    pub(super) fn new(unreadable: &[anyhow::Error]) -> Self {
        let failures = unreadable.iter().map(|e| Failure { source: None, error: format!("{e:#}") });
        let counts = Counts { failed: unreadable.len(), ..Counts::default() };
        Self { start: Instant::now(), counts, failures: failures.collect() }
    }

    /// Adds a frame.
    pub(super) fn add(&mut self, input: &Input, step: Result<&Step, &anyhow::Error>) {
        let counts = &mut self.counts;
        match step {
            Ok(Step::Done(done)) => {
                counts.done += 1;
                counts.objects += done.objects.len();
            }
            Ok(Step::Before(objects)) => {
                counts.done += 1;
                counts.before += 1;
                counts.objects += objects;
            }
            Err(e) => {
                counts.failed += 1;
                self.failures.push(Failure {
                    source: Some(input.path.to_string_lossy().into_owned()),
                    error: format!("{e:#}"),
                });
            }
        }
    }

    /// Writes the file: where it is.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn write(&self, out: &Path, plan: &Plan<'_>) -> Result<PathBuf> {
        let seconds = self.start.elapsed().as_secs_f64();
        let file = File {
            version: env!("CARGO_PKG_VERSION"),
            parameters_fingerprint: fingerprint(&plan.params),
            frames: plan.inputs.frames.len() + plan.inputs.unreadable.len(),
            counts: self.counts,
            seconds,
            frames_per_second: (self.counts.done - self.counts.before) as f64 / seconds,
            failures: &self.failures,
        };
        let path = out.join(NAME);
        output::write_atomically(&path, (serde_json::to_string_pretty(&file)? + "\n").as_bytes())?;
        Ok(path)
    }
}
