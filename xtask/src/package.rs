//! The Python package: built, tested with the newest NumPy, with the oldest that it takes, and with Ray; and its types checked.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, anyhow};

use crate::house::House;
use crate::tally::Tally;
use crate::{programs, python};

/// What is run of Python: the environment with its pinned packages, and the module with its arguments. The environment with Ray has
/// everything that the package imports, for the check of types.
const CHECKS: [(&str, &[&str]); 5] = [
    ("ray", &["pytest", "tests/test_ray.py"]),
    ("tests", &["pytest", "--ignore=tests/test_ray.py"]),
    ("oldest", &["pytest", "--ignore=tests/test_ray.py"]),
    ("ray", &["mypy"]),
    ("ray", &["mypy.stubtest", "--mypy-config-file=pyproject.toml", "objecthood"]),
];

/// Builds the package in its folder, as `pip install --editable` would, with what the tests of Rust have built already.
///
/// # Errors
/// When it cannot be built.
pub(crate) fn build(house: &House) -> Result<()> {
    house.build_products()?;
    let (built, loaded) = if cfg!(windows) {
        ("_native.dll", "_native.pyd")
    } else if cfg!(target_os = "macos") {
        ("lib_native.dylib", "_native.abi3.so")
    } else {
        ("lib_native.so", "_native.abi3.so")
    };
    let (from, to) =
        (house.target.join("debug").join(built), house.root.join("python/objecthood").join(loaded));
    // A process that has loaded the old one keeps it.
    let aside = to.with_extension("new");
    fs::copy(&from, &aside).with_context(|| format!("{} -> {}", from.display(), aside.display()))?;
    fs::rename(&aside, &to).with_context(|| format!("{}", to.display()))
}

/// Builds the package and runs all checks at once, because those with Ray mostly wait; whether all went well. An environment that
/// cannot be had is noted.
///
/// # Errors
/// When the package cannot be built, or its tests cannot be started.
pub(crate) fn check(house: &House, tally: &mut Tally) -> Result<bool> {
    build(house)?;
    let mut checks = Vec::new();
    for (environment, arguments) in CHECKS {
        match prepare(house, environment) {
            Ok(python) => {
                checks.push((format!("{} ({environment})", arguments[0]), module(house, &python, arguments)));
            }
            Err(e) => tally.skip(format!("the Python package with the packages of `{environment}`: {e:#}")),
        }
    }
    let run = |command: &mut Command| command.output().with_context(|| format!("{command:?}"));
    thread::scope(|scope| {
        let running = checks.iter_mut().map(|(name, command)| (&*name, scope.spawn(move || run(command))));
        let running: Vec<_> = running.collect();
        let mut passed = true;
        for (name, output) in running {
            let output = output.join().map_err(|_| anyhow!("{name} was not watched"))?;
            passed &= programs::take_in(name, &output?, tally);
        }
        Ok(passed)
    })
}

/// The Python of an environment.
fn prepare(house: &House, environment: &str) -> Result<PathBuf> {
    let requirements = house.root.join(format!("python/requirements-{environment}.txt"));
    python::prepare(&house.target.join(format!("test-package-{environment}")), &requirements)
}

/// A module of Python that is run in the folder of the package.
fn module(house: &House, python: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.current_dir(house.root.join("python")).arg("-m").args(arguments);
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command.env("PYTEST_ADDOPTS", "-q -rfEs -p no:cacheprovider");
    command.env("OBJECTHOOD_PROGRAM", house.target.join("debug/objecthood"));
    command
}

/// As [`check`], by itself; says what was skipped.
///
/// # Errors
/// As [`check`].
pub(crate) fn run(house: &House) -> Result<bool> {
    let mut tally = Tally::default();
    let passed = check(house, &mut tally)?;
    tally.skipped.iter().for_each(|why| println!("skipped: {why}"));
    Ok(passed)
}
