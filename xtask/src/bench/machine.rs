//! On what was measured: a figure without its machine says nothing.

use std::fmt;
use std::process::Command;

use anyhow::{Context, Result};

use crate::house::{House, output};

/// The machine, the day, and the versions of what was measured.
pub(crate) struct Machine {
    processor: String,
    cores: usize,
    kernel: String,
    date: String,
    commit: String,
    compiler: String,
}

impl Machine {
    /// This machine, now.
    ///
    /// # Errors
    /// When the system does not say.
    pub(crate) fn here(house: &House) -> Result<Self> {
        let said = |program: &str, arguments: &[&str]| -> Result<String> {
            let mut command = Command::new(program);
            Ok(output(command.current_dir(&house.root).args(arguments))?.trim().to_owned())
        };
        let processors =
            std::fs::read_to_string("/proc/cpuinfo").context("the processor is read on Linux only")?;
        let processor = processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        let dirty = if said("git", &["status", "--porcelain"])?.is_empty() { "" } else { " with changes" };
        Ok(Self {
            processor: processor.map_or("an unnamed processor", |(_, name)| name).to_owned(),
            cores: std::thread::available_parallelism().context("the system does not say its cores")?.get(),
            kernel: said("uname", &["-sr"])?,
            date: said("date", &["-u", "+%Y-%m-%d"])?,
            commit: said("git", &["rev-parse", "--short=10", "HEAD"])? + dirty,
            compiler: said("rustc", &["--version"])?,
        })
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { processor, cores, kernel, date, commit, compiler } = self;
        write!(
            f,
            "{processor}, {cores} cores, {kernel}; {date}; commit {commit}; {compiler}, release profile, for any processor \
             of the architecture."
        )
    }
}
