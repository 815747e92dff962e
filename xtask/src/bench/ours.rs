//! Our own programs: `measure` for what happens within a frame, `objecthood` for what a user waits for.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use wait4::Wait4;

use super::figures::Figures;
use crate::house::{House, METHODS, output};

/// Both programs, and where what they write goes.
pub(crate) struct Program {
    measure: PathBuf,
    objecthood: PathBuf,
    peer: PathBuf,
    out: PathBuf,
}

/// What a process took.
pub(crate) struct Taken {
    /// On the wall (ms).
    wall_ms: f64,
    /// The most memory it had (MB, 10^6 bytes).
    pub(crate) peak_mb: f64,
}

impl Program {
    pub(crate) fn new(house: &House) -> Result<Self> {
        Ok(Self {
            measure: house.program("measure"),
            objecthood: house.program("objecthood"),
            peer: house.root.join("crates/objecthood-bench/peers/graph_segmentation.py"),
            out: house.folder("bench/out")?,
        })
    }

    /// Methods, stages and kernels on every frame, and the Python peers on the same frame next to them.
    pub(crate) fn times(
        &self,
        files: &[PathBuf],
        python: Option<&Path>,
        figures: &mut Figures,
    ) -> Result<()> {
        figures.read(&self.printed_times(files, python)?, |_, series| series.to_owned())
    }

    /// As [`Self::times`], each series with the name of its frame before it.
    pub(crate) fn times_by_frame(&self, files: &[PathBuf], figures: &mut Figures) -> Result<()> {
        figures.read(&self.printed_times(files, None)?, |frame, series| format!("{frame}/{series}"))
    }

    fn printed_times(&self, files: &[PathBuf], python: Option<&Path>) -> Result<String> {
        let mut measure = Command::new(&self.measure);
        measure.arg("times");
        if let Some(python) = python {
            measure.arg("--python").arg(python).arg("--script").arg(&self.peer);
        }
        output(measure.args(files))
    }

    /// Each method alone; the medians over the frames, as those of the programs around PCL.
    pub(crate) fn alone(&self, files: &[PathBuf], figures: &mut Figures) -> Result<()> {
        let mut block = Figures::default();
        block.read(&output(Command::new(&self.measure).arg("alone").args(files))?, |_, series| {
            series.to_owned()
        })?;
        for method in METHODS {
            for (threads, quantity) in [(1, "wall_ms"), (1, "cpu_ms"), (2, "wall_ms"), (2, "cpu_ms")] {
                let series = format!("{method}/alone/{threads}/{quantity}");
                let median = block.median(&series).context("`measure alone` printed no times")?;
                figures.add(series, median);
            }
        }
        Ok(())
    }

    /// A folder of frames from files to label images, on 1 and on 2 threads.
    pub(crate) fn stream(&self, folder: &Path, figures: &mut Figures) -> Result<()> {
        for method in METHODS {
            for threads in ["1", "2"] {
                let taken = self.segment(folder, method, threads)?;
                figures.add(format!("stream/{method}/{threads}/wall_ms"), taken.wall_ms);
            }
        }
        Ok(())
    }

    /// Reading beside the method, of frames that are stored in several formats.
    pub(crate) fn reading(&self, files: &[PathBuf], figures: &mut Figures) -> Result<()> {
        let folder = self.out.join("reading");
        let text = output(Command::new(&self.measure).arg("reading").arg(folder).args(files))?;
        figures.read(&text, |_, series| series.to_owned())
    }

    /// The most memory that a fresh process has for one frame.
    pub(crate) fn peak(&self, file: &Path, figures: &mut Figures) -> Result<()> {
        for method in METHODS {
            figures.add(format!("{method}/peak/mb"), self.segment(file, method, "2")?.peak_mb);
        }
        Ok(())
    }

    /// Resident memory of one process over many frames.
    pub(crate) fn growth(&self, frames: usize, files: &[PathBuf], figures: &mut Figures) -> Result<()> {
        let text = output(Command::new(&self.measure).arg("growth").arg(frames.to_string()).args(files))?;
        figures.read(&text, |_, series| series.to_owned())
    }

    /// Synthetic scenes of growing size and number of things.
    pub(crate) fn scenes(&self, folder: &Path) -> Result<()> {
        output(Command::new(&self.measure).arg("scenes").arg(folder)).map(drop)
    }

    /// `objecthood segment` in a process of its own.
    pub(crate) fn segment(&self, input: &Path, method: &str, threads: &str) -> Result<Taken> {
        let mut command = Command::new(&self.objecthood);
        command.arg("segment").arg(input).args([
            "--method",
            method,
            "--threads",
            threads,
            "--write",
            "labels",
        ]);
        command.arg("--out").arg(self.out.join(method)).stdout(Stdio::null());
        let start = Instant::now();
        let mut child = command
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot run {}", self.objecthood.display()))?;
        let mut complaint = String::new();
        if let Some(mut stderr) = child.stderr.take() {
            stderr.read_to_string(&mut complaint).context("objecthood does not write UTF-8")?;
        }
        let used = child.wait4().context("objecthood did not end")?;
        let wall_ms = 1e3 * start.elapsed().as_secs_f64();
        if !used.status.success() {
            bail!("objecthood segment {} failed: {}", input.display(), complaint.trim());
        }
        Ok(Taken { wall_ms, peak_mb: used.rusage.maxrss as f64 / 1e6 })
    }
}
