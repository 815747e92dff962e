//! `objecthood batch`: hands an archive to the engine, which is a package of Python.

use std::ffi::OsString;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Result, anyhow};

use crate::args::{BatchArgs, Engine, PairArgs};
use crate::config;
use crate::failure::{Outcome, usage};
use crate::inputs::pairs;

/// The module of the engine, and what installs it.
fn package(engine: Engine) -> (&'static str, &'static str) {
    match engine {
        Engine::Ray => ("objecthood.ray", "objecthood[ray]"),
    }
}

/// Runs the engine on the archive named on the command line.
///
/// # Errors
/// Of usage, when the engine is not there or refuses what it is given; when it was ended by a signal.
pub(crate) fn run(args: &BatchArgs) -> Result<Outcome> {
    let python = std::env::var_os("OBJECTHOOD_PYTHON").unwrap_or_else(|| "python3".into());
    let (module, extra) = package(args.engine);
    let absent = |why: &str| {
        let python = python.display();
        usage(format!(
            "the Python package {module} cannot be loaded ({python}: {why}): {python} -m pip install '{extra}' installs it (from this repository: './python[ray]'); \
             OBJECTHOOD_PYTHON names another Python; `objecthood segment --resume` needs none"
        ))
    };
    let tried = Command::new(&python).args(["-c", &format!("import {module}")]).output();
    let tried = tried.map_err(|e| absent(&e.to_string()))?;
    if !tried.status.success() {
        let said = String::from_utf8_lossy(&tried.stderr);
        return Err(absent(said.trim_end().lines().next_back().unwrap_or("it ended")));
    }
    let pairs = pairs_of(&args.pairs)?;
    let mut command = Command::new(&python);
    command.args(["-m", module]).args(options(args)?);
    let status = run_engine(command, pairs.as_deref())?;
    match status.code() {
        Some(0) => Ok(Outcome::AllDone),
        Some(1) => Ok(Outcome::SomeFailed),
        Some(2) => Err(usage("the engine refused it; stderr says why")),
        Some(130) => Ok(Outcome::Interrupted),
        _ => Err(anyhow!("the engine ended early ({status}): give the same command to go on")),
    }
}

/// The pairs of images that are named, as JSON; `None` if inputs are named instead.
///
/// # Errors
/// Of usage, when an image has no partner, and when a path is not Unicode, which JSON has to be.
fn pairs_of(named: &PairArgs) -> Result<Option<String>> {
    if named.depth.is_empty() {
        return Ok(None);
    }
    let found = pairs::find(named)?;
    if let Some(complaint) = found.complaints.into_iter().next() {
        return Err(usage(complaint.to_string()));
    }
    let text = |path: PathBuf| {
        path.into_os_string()
            .into_string()
            .map_err(|path| usage(format!("{}: rename it, its name is no Unicode", path.display())))
    };
    let pairs: Result<Vec<_>> = found
        .pairs
        .into_iter()
        .map(|files| Ok((files.color.map(text).transpose()?, text(files.depth)?)))
        .collect();
    Ok(Some(serde_json::to_string(&pairs?)?))
}

/// Runs the engine to its end; it reads `input` from stdin.
///
/// # Errors
/// When it cannot be started, or does not read.
fn run_engine(mut command: Command, input: Option<&str>) -> Result<ExitStatus> {
    let Some(input) = input else { return Ok(command.status()?) };
    let mut engine = command.arg("--pairs").stdin(Stdio::piped()).spawn()?;
    if let Some(mut stdin) = engine.stdin.take() {
        stdin.write_all(input.as_bytes())?;
    }
    Ok(engine.wait()?)
}

/// The options as the module takes them.
///
/// # Errors
/// Of usage, when the parameters are wrong.
fn options(args: &BatchArgs) -> Result<Vec<OsString>> {
    let BatchArgs { inputs, out, method, parameters, camera, depth_scale, topics, workers, .. } = args;
    let params = serde_json::to_string(&config::params(parameters, *method)?)?;
    let mut options: Vec<OsString> = vec![format!("--out={out}").into()];
    let mut add = |name: &str, value: OsString| {
        let mut option = OsString::from(format!("--{name}="));
        option.push(value);
        options.push(option);
    };
    add("params", params.into());
    camera.iter().for_each(|camera| add("camera", camera.into()));
    depth_scale.iter().for_each(|scale| add("depth-scale", scale.to_string().into()));
    topics.iter().for_each(|topic| add("topic", topic.into()));
    workers.iter().for_each(|count| add("workers", count.to_string().into()));
    if !inputs.is_empty() {
        options.push("--".into());
        options.extend(inputs.iter().map(OsString::from));
    }
    Ok(options)
}
