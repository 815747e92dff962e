//! `objecthood batch`: hands an archive to the engine, which is a package of Python.

use std::ffi::OsString;
use std::process::Command;

use anyhow::{Result, anyhow};

use crate::args::{BatchArgs, Engine};
use crate::config;
use crate::failure::{Outcome, usage};

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
            "the engine is not there ({python}: {why}): {python} -m pip install '{extra}' installs it (from this repository: './python[ray]'); \
             OBJECTHOOD_PYTHON names another Python; `objecthood segment --resume` needs none"
        ))
    };
    let tried = Command::new(&python).args(["-c", &format!("import {module}")]).output();
    let tried = tried.map_err(|e| absent(&e.to_string()))?;
    if !tried.status.success() {
        let said = String::from_utf8_lossy(&tried.stderr);
        return Err(absent(said.trim_end().lines().next_back().unwrap_or("it ended")));
    }
    let status = Command::new(&python).args(["-m", module]).args(options(args)?).status()?;
    match status.code() {
        Some(0) => Ok(Outcome::AllDone),
        Some(1) => Ok(Outcome::SomeFailed),
        Some(2) => Err(usage("the engine refused it; stderr says why")),
        Some(130) => Ok(Outcome::Interrupted),
        _ => Err(anyhow!("the engine ended early ({status}): give the same command to go on")),
    }
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
    options.push("--".into());
    options.extend(inputs.iter().map(OsString::from));
    Ok(options)
}
