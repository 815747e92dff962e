//! Test programs, several at once: `cargo test` runs one after another, and the longest ones have a test or two.

use std::num::NonZero;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, mpsc};
use std::thread;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::house::House;
use crate::tally::Tally;

/// Threads of one program. With as many programs as cores, two keep the cores busy while tests wait for programs that
/// they run, and when only the last program is left.
const THREADS: &str = "2";

/// A test program that cargo has built.
struct Program {
    /// The folder of its package, then its target.
    name: String,
    file: PathBuf,
    /// The folder of its package, in which it runs.
    folder: PathBuf,
}

/// Builds the tests that `cargo test --no-run` and `selection` name, runs their programs, as many at once as there are
/// cores, and takes in what they print; whether all went well.
///
/// A program's output is printed as a whole when it has ended.
///
/// # Errors
/// When cargo or a program cannot be run.
pub(crate) fn run(
    house: &House,
    selection: &str,
    environment: &[(&str, PathBuf)],
    tally: &mut Tally,
) -> Result<bool> {
    let Some(mut programs) = build(house, selection)? else { return Ok(false) };
    ensure!(!programs.is_empty(), "cargo names no test program of {selection}");
    // A single long test keeps one core busy: that is no loss while another program runs, but the last one runs alone.
    programs.sort_by_cached_key(Program::count_tests);
    let programs = Mutex::new(programs.into_iter());
    let workers = thread::available_parallelism().map_or(1, NonZero::get);
    let (sender, results) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..workers {
            let (sender, programs) = (sender.clone(), &programs);
            scope.spawn(move || {
                let next = || programs.lock().ok()?.next();
                while let Some(program) = next() {
                    let output = program.run(environment);
                    if sender.send((program, output)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let mut passed = true;
        for (program, output) in results {
            passed &= take_in(&program.name, &output?, tally);
        }
        Ok(passed)
    })
}

/// The test programs in the order in which cargo built them; none if they do not compile.
fn build(house: &House, selection: &str) -> Result<Option<Vec<Program>>> {
    let mut cargo = house.cargo("test --no-run --locked --message-format=json-render-diagnostics");
    let output = cargo.args(selection.split_whitespace()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("{cargo:?}"))?;
    if !output.status.success() {
        return Ok(None);
    }
    let messages = String::from_utf8(output.stdout).context("cargo's messages are not UTF-8")?;
    let mut programs = Vec::new();
    for line in messages.lines() {
        let message =
            serde_json::from_str(line).with_context(|| format!("cargo's message cannot be read: {line}"))?;
        programs.extend(program(&message));
    }
    Ok(Some(programs))
}

/// The test program that a message of cargo tells of.
fn program(message: &Value) -> Option<Program> {
    if message["reason"] != "compiler-artifact" || message["profile"]["test"] != true {
        return None;
    }
    let folder = PathBuf::from(message["manifest_path"].as_str()?).parent()?.to_owned();
    let package = folder.file_name()?.to_string_lossy().into_owned();
    let name = format!("{package} {}", message["target"]["name"].as_str()?);
    Some(Program { name, file: PathBuf::from(message["executable"].as_str()?), folder })
}

impl Program {
    /// How many tests it has; none if it cannot say.
    fn count_tests(&self) -> usize {
        let listed = Command::new(&self.file).arg("--list").current_dir(&self.folder).output();
        let lines = listed.map(|output| output.stdout).unwrap_or_default();
        lines.split(|&byte| byte == b'\n').filter(|line| line.ends_with(b": test")).count()
    }

    fn run(&self, environment: &[(&str, PathBuf)]) -> Result<Output> {
        let mut command = Command::new(&self.file);
        // A test that skips itself passes, and says so only in its output.
        command.arg("--show-output").current_dir(&self.folder);
        command.env("CARGO_MANIFEST_DIR", &self.folder).env("RUST_TEST_THREADS", THREADS);
        command.envs(environment.iter().map(|(name, value)| (name, value)));
        command.output().with_context(|| format!("{command:?}"))
    }
}

/// Prints what a program printed, and counts it; whether it went well.
pub(crate) fn take_in(name: &str, output: &Output, tally: &mut Tally) -> bool {
    println!("\n     Running {name}");
    // Tests may print anything, so lines are not taken to be UTF-8.
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        println!("{line}");
        tally.read(line);
    }
    print!("{}", String::from_utf8_lossy(&output.stderr));
    if !output.status.success() {
        println!("{name} failed, {}", output.status);
    }
    output.status.success()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_what_cargo_built_with_tests() {
        let message = |test: bool, executable: Value| {
            serde_json::json!({
                "reason": "compiler-artifact", "manifest_path": "/house/crates/core/Cargo.toml", "target": {"name": "paper"},
                "profile": {"test": test}, "executable": executable,
            })
        };
        let found = program(&message(true, "/house/target/paper-1".into())).unwrap();
        assert_eq!((found.name.as_str(), found.folder.to_str()), ("core paper", Some("/house/crates/core")));
        assert!(program(&message(false, "/house/target/core".into())).is_none());
        assert!(program(&message(true, Value::Null)).is_none());
        assert!(program(&serde_json::json!({"reason": "build-finished", "success": true})).is_none());
    }
}
