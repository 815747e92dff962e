//! Frames that come by stdin.

use clap::{Args, ValueEnum};

/// Frames that come by stdin, while they are measured.
#[derive(Debug, Args)]
#[command(next_help_heading = "Frames by stdin")]
pub(crate) struct StreamArgs {
    /// Read frames from stdin, INPUT is `-`; no file is written.
    #[arg(long, value_name = "FORMAT", conflicts_with_all = ["out", "write", "keep_tree", "resume", "summary", "report", "color", "depth", "frames", "time", "topics"])]
    pub(crate) format: Option<StreamFormat>,

    /// When several frames wait, take the newest and drop the others; each answer counts them.
    #[arg(long, requires = "format", conflicts_with = "out")]
    pub(crate) latest: bool,
}

/// What can come by stdin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StreamFormat {
    /// Frames with their lengths before them, as docs/PIPE.md describes.
    Frames,
}
