//! The options of `objecthood eval`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use objecthood_io::GridCamera;
use objecthood_scene::{Family, Holes, Sensor};

use super::EXIT_CODES;
use super::number::whole;
use super::settings::{MethodName, Settings};

/// Score a method, or label images that you have, on a data set with ground truth.
///
/// ROOT holds folders of labelled point clouds laid out like the data set mOSD, or is the data set OSD, OCID or one in the layout of BOP
/// with masks of visible objects. With --family and --support no data set is
/// needed: they score objects, or what stands on what, in synthetic scenes. With --tracks and --truth it scores what `track`, or any
/// other program, says of videos.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct EvalArgs {
    /// Folder of the data set.
    #[arg(value_name = "ROOT", required_unless_present_any = ["support", "family", "tracks"])]
    pub(crate) root: Option<PathBuf>,

    /// Which of its folders to score: learn, test, any other name, or all. Of OSD the beginning of the names, of OCID the first folder.
    #[arg(long, value_name = "FOLDER", default_value = "all")]
    pub(crate) split: String,

    /// Method to score [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) comparison: ComparisonArgs,

    /// Also score N harder scenes, composed of tables and objects of the data set (folder `composite`).
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        value_parser = whole(0, u32::MAX),
        conflicts_with = "labels",
        group = "made"
    )]
    pub(crate) composites: u32,

    /// Score the support forest of `context` instead, on N synthetic scenes whose contacts are known: stacks, vessels,
    /// hidden objects, tables and clutter in equal parts.
    #[arg(
        long,
        value_name = "N",
        value_parser = whole(1_u32, 1_000_000),
        conflicts_with_all = ["root", "labels", "ComparisonArgs", "pictures", "plots", "camera", "per_scene", "split"],
        group = "made"
    )]
    pub(crate) support: Option<u32>,

    #[command(flatten)]
    pub(crate) synthetic: SyntheticArgs,

    /// Score tracks of objects through videos instead: a folder with labels/<stem>.png and, if there are, events.jsonl and
    /// support.jsonl, as `track` writes it; or a folder of such folders.
    #[arg(
        long,
        value_name = "DIR",
        requires = "truth",
        conflicts_with_all = ["root", "labels", "ComparisonArgs", "pictures", "plots", "camera", "per_scene", "split", "made"]
    )]
    pub(crate) tracks: Option<PathBuf>,

    /// The video with its truth, as `synth --video` writes it; or a folder of such folders with the same names.
    #[arg(long, value_name = "DIR", requires = "tracks")]
    pub(crate) truth: Option<PathBuf>,

    /// Number of the first composed or synthetic scene; the others follow it.
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u32::MAX), requires = "made")]
    pub(crate) seed: u32,

    /// Score the label images DIR/<scene><suffix> instead of running a method.
    #[arg(long, value_name = "DIR")]
    pub(crate) labels: Option<PathBuf>,

    /// How the names of the label images go on after the name of the scene.
    #[arg(long, value_name = "S", default_value = ".labels.png", requires = "labels")]
    pub(crate) suffix: String,

    /// Write the figures to a JSON file.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,

    /// Draw the hardest scenes, one picture each: colour, the results of both methods, ground truth.
    ///
    /// The hardest are the 12 scenes with most objects that are not correct; of two equal ones, the one with more
    /// objects. DIR is created if needed.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["labels", "ComparisonArgs"])]
    pub(crate) pictures: Option<PathBuf>,

    /// Draw the figures as SVG: precision over recall and the time of each stage, or with --ladder, --ablation or --sensitivity the
    /// settings beside each other.
    ///
    /// Of a sensitivity the 30 settings are drawn that change most. DIR is created if needed.
    #[arg(long, value_name = "DIR", conflicts_with = "labels")]
    pub(crate) plots: Option<PathBuf>,

    /// Write a report: one HTML file with the figures and plots, and of a method the 12 hardest scenes with all layers.
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,

    /// Print a line for every scene.
    #[arg(long)]
    pub(crate) per_scene: bool,

    /// Camera of the scenes, in pixels [default: what the files say or their points fit; else the Kinect that took mOSD].
    #[arg(long, value_name = "FX,FY,CX,CY[,WIDTH,HEIGHT]")]
    pub(crate) camera: Option<GridCamera>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// What is compared instead of scoring one setting.
#[derive(Clone, Copy, Debug, Args)]
#[group(multiple = false, conflicts_with = "labels")]
pub(crate) struct ComparisonArgs {
    /// Compare depth only with colour for the first two stages and for all; with `paper` colour, depth and both, each with and
    /// without curvature.
    #[arg(long)]
    pub(crate) ablation: bool,

    /// Switch on the steps of the method one after the other, then leave out each one alone (only `context`).
    #[arg(long)]
    pub(crate) ladder: bool,

    /// Change every parameter that the method reads, one at a time: numbers by 30 % down and up, choices to their other
    /// values.
    #[arg(long)]
    pub(crate) sensitivity: bool,
}

/// Synthetic scenes that are scored instead of a data set.
#[derive(Clone, Debug, Args)]
pub(crate) struct SyntheticArgs {
    /// Score synthetic scenes of this kind instead, or of all kinds, and print a line for each kind and sensor; `synth
    /// --help` lists them.
    #[arg(
        long,
        value_name = "NAME|all",
        value_parser = one_or_all(Family::ALL),
        conflicts_with_all = ["root", "labels", "ComparisonArgs", "pictures", "plots", "camera", "per_scene", "split"],
        group = "made"
    )]
    pub(crate) family: Option<Chosen<Family>>,

    /// Depth camera that takes the pictures: kinect, stereo, tof, ideal, phone, structured-light or all.
    #[arg(
        long,
        value_name = "NAME|all",
        default_value = "kinect",
        value_parser = one_or_all(Sensor::ALL),
        requires = "family",
        conflicts_with_all = ["root", "support"]
    )]
    pub(crate) sensor: Chosen<Sensor>,

    /// Number of scenes of each kind.
    #[arg(long, value_name = "N", default_value_t = 20, requires = "family", conflicts_with_all = ["root", "support"])]
    #[arg(value_parser = whole(1_u32, 1_000_000))]
    pub(crate) scenes: u32,

    /// What else takes depth away: none, or a grid of single pixels as registration to a larger image leaves.
    #[arg(long, value_name = "NAME", default_value_t = Holes::None, requires = "family", conflicts_with_all = ["root", "support"])]
    pub(crate) holes: Holes,
}

/// What an option names that takes one or all.
#[derive(Clone, Debug)]
pub(crate) struct Chosen<T>(pub(crate) Vec<T>);

/// Reads one of them, or `all`.
fn one_or_all<T: FromStr + Clone, const N: usize>(
    all: [T; N],
) -> impl Fn(&str) -> Result<Chosen<T>, T::Err> + Clone {
    move |text| Ok(Chosen(if text == "all" { all.to_vec() } else { vec![text.parse()?] }))
}
