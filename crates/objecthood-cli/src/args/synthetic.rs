//! The options of `objecthood demo` and `objecthood synth`.

use std::path::PathBuf;

use clap::Args;
use objecthood_scene::{Family, Sensor};

use super::number::whole;
use super::{EXIT_CODES, MethodName, Settings, Threads};

/// Try it without data: make a scene, find its objects, compare them with the truth.
///
/// DIR receives the scene as `objecthood synth` writes it, and what `objecthood segment` finds in it: a label image, a scene
/// file and pictures of every stage.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DemoArgs {
    /// Number of the scene [default: 34, a table with seven objects]; with --check, of the first scene [default: 0].
    #[arg(long, value_name = "N", value_parser = whole(0, u32::MAX))]
    pub(crate) seed: Option<u32>,

    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR", default_value = "objecthood-demo")]
    pub(crate) out: PathBuf,

    /// Score the method on many scenes instead; nothing is written.
    #[arg(long, conflicts_with = "out")]
    pub(crate) check: bool,

    /// Number of scenes to score.
    #[arg(long, value_name = "N", default_value_t = 20, requires = "check")]
    #[arg(value_parser = whole(1_u32, 1_000_000))]
    pub(crate) scenes: u32,

    /// Kind of scenes to score: single, tabletop, stacked, occluded, vessels or clutter [default: each in turn].
    #[arg(long, value_name = "NAME", requires = "check")]
    pub(crate) family: Option<Family>,

    /// Method to use [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Make synthetic scenes with exact ground truth.
///
/// Every scene gives these files: DIR/<name>-color.png; DIR/<name>-depth.png, 16 bits, 10000 units per metre;
/// DIR/<name>-truth.png and DIR/<name>-surfaces.png, the object and the face that each pixel shows; DIR/<name>-scene.json,
/// where everything stands, what touches what, and how much of each object is visible; DIR/<family>/<name>.pcd, labelled
/// points as in the data set mOSD. DIR/camera.json is the camera of all scenes.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SynthArgs {
    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Number of scenes to make.
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1_000_000))]
    pub(crate) scenes: u32,

    /// Number of the first scene. The same number gives the same scene on every machine.
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u32::MAX))]
    pub(crate) seed: u32,

    /// Kind of scenes: single, tabletop, stacked, occluded, vessels or clutter [default: each in turn].
    #[arg(long, value_name = "NAME")]
    pub(crate) family: Option<Family>,

    /// Depth camera that takes the pictures: kinect, stereo, tof or ideal.
    #[arg(long, value_name = "NAME", default_value_t = Sensor::Kinect)]
    pub(crate) sensor: Sensor,

    #[command(flatten)]
    pub(crate) threads: Threads,
}
