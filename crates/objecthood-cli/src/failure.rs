//! How a command ends: outcomes, errors of usage, exit codes.

use std::fmt;

/// How the frames ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Every frame is done: exit code 0.
    AllDone,
    /// Some failed and were reported: exit code 1.
    SomeFailed,
    /// The user pressed Ctrl-C before all were done: exit code 130, as shells have it.
    Interrupted,
}

/// The command line or the configuration is wrong, so nothing was done: exit code 2.
#[derive(Debug)]
struct Usage(String);

impl fmt::Display for Usage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Usage {}

/// An error of usage; `message` says what is wrong and what to do.
pub(crate) fn usage(message: impl Into<String>) -> anyhow::Error {
    Usage(message.into()).into()
}

/// The exit code that tells the caller what kind of error it was.
pub(crate) fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Usage>() { 2 } else { 1 }
}
