//! The options of `objecthood demo` and `objecthood synth`.

use std::path::PathBuf;

use clap::Args;
use objecthood_scene::{Family, Holes, Sensor};

use super::number::whole;
use super::{EXIT_CODES, MethodName, Settings, Threads};

/// Try it without data: make a scene, find its objects, compare them with the truth.
///
/// DIR receives the scene as `objecthood synth` writes it, and what `objecthood segment` finds in it: a label image, a scene
/// file and pictures of every stage.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DemoArgs {
    /// Number of the scene; 34 is a table with seven objects.
    #[arg(long, value_name = "N", default_value_t = 34, value_parser = whole(0, u32::MAX))]
    pub(crate) seed: u32,

    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR", default_value = "objecthood-demo")]
    pub(crate) out: PathBuf,

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

    /// Kind of scenes: single, tabletop, stacked, occluded, vessels, clutter, room, shelf, bin, heap, bodies, robot-arm,
    /// empty-table, empty-room, flush, flush-alike, printed, thin, patterned, parts, contents or tools [default: the first
    /// six in turn].
    #[arg(long, value_name = "NAME")]
    pub(crate) family: Option<Family>,

    /// Depth camera that takes the pictures: kinect, stereo, tof, ideal, phone or structured-light.
    #[arg(long, value_name = "NAME", default_value_t = Sensor::Kinect)]
    pub(crate) sensor: Sensor,

    /// What else takes depth away: none, or a grid of single pixels as registration to a larger image leaves.
    #[arg(long, value_name = "NAME", default_value_t = Holes::None)]
    pub(crate) holes: Holes,

    /// Columns and rows of the images; the camera sees the same part of the scene [default: 640x480].
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<(usize, usize)>,

    #[command(flatten)]
    pub(crate) threads: Threads,
}

/// Columns and rows of an image.
fn size(text: &str) -> Result<(usize, usize), String> {
    const SIDES: std::ops::RangeInclusive<usize> = 16..=8192;
    let parse = |part: &str| part.trim().parse::<usize>().ok().filter(|side| SIDES.contains(side));
    let size = text.split_once('x').and_then(|(width, height)| Some((parse(width)?, parse(height)?)));
    size.ok_or_else(|| "give columns and rows, each from 16 to 8192, as in 1280x960".to_owned())
}
