//! A Python of our own, with the packages that the independent scorer or the peers need.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};

use crate::house::output;

/// Makes a virtual environment below `tools` with the packages pinned in `requirements`, and returns its Python.
///
/// A finished environment is kept until the requirements change.
///
/// # Errors
/// Without `python3`, its `venv` module or a package registry.
pub(crate) fn prepare(tools: &Path, requirements: &Path) -> Result<PathBuf> {
    let venv = tools.join("venv");
    let python = venv.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let wanted = fs::read_to_string(requirements).with_context(|| format!("{}", requirements.display()))?;
    // Written last, so that an environment that was left half-made is made again.
    let stamp = tools.join("venv.requirements");
    if fs::read_to_string(&stamp).is_ok_and(|have| have == wanted) && python.exists() {
        return Ok(python);
    }
    fs::create_dir_all(tools).with_context(|| format!("{}", tools.display()))?;
    output(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv))?;
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"];
    output(Command::new(&python).args(pip).arg(requirements))?;
    fs::write(&stamp, wanted).with_context(|| format!("{}", stamp.display()))?;
    Ok(python)
}

/// The packages that are pinned in `requirements`, with their versions.
///
/// # Errors
/// When the file cannot be read.
pub(crate) fn pins(requirements: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(requirements).with_context(|| format!("{}", requirements.display()))?;
    let pins = text.lines().filter(|line| !line.starts_with('#'));
    Ok(pins.map(|line| line.replace("==", " ")).collect())
}
