//! The options of `objecthood eval`.

use std::path::PathBuf;

use clap::Args;
use objecthood_io::GridCamera;

use super::EXIT_CODES;
use super::number::whole;
use super::settings::{MethodName, Settings};

/// Score a method, or label images that you have, on a data set with ground truth.
///
/// ROOT holds folders of labelled point clouds laid out like the data set mOSD. With --support no data set is needed:
/// it scores what stands on what in synthetic scenes.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct EvalArgs {
    /// Folder of the data set.
    #[arg(value_name = "ROOT", required_unless_present = "support")]
    pub(crate) root: Option<PathBuf>,

    /// Which of its folders to score: learn, test, any other name, or all.
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
        conflicts_with_all = ["root", "labels", "ComparisonArgs", "pictures", "camera", "per_scene", "split"],
        group = "made"
    )]
    pub(crate) support: Option<u32>,

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

    /// Print a line for every scene.
    #[arg(long)]
    pub(crate) per_scene: bool,

    /// Camera of the scenes, in pixels [default: the Kinect that took mOSD].
    #[arg(long, value_name = "FX,FY,CX,CY[,WIDTH,HEIGHT]")]
    pub(crate) camera: Option<GridCamera>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// What is compared instead of scoring one setting.
#[derive(Clone, Copy, Debug, Args)]
#[group(multiple = false, conflicts_with = "labels")]
pub(crate) struct ComparisonArgs {
    /// Compare colour, depth and both, each with and without curvature (only `paper`).
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
