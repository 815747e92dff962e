//! The tasks of the house. `cargo xtask test` checks everything there is to check.

#![expect(clippy::print_stdout, reason = "talks to whoever develops, on a terminal or in CI")]

mod python;
mod tally;
mod test;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result, bail};

const USAGE: &str = "usage: cargo xtask test    formatting, lints, documentation and every test";

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(e) => {
            println!("error: {e:#}");
            ExitCode::from(2)
        }
    }
}

/// Runs the task named on the command line; whether all of it went well.
fn run() -> Result<bool> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(&workspace()?),
        _ => bail!("{USAGE}"),
    }
}

/// The root of the workspace: the folder above this package.
fn workspace() -> Result<PathBuf> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR").context("run me as `cargo xtask`")?;
    let root = PathBuf::from(package).parent().map(PathBuf::from);
    root.context("the package xtask has no folder above it")
}
