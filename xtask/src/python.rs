//! A Python of the tests' own, with the packages that the independent scorer needs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

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
    succeed(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv))?;
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"];
    succeed(Command::new(&python).args(pip).arg(requirements))?;
    fs::write(&stamp, wanted).with_context(|| format!("{}", stamp.display()))?;
    Ok(python)
}

/// Runs a command that must succeed; its last line of complaint is the reason when it does not.
fn succeed(command: &mut Command) -> Result<()> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().with_context(|| format!("cannot run {name}"))?;
    if output.status.success() {
        return Ok(());
    }
    let complaint = [output.stdout, output.stderr].concat();
    let complaint = String::from_utf8_lossy(&complaint);
    let reason = complaint.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no reason given");
    bail!("{name} failed: {reason}")
}
