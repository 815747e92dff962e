//! `objecthood doctor`, `info` and `convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{EXIT_CODES, FrameArgs, Printed, Settings};

/// Say what an input is and what of it may be wrong: unit, camera, registration, resolution, missing frames.
///
/// Each recording and each folder is an input of its own; files that hold one frame are one input together. At most eight frames, spread
/// over the input, are looked at. A doubt is `sure` where no correct input looks like that, and `suspect`
/// where a rare one does; each names the option that mends it. Exit code 1 says that something is surely wrong.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DoctorArgs {
    #[command(flatten)]
    pub(crate) printed: Printed,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Say what is in an input: frames, stamps, size, camera, unit.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct InfoArgs {
    #[command(flatten)]
    pub(crate) printed: Printed,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,
}

/// Write an input in another format: a TUM or BOP folder, an MCAP recording, NPZ files.
///
/// Colours, camera, stamps and poses are kept. Depth is kept to the last bit in MCAP and NPZ, and in TUM and BOP where it is whole units
/// of a metre divided by 1000, 5000 or 10000; else a note says by how much it was rounded.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ConvertArgs {
    /// Format to write.
    #[arg(long, value_name = "FORMAT")]
    pub(crate) to: Target,

    /// The folder to write, created if needed; of mcap the file.
    #[arg(long, value_name = "PATH")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,
}

/// What an input can be converted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Target {
    /// A folder in the layout of the TUM RGB-D benchmark, with camera.json.
    Tum,
    /// A scene in the layout of BOP: rgb, depth, `scene_camera.json`.
    Bop,
    /// A recording of ROS 2 messages.
    Mcap,
    /// A file NAME.npz for every frame.
    Npz,
}
