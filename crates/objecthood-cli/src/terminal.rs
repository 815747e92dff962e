//! The only place that writes to stdout and stderr.

use std::io::{self, IsTerminal, Write};

use anyhow::{Result, anyhow};
use indicatif::{ProgressBar, ProgressStyle};

use crate::advice;

/// Prints results to stdout.
///
/// A reader that has closed the pipe has read enough, which is no error.
///
/// # Errors
/// When stdout cannot be written for any other reason.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(anyhow!("cannot write to the standard output ({e}): send it elsewhere"))
        }
        _ => Ok(()),
    }
}

/// Prints an error to stderr, on one line, with the option that helps.
pub(crate) fn error(error: &anyhow::Error) {
    complain(&format!("error: {error:#}{}", advice::of(error)));
}

/// Prints one line to stderr. When even that fails nobody is left to be told.
pub(crate) fn complain(message: &str) {
    // Names of files and what is in them may hold anything, line ends and commands to the terminal among it.
    let _ = writeln!(io::stderr(), "{}", message.replace(char::is_control, " "));
}

/// Sends the log of all crates to stderr.
pub(crate) fn log_to_stderr() {
    tracing_subscriber::fmt()
        .with_max_level(tracing::Level::DEBUG)
        .with_writer(io::stderr)
        .with_ansi(io::stderr().is_terminal())
        .with_target(false)
        .without_time()
        .log_internal_errors(false)
        .init();
}

/// A bar on stderr that shows how many of `frames` are done; hidden for a single frame, off a terminal, and in the
/// company of a log.
pub(crate) fn progress_bar(frames: usize, verbose: bool) -> ProgressBar {
    if frames < 2 || verbose {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(frames as u64);
    match ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
