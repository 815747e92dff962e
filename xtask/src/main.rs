//! The tasks of the house. `cargo xtask test` checks everything there is to check; `cargo xtask bench` says what it costs.

#![expect(clippy::print_stdout, reason = "talks to whoever develops, on a terminal or in CI")]

mod aarch64;
mod api;
mod bench;
mod house;
mod instructions;
mod package;
mod page;
mod pictures;
mod programs;
mod python;
mod source;
mod tally;
mod test;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Result, bail};

use crate::house::House;

const USAGE: &str = "usage: cargo xtask TASK
  test                 formatting, lints, documentation, every test, and what else must not change unnoticed
  test --quick         what a change needs while it is made; prints what it leaves out
  bench [--quick] [--rounds N] [--frames N]
                       times and memory, beside other libraries; writes docs/performance.md (not with --quick)
                       --rounds: how often everything is measured; --frames: how many frames memory must not grow over
  bench --scaling      how time and memory grow with pixels and things; the same file
  bench --instructions counts instructions anew and writes the file that `test` compares with
  house [--root FOLDER]
                       import circles, functions and files that are too long in the core of this checkout, or of the one in FOLDER
  aarch64              builds for aarch64 and compares labels under qemu-user with those of this machine
  api                  writes the listing of the core's public API anew, which `test` compares with
  python               builds the Python package in its folder, and runs its tests
  page                 builds the live page from its TypeScript, which needs Node
  page --test          tries it in a browser; pictures of what it looks like are left in target/page-pictures
  page --picture       draws the picture of the page in the README
  page --times         measures how long it takes from a change of a parameter to the picture
  pictures             draws the pictures of docs/CONTEXT.md anew";

fn main() -> ExitCode {
    if let Some(code) = api::run_as_rustdoc() {
        return code;
    }
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
    let house = House::find()?;
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["test"] => test::run(&house),
        ["test", "--quick"] => test::run_quick(&house),
        ["bench", "--scaling"] => bench::scaling::run(&house),
        ["bench", "--instructions"] => instructions::bless(&house),
        ["bench", ref options @ ..] => match bench::Options::parse(options) {
            Some(options) => bench::run(&house, &options),
            None => bail!("{USAGE}"),
        },
        ["house"] => source::check(&house.root),
        ["house", "--root", folder] => source::check(Path::new(folder)),
        ["api"] => api::bless(&house),
        ["aarch64"] => aarch64::run(&house),
        ["python"] => package::run(&house),
        ["page"] => page::run(&house),
        ["page", "--test"] => page::run_tests(&house),
        ["page", "--picture"] => page::draw(&house),
        ["page", "--times"] => page::measure(&house),
        ["pictures"] => pictures::run(&house),
        _ => bail!("{USAGE}"),
    }
}
