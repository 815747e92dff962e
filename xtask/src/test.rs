//! `cargo xtask test`: formatting, lints, documentation and every test, with a summary of what ran and what did not.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result};

use crate::house::House;
use crate::tally::Tally;
use crate::{aarch64, api, instructions, package, page, programs, python, source};

/// One thing that was checked.
struct Step {
    name: &'static str,
    passed: bool,
    seconds: f64,
}

/// What `--quick` leaves out, because it takes most of the time.
const LEFT_OUT: &str = "left out by --quick: tests of whole programs and on real data, documentation with its examples, the listing of \
     the public API, the Python package, the live page in a browser, the build for aarch64, instruction counts";

/// What a change needs while it is made: formatting, lints, unit tests and the golden maps. Meant to take four
/// minutes on two cores when the dependencies are built.
///
/// # Errors
/// When `cargo` itself cannot be run.
pub(crate) fn run_quick(house: &House) -> Result<bool> {
    let mut tally = Tally::default();
    let mut steps = vec![
        timed("formatting", || succeeds(&mut house.cargo("fmt --all --check")))?,
        timed("lints", || {
            succeeds(&mut house.cargo("clippy --workspace --all-targets --locked -- -D warnings"))
        })?,
    ];
    steps.push(timed("order of the house", || Ok(is_tidy(house)))?);
    steps.push(timed("unit tests", || programs::run(house, "--workspace --lib --bins", &[], &mut tally))?);
    steps.push(timed("golden maps", || programs::run(house, "-p objecthood --tests", &[], &mut tally))?);
    summarize(&steps, &tally);
    println!("{LEFT_OUT}");
    Ok(steps.iter().all(|step| step.passed))
}

/// Whether imports, lengths and constants of the core are as they should be. A file that cannot be parsed is a failure of
/// this step, not the end of the run.
fn is_tidy(house: &House) -> bool {
    source::check(&house.root).unwrap_or_else(|error| {
        println!("{error:#}");
        false
    })
}

fn succeeds(command: &mut Command) -> Result<bool> {
    Ok(command.status().with_context(|| format!("{command:?}"))?.success())
}

/// Runs every step, also after one has failed, and says at the end how each went.
///
/// # Errors
/// When `cargo` itself cannot be run.
pub(crate) fn run(house: &House) -> Result<bool> {
    let cargo = |arguments: &str| house.cargo(arguments);
    let mut steps = Vec::new();
    let mut tally = Tally::default();

    let mut quiet = |name, command: &mut Command| -> Result<()> {
        steps.push(timed(name, || succeeds(command))?);
        Ok(())
    };
    quiet("formatting", &mut cargo("fmt --all --check"))?;
    quiet("lints", &mut cargo("clippy --workspace --all-targets --locked -- -D warnings"))?;
    let mut docs = cargo("doc --workspace --no-deps --locked");
    quiet("documentation", docs.env("RUSTDOCFLAGS", "-D warnings"))?;
    steps.push(timed("order of the house", || Ok(is_tidy(house)))?);
    steps.push(timed("public API", || api::check(house))?);

    let python = python_for_tests(house, &mut tally);
    let environment: Vec<_> = python.map(|python| ("OBJECTHOOD_PYTHON", python)).into_iter().collect();
    steps.push(timed("tests", || {
        programs::run(house, "--workspace --all-targets", &environment, &mut tally)
    })?);
    let examples = "test --workspace --doc --locked --no-fail-fast -- --show-output";
    steps.push(timed("examples in the documentation", || read_tests(&mut cargo(examples), &mut tally))?);
    steps.push(timed("Python package", || package::check(house, &mut tally))?);
    steps.push(timed("live page", || page::check(house, &mut tally))?);
    steps.push(timed("builds for aarch64", || aarch64::check(house, &mut tally))?);
    steps.push(timed("instructions", || Ok(instructions::check(house, &mut tally)))?);

    summarize(&steps, &tally);
    Ok(steps.iter().all(|step| step.passed))
}

/// The Python that the tests may use, if one can be had. `OBJECTHOOD_PYTHON` names another one.
fn python_for_tests(house: &House, tally: &mut Tally) -> Option<PathBuf> {
    if let Some(python) = std::env::var_os("OBJECTHOOD_PYTHON") {
        return Some(python.into());
    }
    println!("\n== Python for the tests");
    match python::prepare(&house.target.join("test-tools"), &house.root.join("xtask/requirements.txt")) {
        Ok(python) => Some(python),
        Err(e) => {
            tally.skip(format!("what needs Python: {e:#}"));
            None
        }
    }
}

/// Runs a step under its heading.
fn timed(name: &'static str, step: impl FnOnce() -> Result<bool>) -> Result<Step> {
    println!("\n== {name}");
    let start = Instant::now();
    let passed = step()?;
    Ok(Step { name, passed, seconds: start.elapsed().as_secs_f64() })
}

/// Runs tests: passes their output on and takes it in; whether all went well.
pub(crate) fn read_tests(command: &mut Command, tally: &mut Tally) -> Result<bool> {
    let mut child = command.stdout(Stdio::piped()).spawn().with_context(|| format!("{command:?}"))?;
    let output = child.stdout.take().context("the output of the tests cannot be read")?;
    // Tests may print anything, so lines are not taken to be UTF-8.
    for line in BufReader::new(output).split(b'\n') {
        let line = line.context("the output of the tests cannot be read")?;
        let line = String::from_utf8_lossy(&line);
        println!("{line}");
        tally.read(&line);
    }
    Ok(child.wait().context("the tests did not end")?.success())
}

fn summarize(steps: &[Step], tally: &Tally) {
    println!("\n== summary");
    for Step { name, passed, seconds } in steps {
        println!("{} {name} ({seconds:.0} s)", if *passed { "ok    " } else { "FAILED" });
    }
    for why in &tally.skipped {
        println!("skipped: {why}");
    }
    println!("\n== closing lines of the test programs");
    for line in &tally.closing_lines {
        println!("{line}");
    }
    println!("{} passed, {} failed", tally.passed, tally.failed);
}
