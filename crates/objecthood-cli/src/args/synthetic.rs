//! The options of `objecthood demo` and `objecthood synth`.

use std::path::PathBuf;

use clap::Args;
use objecthood_scene::video::{self, Clip};
use objecthood_scene::{Family, Holes, Sensor};

use super::number::whole;
use super::{EXIT_CODES, MethodName, Settings, Threads};

/// Try it without data: make a scene, find its objects, compare them with the truth.
///
/// DIR receives the scene as `objecthood synth` writes it, and what `objecthood segment` finds in it: a label image, a scene
/// file and pictures of every stage. With --video, a video and what `objecthood track` finds in it.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct DemoArgs {
    /// Number of the scene; 34 is a table with seven objects.
    #[arg(long, value_name = "N", default_value_t = 34, value_parser = whole(0, u32::MAX))]
    pub(crate) seed: u32,

    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR", default_value = "objecthood-demo")]
    pub(crate) out: PathBuf,

    /// Make a video of this kind instead of a scene [default: pick], follow its objects, and compare them with the truth: runs
    /// `synth`, `track` and `eval` and shows each command, to be tried again with other options.
    #[arg(long, value_name = "KIND", num_args = 0..=1, require_equals = true, default_missing_value = "pick",
          conflicts_with_all = ["method", "Settings"])]
    pub(crate) video: Option<Clip>,

    /// Method to use [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Make synthetic scenes or videos with exact ground truth.
///
/// Every scene gives these files: DIR/<name>-color.png; DIR/<name>-depth.png, 16 bits, 10000 units per metre;
/// DIR/<name>-truth.png and DIR/<name>-surfaces.png, the object and the face that each pixel shows; DIR/<name>-scene.json,
/// where everything stands, what touches what, and how much of each object is visible; DIR/<family>/<name>.pcd, labelled
/// points as in the data set mOSD. DIR/camera.json is the camera of all scenes.
///
/// Every video gives a folder DIR/<name> with rgb.txt, depth.txt and groundtruth.txt as the TUM RGB-D benchmark has them,
/// camera.json, the images in color/ and depth/, who is seen at each pixel in truth/, and what is true of the clip, of its
/// frames, of what holds what, and of what happens: clip.json, truth.jsonl, support.jsonl, events.jsonl.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SynthArgs {
    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Number of scenes to make.
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1_000_000), required_unless_present = "video")]
    pub(crate) scenes: Option<u32>,

    /// Kind of videos to make instead of scenes, or all: static, empty, pick, push-flush, occluder, throw, drop, roll, twins,
    /// stack, unstack, lid, drawer, bowl, put-in, pour, sweep, two-agents, soft-toy or walker.
    #[arg(long, value_name = "KIND", value_parser = clips, conflicts_with_all = ["scenes", "family", "holes"])]
    pub(crate) video: Option<Clips>,

    /// Number of videos to make of each kind.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1_u32, 1000), requires = "video")]
    pub(crate) clips: u32,

    /// Frames a second of videos.
    #[arg(long, value_name = "F", default_value_t = 30.0, value_parser = fps, requires = "video")]
    pub(crate) fps: f64,

    /// Number of the first scene or video. The same number gives the same one on every machine.
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

/// Kinds of videos. A type of its own: `Vec` would mean an option that is given several times.
#[derive(Clone, Debug)]
pub(crate) struct Clips(pub(crate) Vec<Clip>);

/// A kind of videos, or all.
fn clips(text: &str) -> Result<Clips, String> {
    match text {
        "all" => Ok(Clips(Clip::ALL.to_vec())),
        name => {
            name.parse().map(|clip| Clips(vec![clip])).map_err(|e: objecthood_scene::Error| e.to_string())
        }
    }
}

/// Frames a second of a video.
fn fps(text: &str) -> Result<f64, String> {
    let rate = text.trim().parse().ok().filter(|rate| video::FPS.contains(rate));
    rate.ok_or_else(|| format!("give frames a second, {} to {}", video::FPS.start(), video::FPS.end()))
}

/// Columns and rows of an image.
fn size(text: &str) -> Result<(usize, usize), String> {
    const SIDES: std::ops::RangeInclusive<usize> = 16..=8192;
    let parse = |part: &str| part.trim().parse::<usize>().ok().filter(|side| SIDES.contains(side));
    let size = text.split_once('x').and_then(|(width, height)| Some((parse(width)?, parse(height)?)));
    size.ok_or_else(|| "give columns and rows, each from 16 to 8192, as in 1280x960".to_owned())
}
