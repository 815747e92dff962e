//! The command line of objecthood. It parses, calls the libraries and prints; nothing is computed here.
//!
//! One subcommand a file. Each turns its arguments into one typed plan before anything is done, so that what is wrong
//! with the command line is said before the first file is written.

mod advice;
mod args;
mod completions;
mod config;
mod crew;
mod demo;
mod eval;
mod explain;
mod failure;
mod inputs;
mod outputs;
mod params;
mod segment;
mod shell;
mod synth;
mod synthetic;
mod terminal;
mod watch;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::failure::{Outcome, exit_code};

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(e) => {
            // Help and version come this way too. Whoever closed the pipe has read enough.
            let _ = e.print();
            return if e.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    if cli.command.is_verbose() {
        terminal::log_to_stderr();
    }
    let outcome = match &cli.command {
        Command::Demo(args) => demo::run(args),
        Command::Segment(args) => segment::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Eval(args) => eval::run(args),
        Command::Synth(args) => synth::run(args),
        Command::Params(args) => params::run(args),
        Command::Completions(args) => completions::run(args),
    };
    match outcome {
        Ok(Outcome::AllDone) => ExitCode::SUCCESS,
        Ok(Outcome::SomeFailed) => ExitCode::FAILURE,
        Err(e) => {
            terminal::error(&e);
            ExitCode::from(exit_code(&e))
        }
    }
}
