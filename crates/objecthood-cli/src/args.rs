//! What can be said on the command line, and nothing of what is done with it.

mod images;
mod synthetic;

pub(crate) use images::{CameraArg, ImageArgs, ScopeArgs};
pub(crate) use synthetic::{DemoArgs, SynthArgs};

use std::path::PathBuf;

use clap::builder::RangedU64ValueParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use objecthood_io::GridCamera;

/// Said at the end of every `--help`.
const EXIT_CODES: &str = "\
Exit codes:
  0  every frame is done
  1  something failed: it is named on stderr with what to do; the other frames are done
  2  the command line or the configuration is wrong: nothing was done";

/// Finds the objects in RGB-D images: what in them can be grasped and moved.
///
/// Nothing is learned and nothing is known beforehand about the objects: surfaces are found in one image, joined to
/// convex shapes, and shapes that something carries are objects.
#[derive(Debug, Parser)]
#[command(name = "objecthood", version, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Segment(SegmentArgs),
    Explain(ExplainArgs),
    Eval(EvalArgs),
    Synth(SynthArgs),
    Params(ParamsArgs),
    Completions(CompletionsArgs),
}

impl Command {
    /// Whether to log the time of every stage.
    pub(crate) fn is_verbose(&self) -> bool {
        match self {
            Self::Demo(args) => args.settings.verbose,
            Self::Segment(args) => args.settings.verbose,
            Self::Explain(args) => args.settings.verbose,
            Self::Eval(args) => args.settings.verbose,
            Self::Params(args) => args.settings.verbose,
            Self::Synth(_) | Self::Completions(_) => false,
        }
    }
}

/// What every subcommand takes that runs a method.
#[derive(Debug, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct Settings {
    /// Read parameters from a TOML file; `objecthood params --toml` prints one.
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,

    /// Set one parameter, over the file; may be repeated, the last one wins.
    #[arg(long, value_name = "STAGE.PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,

    /// Keep every hypothesis with its objectness, also what is no object.
    #[arg(long)]
    pub(crate) all: bool,

    #[command(flatten)]
    threads: Threads,

    /// Log the time of every stage.
    #[arg(short, long)]
    pub(crate) verbose: bool,
}

impl Settings {
    /// How many threads to use.
    pub(crate) fn threads(&self) -> usize {
        self.threads.count()
    }
}

/// How many threads to use.
#[derive(Debug, Args)]
pub(crate) struct Threads {
    /// Threads to use [default: one per core].
    #[arg(long, value_name = "N", value_parser = RangedU64ValueParser::<usize>::new().range(1..=1024))]
    threads: Option<usize>,
}

impl Threads {
    pub(crate) fn count(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    }
}

/// Which frames, and what of them is looked at.
#[derive(Debug, Args)]
pub(crate) struct FrameArgs {
    #[arg(required_unless_present = "depth", conflicts_with = "depth", value_name = "INPUT", help = images::inputs_help())]
    pub(crate) inputs: Vec<PathBuf>,

    /// Camera of the frames: its numbers in pixels, or a JSON file with fx, fy, cx, cy and perhaps width, height and
    /// the depth scale. Depth images and unorganized clouds need it; organized clouds and TUM folders may have their own.
    #[arg(long, value_name = "FX,FY,CX,CY[,WIDTH,HEIGHT]|FILE", value_parser = CameraArg::parse)]
    pub(crate) camera: Option<CameraArg>,

    #[command(flatten)]
    pub(crate) images: ImageArgs,

    #[command(flatten)]
    pub(crate) scope: ScopeArgs,
}

/// Find the objects in frames and write them as label images, scene files and pictures.
///
/// For every frame: DIR/<stem>.labels.png, a 16-bit image with 0 = none and 1.. = objects; DIR/<stem>.json, the scene;
/// DIR/<stem>.structure.png, the table and other large planes as a second label image; DIR/<stem>.panels.png, pictures of
/// every stage. A frame that fails leaves nothing.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SegmentArgs {
    /// Folder to write to; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Way of finding objects [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    /// What to write for each frame.
    #[arg(long, value_name = "KINDS", value_delimiter = ',', default_value = "labels,json")]
    pub(crate) write: Vec<OutputKind>,

    /// Lay the outputs out in DIR as the inputs lie in the folder common to all of them.
    #[arg(long)]
    pub(crate) keep_tree: bool,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Say why a pixel, or an object, is what it is: its facet, the votes of its borders, what each rule measured, and which
/// single parameter, changed how far, would decide otherwise.
///
/// Everything that is said of a parameter was tried. With --out a picture too: DIR/<stem>.explain.png.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ExplainArgs {
    /// The pixel: its column and row.
    #[arg(long, value_name = "X,Y", value_parser = pixel, required_unless_present = "object", conflicts_with = "object")]
    pub(crate) at: Option<[usize; 2]>,

    /// The object with this number in the label image, at the middle of its largest facet.
    #[arg(long, value_name = "ID", value_parser = RangedU64ValueParser::<u16>::new().range(1..=65535))]
    pub(crate) object: Option<u16>,

    /// As JSON.
    #[arg(long)]
    pub(crate) json: bool,

    /// Folder to write a picture to; made if it is not there.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Way of finding objects; only that of `context` can be explained [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// A column and a row.
fn pixel(text: &str) -> Result<[usize; 2], String> {
    let parse = |part: &str| part.trim().parse::<usize>().ok();
    let pixel = text.split_once(',').and_then(|(u, v)| Some([parse(u)?, parse(v)?]));
    pixel.ok_or_else(|| "give a column and a row, counted from 0, as in 320,240".to_owned())
}

/// Score a method, or existing label images, on a data set with truth.
///
/// ROOT holds folders of labelled point clouds in the manner of mOSD. Without it, --support scores what stands on what.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct EvalArgs {
    /// The data set.
    #[arg(value_name = "ROOT", required_unless_present = "support")]
    pub(crate) root: Option<PathBuf>,

    /// Which of its folders: learn, test, any other name, or all.
    #[arg(long, value_name = "FOLDER", default_value = "all")]
    pub(crate) split: String,

    /// Way of finding objects [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    #[command(flatten)]
    pub(crate) comparison: ComparisonArgs,

    /// Score N scenes besides that are composed of the tables and objects of these, more densely: the folder `composite`.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        hide_default_value = true,
        conflicts_with = "labels",
        group = "made"
    )]
    pub(crate) composites: u32,

    /// Score the support forest instead, on N synthetic scenes of stacks, vessels, hidden things, tables and clutter in
    /// equal parts, against the contacts that they were made with (`context`).
    #[arg(
        long,
        value_name = "N",
        value_parser = RangedU64ValueParser::<u32>::new().range(1..=1_000_000),
        conflicts_with_all = ["root", "labels", "ComparisonArgs", "pictures", "camera", "per_scene", "split"],
        group = "made"
    )]
    pub(crate) support: Option<u32>,

    /// The first composed or synthetic scene; the others follow.
    #[arg(long, value_name = "S", default_value_t = 0, requires = "made")]
    pub(crate) seed: u32,

    /// Score the label images DIR/<scene><suffix> instead of running a method.
    #[arg(long, value_name = "DIR")]
    pub(crate) labels: Option<PathBuf>,

    /// What follows the name of the scene in the names of the label images.
    #[arg(long, value_name = "S", default_value = ".labels.png", requires = "labels")]
    pub(crate) suffix: String,

    /// Write the figures to a file as JSON.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,

    /// Draw the hardest scenes, one picture each: colour, what either method finds, truth.
    ///
    /// The 12 scenes with most objects that are not correct, of equals those with most objects; made if it is not there.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["labels", "ComparisonArgs"])]
    pub(crate) pictures: Option<PathBuf>,

    /// Print a line for every scene.
    #[arg(long)]
    pub(crate) per_scene: bool,

    /// Camera of the scenes, in pixels; the data set knows its own.
    #[arg(long, value_name = "FX,FY,CX,CY[,WIDTH,HEIGHT]")]
    pub(crate) camera: Option<GridCamera>,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// What is compared instead of scoring one setting.
#[derive(Clone, Copy, Debug, Args)]
#[group(multiple = false, conflicts_with = "labels")]
pub(crate) struct ComparisonArgs {
    /// Compare colour, depth and both, each with and without curvature (`paper`).
    #[arg(long)]
    pub(crate) ablation: bool,

    /// Switch the steps of the method on one after the other, then leave out each alone (`context`).
    #[arg(long)]
    pub(crate) ladder: bool,

    /// Change every parameter that the method reads, each alone: numbers by 30 % down and up, choices to their other values.
    #[arg(long)]
    pub(crate) sensitivity: bool,
}

/// Print every parameter with default, range, unit, meaning and source.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ParamsArgs {
    /// As JSON.
    #[arg(long, conflicts_with = "toml")]
    pub(crate) json: bool,

    /// As a commented file for --config, with the values in force.
    #[arg(long)]
    pub(crate) toml: bool,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Print a script by which a shell completes the command line.
///
/// For example: objecthood completions bash > ~/.local/share/bash-completion/completions/objecthood
#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell that is to read it.
    pub(crate) shell: Shell,
}

/// The methods by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Surfaces fitted in disparity, and what their borders and surroundings tell (the default).
    Context,
    /// The published method, equation by equation.
    Paper,
}

/// What can be written for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub(crate) enum OutputKind {
    /// 16-bit label image.
    Labels,
    /// Scene file.
    Json,
    /// 16-bit label image of the large planes: table, floor, wall.
    Structure,
    /// Pictures of every stage.
    Panels,
}

impl OutputKind {
    /// What follows the name of the frame in the name of the file.
    pub(crate) fn suffix(self) -> &'static str {
        match self {
            Self::Labels => ".labels.png",
            Self::Json => ".json",
            Self::Structure => ".structure.png",
            Self::Panels => ".panels.png",
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
