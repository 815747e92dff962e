//! The Python package: built, tested with the newest NumPy, with the oldest that it takes, and with Ray; and its types checked.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

use crate::house::House;
use crate::python;
use crate::tally::Tally;
use crate::test::read_tests;

/// The environments in which its tests run, each with its pinned packages, and the tests that are run there.
const ENVIRONMENTS: [(&str, &str); 3] = [
    ("tests", "--ignore=tests/test_ray.py"),
    ("oldest", "--ignore=tests/test_ray.py"),
    (TYPED, "tests/test_ray.py"),
];

/// The environment that has everything that the package imports, for the check of types.
const TYPED: &str = "ray";

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

/// Builds the package and runs its tests; whether all went well. An environment that cannot be had is noted.
///
/// # Errors
/// When the package cannot be built, or its tests cannot be started.
pub(crate) fn check(house: &House, tally: &mut Tally) -> Result<bool> {
    build(house)?;
    let folder = house.root.join("python");
    let mut passed = true;
    for (name, which) in ENVIRONMENTS {
        let requirements = folder.join(format!("requirements-{name}.txt"));
        let python = match python::prepare(&house.target.join(format!("test-package-{name}")), &requirements)
        {
            Ok(python) => python,
            Err(e) => {
                tally.skip(format!("the Python package with {}: {e:#}", requirements.display()));
                continue;
            }
        };
        let mut tests = module(&folder, &python, &["pytest", "-q", "-rfEs", which]);
        tests.env("OBJECTHOOD_PROGRAM", house.target.join("debug/objecthood"));
        passed &= read_tests(&mut tests, tally)?;
        if name == TYPED {
            for types in
                [&["mypy"][..], &["mypy.stubtest", "--mypy-config-file=pyproject.toml", "objecthood"]]
            {
                passed &= module(&folder, &python, types).status().context("mypy cannot be run")?.success();
            }
        }
    }
    Ok(passed)
}

/// A module of Python that is run in the folder of the package.
fn module(folder: &Path, python: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(python);
    command.current_dir(folder).arg("-m").args(arguments).env("PYTHONDONTWRITEBYTECODE", "1");
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
