//! Another library, in a process of its own that does a frame whenever it is asked.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result};
use objecthood::{Params, Raster};

/// A running process that segments images.
pub struct Peer {
    process: Child,
    images: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Peer {
    /// Starts the script with the parameters of the graph segmentation.
    ///
    /// # Errors
    /// When the process cannot be started.
    pub fn start(python: &Path, script: &Path, params: &Params) -> Result<Self> {
        let mut process = Command::new(python)
            .arg(script)
            .arg(params.smoothing.sigma_px.to_string())
            .arg(params.graph.size_preference_grey.to_string())
            .arg(params.graph.min_size_px.to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot run {}", python.display()))?;
        let images = process.stdin.take().context("the peer takes no images")?;
        let answers = BufReader::new(process.stdout.take().context("the peer gives no answers")?);
        Ok(Self { process, images, answers })
    }

    /// Hands an image over and waits; the lines `series TAB value` that it says about it.
    ///
    /// # Errors
    /// When the process has ended.
    pub fn segment(&mut self, color: &Raster<[u8; 3]>) -> Result<Vec<(String, f64)>> {
        writeln!(self.images, "{} {}", color.width(), color.height())?;
        self.images.write_all(color.as_slice().as_flattened())?;
        self.images.flush()?;
        let mut said = Vec::new();
        loop {
            let mut line = String::new();
            if self.answers.read_line(&mut line)? == 0 {
                let status = self.process.wait()?;
                anyhow::bail!("the peer ended, {status}");
            }
            match line.trim_end().split_once('\t') {
                Some((series, value)) => {
                    said.push((series.to_owned(), value.parse().with_context(|| line.clone())?));
                }
                None => return Ok(said),
            }
        }
    }
}
