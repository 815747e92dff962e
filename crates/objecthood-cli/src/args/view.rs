//! What the live page takes.

use clap::Args;

use super::{EXIT_CODES, FrameArgs, MethodName, Settings};

/// Show frames on a page in the browser, stage by stage, while parameters are changed.
///
/// The page is served on this machine only, at an address that holds a secret: whoever is to see it needs the whole address that is
/// printed. Ctrl-C ends it. Where INPUT is `-`, frames come by stdin as docs/PIPE.md describes them: the page shows the newest until you
/// choose another, and keeps the last 100.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ViewArgs {
    /// Port on 127.0.0.1; 0 = any that is free.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) port: u16,

    /// Method to begin with [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}
