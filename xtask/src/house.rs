//! Where things are, and how programs are run.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

/// The methods, as the programs are told them.
pub(crate) const METHODS: [&str; 2] = ["context", "paper"];

/// The workspace.
pub(crate) struct House {
    /// The folder above this package.
    pub(crate) root: PathBuf,
    /// Where cargo builds.
    pub(crate) target: PathBuf,
}

impl House {
    /// The workspace that this package lies in.
    pub(crate) fn find() -> Result<Self> {
        let package = std::env::var_os("CARGO_MANIFEST_DIR").context("run me as `cargo xtask`")?;
        let root = PathBuf::from(package).parent().map(PathBuf::from);
        let root = root.context("the package xtask has no folder above it")?;
        let target = root.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()));
        Ok(Self { root, target })
    }

    /// A cargo command, its arguments separated by blanks.
    pub(crate) fn cargo(&self, arguments: &str) -> Command {
        let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.current_dir(&self.root).args(arguments.split_whitespace());
        command
    }

    /// Builds the programs `debug/objecthood` and `debug/measure` and the library of the Python package, with the profile of the tests.
    ///
    /// Together with all tests, which so have to compile: cargo chooses the features of a dependency by all packages that it builds at once, so
    /// these alone would compile most of them, and the core, again after the tests.
    pub(crate) fn build_products(&self) -> Result<()> {
        pass_on(&mut self.cargo("build --profile test --locked --workspace --all-targets"))
    }

    /// A program built in release.
    pub(crate) fn program(&self, name: &str) -> PathBuf {
        self.target.join("release").join(name)
    }

    /// A folder below `target` for what a task makes; made if it is not there.
    pub(crate) fn folder(&self, name: &str) -> Result<PathBuf> {
        let folder = self.target.join(name);
        std::fs::create_dir_all(&folder).with_context(|| format!("{}", folder.display()))?;
        Ok(folder)
    }

    /// The folder of the real data, if it is there: as the tests find it.
    pub(crate) fn data(&self) -> Option<PathBuf> {
        let beside = || self.root.join("../shared/data");
        let folder = std::env::var_os("OBJECTHOOD_DATA").map_or_else(beside, PathBuf::from);
        folder.join("mosd/learn").is_dir().then_some(folder)
    }
}

/// Runs a command that must succeed, its output passed on.
pub(crate) fn pass_on(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot run {}", name(command)))?;
    if !status.success() {
        bail!("{} failed, {status}", name(command));
    }
    Ok(())
}

/// Runs a command that must succeed, and returns what it printed; its last line of complaint is the reason when it does not.
pub(crate) fn output(command: &mut Command) -> Result<String> {
    let output = command.output().with_context(|| format!("cannot run {}", name(command)))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let complaint = [output.stdout, output.stderr].concat();
    let complaint = String::from_utf8_lossy(&complaint);
    let reason = complaint.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no reason given");
    bail!("{} failed: {reason}", name(command))
}

/// Whether a program can be run and knows its version.
pub(crate) fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// The files of a folder with this ending, by number as people count: learn2 before learn10.
pub(crate) fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).with_context(|| format!("{}", folder.display()))?;
    let mut files = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    files.retain(|file| file.extension().is_some_and(|e| e == ending));
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    Ok(files)
}

fn name(command: &Command) -> String {
    command.get_program().to_string_lossy().into_owned()
}
