//! The only place that writes to stdout and stderr.

use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::time::Duration;

use anyhow::{Result, anyhow};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::advice;

/// Prints results to stdout.
///
/// A reader that closed the pipe has read enough; that is no error.
///
/// # Errors
/// When stdout cannot be written for any other reason.
pub(crate) fn print(text: &str) -> Result<()> {
    print_to_reader(text).map(drop)
}

/// Prints to stdout; whether there is still a reader.
///
/// # Errors
/// When stdout cannot be written although it is not closed.
pub(crate) fn print_to_reader(text: &str) -> Result<bool> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(e) => Err(anyhow!("cannot write to the standard output ({e}): send it elsewhere")),
    }
}

/// Prints an error to stderr, on one line, with the option that helps.
pub(crate) fn error(error: &anyhow::Error) {
    complain(&format!("error: {error:#}{}", advice::of(error)));
}

/// Prints to stderr what the user should know although it is no error, on one line.
pub(crate) fn note(text: &str) {
    complain(&format!("note: {text}"));
}

/// Prints one line to stderr. If that fails there is no way left to report it.
pub(crate) fn complain(message: &str) {
    // File names and file contents may hold anything, even line ends and commands to the terminal.
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

/// A bar on stderr that shows how many of `total` items are done, how many a second, how long the rest takes, and its message; hidden for a single one, off a terminal, and beside a
/// log.
pub(crate) fn progress_bar(total: usize, verbose: bool) -> ProgressBar {
    if total < 2 || verbose {
        return ProgressBar::hidden();
    }
    let write_left = |state: &ProgressState, out: &mut dyn fmt::Write| {
        // What cannot be written cannot be shown.
        let _ = out.write_str(&left(state.pos(), state.per_sec(), state.eta()));
    };
    let bar = ProgressBar::new(total as u64);
    match ProgressStyle::with_template("{bar:40} {pos} of {len} done{left}{msg}") {
        Ok(style) => bar.with_style(style.with_key("left", write_left)),
        Err(_) => bar,
    }
}

/// How many items are done a second and how long the rest takes, in words. Empty before the first item is done: until then it is unknown.
fn left(done: u64, per_s: f64, eta: Duration) -> String {
    if done == 0 {
        return String::new();
    }
    let rate = format!(", {per_s:.1} a second");
    if eta.as_secs_f64().round() > 0.0 { format!("{rate}, {} left", HumanDuration(eta)) } else { rate }
}

/// A line on stderr that moves while one long step is under way; hidden off a terminal and beside a log. Says nothing
/// until it is given a message.
pub(crate) fn spinner(verbose: bool) -> ProgressBar {
    if verbose {
        return ProgressBar::hidden();
    }
    let spinner = ProgressBar::new_spinner();
    spinner.enable_steady_tick(Duration::from_millis(100));
    match ProgressStyle::with_template("{spinner} {msg} ({elapsed})") {
        Ok(style) => spinner.with_style(style),
        Err(_) => spinner,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bars began with "0s left".
    #[test]
    fn no_time_is_given_before_the_first_item_is_done() {
        assert_eq!(left(0, 0.0, Duration::ZERO), "");
        assert_eq!(left(0, 2.0, Duration::from_secs(9)), "");
        assert_eq!(left(3, 2.5, Duration::from_millis(300)), ", 2.5 a second");
        assert_eq!(left(3, 2.5, Duration::from_secs(9)), ", 2.5 a second, 9 seconds left");
    }
}
