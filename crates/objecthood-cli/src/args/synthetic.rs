//! What is said of synthetic scenes: which, and what is done with them.

use std::path::PathBuf;

use clap::Args;
use clap::builder::RangedU64ValueParser;
use objecthood_scene::{Family, Sensor};

use super::{EXIT_CODES, MethodName, Settings, Threads};

/// See what objecthood does, without any data: make a scene, find its objects, compare with what is there.
///
/// In DIR: the scene as `objecthood synth` writes it, and what `objecthood segment` makes of it: a label image, a scene
/// file, and pictures of every stage.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DemoArgs {
    /// Number of the scene [default: 34, a table with seven things]; with --check of the first [default: 0].
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u32>,

    /// Folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR", default_value = "objecthood-demo")]
    pub(crate) out: PathBuf,

    /// Score the method on many scenes instead, and write nothing.
    #[arg(long, conflicts_with = "out")]
    pub(crate) check: bool,

    /// How many scenes to score.
    #[arg(long, value_name = "N", default_value_t = 20, requires = "check")]
    #[arg(value_parser = RangedU64ValueParser::<u32>::new().range(1..=1_000_000))]
    pub(crate) scenes: u32,

    /// Kind of scenes to score: single, tabletop, stacked, occluded, vessels or clutter [default: each in turn].
    #[arg(long, value_name = "NAME", requires = "check")]
    pub(crate) family: Option<Family>,

    /// Way of finding objects [default: that of `segment`].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Make synthetic scenes with exact truth.
///
/// For every scene: DIR/<name>-color.png; DIR/<name>-depth.png, 16 bits, 10000 units a metre; DIR/<name>-truth.png and
/// DIR/<name>-surfaces.png, the instance and the face of every pixel; DIR/<name>-scene.json, what stands where, who
/// touches whom and how much of each is visible; DIR/<family>/<name>.pcd, points with labels in the manner of mOSD.
/// DIR/camera.json is the camera of all of them.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SynthArgs {
    /// Folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// How many scenes to make.
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<u32>::new().range(1..=1_000_000))]
    pub(crate) scenes: u32,

    /// Number of the first scene; the same number gives the same scene on every machine.
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u32,

    /// Kind of scenes: single, tabletop, stacked, occluded, vessels or clutter [default: each in turn].
    #[arg(long, value_name = "NAME")]
    pub(crate) family: Option<Family>,

    /// Depth camera that sees them: kinect, stereo, tof or ideal.
    #[arg(long, value_name = "NAME", default_value_t = Sensor::Kinect)]
    pub(crate) sensor: Sensor,

    #[command(flatten)]
    pub(crate) threads: Threads,
}
