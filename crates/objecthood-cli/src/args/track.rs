//! The options of `objecthood track`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use objecthood_track::Ingredient;

use super::settings::{MethodName, Settings};
use super::{EXIT_CODES, FrameArgs};

/// Follow objects through a video: identities that last, what stands on what, what happened.
///
/// The frames of INPUT are taken in their order. DIR receives labels/NAME.png, 16 bits a pixel, whose values are the numbers of
/// objects; tracks.jsonl, a line a frame; events.jsonl, a line an event; support.jsonl, a line for each thing that something holds.
/// Frames count from 0; parent 0 is the table, the floor, furniture.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct TrackArgs {
    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Method that finds the objects of each frame [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    /// Frames a second, where the frames have no times.
    #[arg(long, value_name = "F", default_value_t = 30.0, value_parser = frames_per_second)]
    pub(crate) fps: f64,

    /// Take the camera's motion from the poses of the source, as a TUM folder has them, instead of finding it.
    #[arg(long)]
    pub(crate) poses: bool,

    /// What to write beside the lists and the label images.
    #[arg(long, value_name = "KIND")]
    pub(crate) write: Option<TrackOutput>,

    /// Also write DIR/report.html: one file that shows the video with its tracks, at most 100 frames of it, and all that happened.
    #[arg(long, conflicts_with = "resume")]
    pub(crate) report: bool,

    /// At the end, write backwards what motion proved: parts that moved as one have one number from the first frame on, and things that came
    /// apart have two while they stood where they were parted.
    #[arg(long, conflicts_with = "resume")]
    pub(crate) smooth: bool,

    /// Tell what happened, in sentences.
    #[arg(long)]
    pub(crate) summary: bool,

    /// Go on where an earlier run with --resume into DIR was stopped or ended. Where files that it followed, the options or the version have
    /// changed, or what it kept is damaged or an image is missing, its lists are removed and the video is followed from its first frame. What the tracker knows
    /// is kept in DIR: tracker.state, and progress.json for how far it came.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Leave out ingredients of the method, to measure what each gains: camera, agents, motion, finding, holding, knowledge, steadying,
    /// separated by commas, or all: overlap with the last frame alone.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = ingredients, hide_possible_values = true)]
    pub(crate) without: Vec<Ingredients>,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// What can be written for every frame of a video. `segment` calls such a picture an overlay.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TrackOutput {
    /// pictures/NAME.png: each frame with its objects and a line of events.
    #[value(alias = "overlay")]
    Pictures,
}

/// One ingredient, or all.
#[derive(Clone, Debug)]
pub(crate) struct Ingredients(pub(crate) Vec<Ingredient>);

fn ingredients(name: &str) -> Result<Ingredients, String> {
    let named = Ingredient::ALL.into_iter().find(|ingredient| ingredient.name() == name);
    match (name, named) {
        ("all", _) => Ok(Ingredients(Ingredient::ALL.to_vec())),
        (_, Some(ingredient)) => Ok(Ingredients(vec![ingredient])),
        _ => Err(format!("there is {} and all", Ingredient::ALL.map(Ingredient::name).join(", "))),
    }
}

fn frames_per_second(text: &str) -> Result<f64, String> {
    let fps = text.parse::<f64>().ok().filter(|fps| (0.1..=1000.0).contains(fps));
    fps.ok_or_else(|| "give frames a second, from 0.1 to 1000".to_owned())
}
