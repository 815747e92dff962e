//! The command line of objecthood. It parses, calls the libraries and prints; it computes nothing.
//!
//! One file per subcommand. Each turns its arguments into one typed plan before it does anything, so that a mistake on the
//! command line is reported before the first file is written.

mod advice;
mod args;
mod batch;
mod completions;
mod config;
mod convert;
mod crew;
mod demo;
mod doctor;
mod eval;
mod explain;
mod failure;
mod info;
mod inputs;
mod interrupt;
mod outputs;
mod params;
mod record;
mod segment;
mod shell;
mod synth;
mod synthetic;
mod terminal;
mod track;
mod view;
mod watch;
mod words;

use std::process::ExitCode;

use crate::args::{Cli, Command, Threads};
use crate::failure::{Outcome, exit_code};

fn main() -> ExitCode {
    let cli = match Cli::read() {
        Ok(cli) => cli,
        Err(e) => {
            // Help and version come this way too. A reader that closed the pipe has read enough.
            let _ = e.print();
            return if e.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    if cli.command.is_verbose() {
        terminal::log_to_stderr();
    }
    if let Some(note) = cli.command.threads().and_then(Threads::note) {
        terminal::note(&note);
    }
    match run(&cli.command) {
        Ok(Outcome::AllDone) => ExitCode::SUCCESS,
        Ok(Outcome::SomeFailed) => ExitCode::FAILURE,
        Ok(Outcome::Interrupted) => ExitCode::from(interrupt::EXIT_CODE),
        Err(e) => {
            terminal::error(&e);
            ExitCode::from(exit_code(&e))
        }
    }
}

/// Does what a command says.
///
/// # Errors
/// Those of the command.
fn run(command: &Command) -> anyhow::Result<Outcome> {
    match command {
        Command::Demo(args) => demo::run(args),
        Command::Segment(args) => segment::run(args),
        Command::Track(args) => track::run(args),
        Command::Batch(args) => batch::run(args),
        Command::Doctor(args) => doctor::run(args),
        Command::Info(args) => info::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Explain(args) => explain::run(args),
        Command::View(args) => view::run(args),
        Command::Eval(args) => eval::run(args),
        Command::Synth(args) => synth::run(args),
        Command::Params(args) => params::run(args),
        Command::Completions(args) => completions::run(args),
    }
}
