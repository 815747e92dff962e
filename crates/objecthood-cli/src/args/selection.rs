//! Which frames of a video or a recording are looked at.

use std::fmt;

use clap::Args;
use objecthood_io::{FrameRange, Selection, TimeRange};

/// Which frames of each input.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Videos and recordings")]
pub(crate) struct SelectionArgs {
    /// Take these frames of each input only, counted from 0: from FIRST up to, but not with, END, every STEP-th. Either end may be left out.
    #[arg(long, value_name = "FIRST..END[:STEP]")]
    frames: Option<FrameRange>,

    /// Take the frames of these times only, in seconds from the first frame of each input; either end may be left out.
    #[arg(long, value_name = "FIRST..END")]
    time: Option<TimeRange>,

    /// Topic of a recording to read, instead of one that is chosen by type: of depth, colour, or points; may be repeated.
    #[arg(long = "topic", value_name = "NAME")]
    pub(crate) topics: Vec<String>,
}

impl SelectionArgs {
    /// The frames that are asked for.
    pub(crate) fn selection(&self) -> Selection {
        Selection { frames: self.frames, time: self.time }
    }
}

/// As a sentence goes on: ` in --frames 3..9`; nothing when all frames are taken.
impl fmt::Display for SelectionArgs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let frames = self.frames.map(|frames| format!("--frames {frames}"));
        let time = self.time.map(|time| format!("--time {time}"));
        let asked: Vec<String> = frames.into_iter().chain(time).collect();
        if asked.is_empty() { Ok(()) } else { write!(f, " in {}", asked.join(" and ")) }
    }
}
