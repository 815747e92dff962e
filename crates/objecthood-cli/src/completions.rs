//! `objecthood completions`: what shells need to complete the command line.

use anyhow::{Context, Result};
use clap::CommandFactory;

use crate::args::{Cli, CompletionsArgs};
use crate::failure::Outcome;
use crate::terminal;

/// Prints the script.
///
/// # Errors
/// When stdout cannot be written.
pub(crate) fn run(args: &CompletionsArgs) -> Result<Outcome> {
    let mut script = Vec::new();
    // Into memory first: the generator panics when a pipe is closed.
    clap_complete::generate(args.shell, &mut Cli::command(), "objecthood", &mut script);
    terminal::print(&String::from_utf8(script).context("the script is not UTF-8")?)?;
    Ok(Outcome::AllDone)
}
