//! The command line: its subcommands and options. What they do is elsewhere.

mod batch;
mod doctor;
mod eval;
mod gravity;
mod images;
mod number;
mod output;
mod selection;
mod settings;
mod stream;
mod synthetic;
mod track;
mod view;

pub(crate) use batch::{BatchArgs, Engine};
pub(crate) use doctor::{ConvertArgs, DoctorArgs, InfoArgs, Target};
pub(crate) use eval::{ComparisonArgs, EvalArgs, SyntheticArgs};
pub(crate) use gravity::GravityArg;
pub(crate) use images::{CameraArg, ImageArgs, PairArgs, ScopeArgs};
pub(crate) use output::{OutputKind, Printed};
pub(crate) use selection::SelectionArgs;
pub(crate) use settings::{MethodName, Parameters, Settings, Threads};
pub(crate) use stream::StreamArgs;
pub(crate) use synthetic::{DemoArgs, SynthArgs};
pub(crate) use track::TrackArgs;
pub(crate) use view::ViewArgs;

use std::ffi::OsString;
use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Arg, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueHint};
use clap_complete::Shell;
use objecthood::Params;
use objecthood_io::camera_file::CameraFile;
use objecthood_io::scene::fingerprint;
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, Given};

use crate::inputs::Input;
use number::whole;

/// Said at the end of every `--help`.
const EXIT_CODES: &str = "\
Exit codes:
  0    every frame is done
  1    something failed: stderr says what failed and what to do; the other frames are done
  2    the command line or the configuration is wrong: nothing was done
  130  interrupted by Ctrl-C: the files of finished frames are complete";

/// Finds objects in RGB-D images: the things that can be grasped and moved.
///
/// There is nothing to train. From a single image objecthood finds surfaces, joins them into shapes, and decides which of
/// the shapes are objects.
#[derive(Debug, Parser)]
#[command(name = "objecthood", version, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// Reads the command line of the process.
    ///
    /// # Errors
    /// When it makes no sense; when it asks for help or version.
    pub(crate) fn read() -> Result<Self, clap::Error> {
        Self::of(std::env::args_os())
    }

    /// Reads the words of a command line, the name of the program first.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(crate) fn of(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut command = Self::command().mut_subcommands(|command| command.mut_args(take_what_follows));
        let matches = command.try_get_matches_from_mut(words)?;
        Self::from_arg_matches(&matches).map_err(|e| e.format(&mut command))
    }
}

/// Lets an option have a value that begins with `-`, so that it says itself what it takes: of `--threads -3` clap would say
/// that there is no option `-3`. Paths are left alone: a name may be forgotten, and the next option is not it.
fn take_what_follows(arg: Arg) -> Arg {
    let is_option = arg.get_long().is_some() && arg.get_action().takes_values();
    let is_path = arg.get_value_hint() != ValueHint::Unknown;
    arg.allow_hyphen_values(is_option && !is_path)
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Segment(SegmentArgs),
    Track(TrackArgs),
    Batch(BatchArgs),
    Doctor(DoctorArgs),
    Info(InfoArgs),
    Convert(ConvertArgs),
    Explain(ExplainArgs),
    View(ViewArgs),
    Eval(EvalArgs),
    Synth(SynthArgs),
    Params(ParamsArgs),
    Completions(CompletionsArgs),
}

impl Command {
    /// Whether to log how long every stage takes.
    pub(crate) fn is_verbose(&self) -> bool {
        match self {
            Self::Demo(args) => args.settings.verbose,
            Self::Segment(args) => args.settings.verbose,
            Self::Track(args) => args.settings.verbose,
            Self::Explain(args) => args.settings.verbose,
            Self::View(args) => args.settings.verbose,
            Self::Eval(args) => args.settings.verbose,
            Self::Params(args) => args.settings.verbose,
            Self::Doctor(args) => args.settings.verbose,
            Self::Synth(_) | Self::Info(_) | Self::Convert(_) | Self::Batch(_) | Self::Completions(_) => {
                false
            }
        }
    }

    /// How many threads to use; `None` where one does everything.
    pub(crate) fn threads(&self) -> Option<&Threads> {
        match self {
            Self::Demo(args) => Some(&args.settings.threads),
            Self::Segment(args) => Some(&args.settings.threads),
            Self::Track(args) => Some(&args.settings.threads),
            Self::Explain(args) => Some(&args.settings.threads),
            Self::View(args) => Some(&args.settings.threads),
            Self::Eval(args) => Some(&args.settings.threads),
            Self::Synth(args) => Some(&args.threads),
            Self::Doctor(args) => Some(&args.settings.threads),
            Self::Params(_) | Self::Info(_) | Self::Convert(_) | Self::Batch(_) | Self::Completions(_) => {
                None
            }
        }
    }
}

/// Which frames to read, and which part of them to use.
#[derive(Clone, Debug, Args)]
pub(crate) struct FrameArgs {
    #[arg(required_unless_present = "depth", conflicts_with = "depth", value_name = "INPUT", help = images::inputs_help())]
    pub(crate) inputs: Vec<PathBuf>,

    /// Camera of the frames: its numbers in pixels, or a file: JSON with fx, fy, cx, cy and optionally width, height and
    /// `depth_scale`, a camera of Open3D, ROS, RealSense or BOP, or a 3x3 matrix as text. Needed for depth images; optional for point clouds and TUM folders.
    #[arg(long, value_name = "FX,FY,CX,CY[,WIDTH,HEIGHT]|FILE", value_parser = CameraArg::parse)]
    pub(crate) camera: Option<CameraArg>,

    /// Direction in which things fall, in the camera frame (x right, y down, z forward), of any length, as an accelerometer
    /// at rest shows it with its sign changed; or `poses`: from the poses of a TUM folder, whose world has z up. Decides what is the ground.
    #[arg(long, value_name = "X,Y,Z|poses", value_parser = GravityArg::parse)]
    pub(crate) gravity: Option<GravityArg>,

    #[command(flatten)]
    pub(crate) selection: SelectionArgs,

    #[command(flatten)]
    pub(crate) images: ImageArgs,

    #[command(flatten)]
    pub(crate) scope: ScopeArgs,
}

impl FrameArgs {
    /// Reads a frame, without the pixels that the scope excludes and with the direction of gravity, if it is given.
    ///
    /// # Errors
    /// Whatever is wrong with the frame, and its path.
    pub(crate) fn read(&self, input: &Input, scope: &Scope) -> Result<Capture> {
        self.tell(input.open()?, scope).with_context(|| input.path.display().to_string())
    }

    /// The frame without the pixels that the scope excludes and with the direction of gravity, if it is given.
    ///
    /// # Errors
    /// When nothing is left to look at, or gravity is to be read from a pose that is not there.
    pub(crate) fn tell(&self, capture: Capture, scope: &Scope) -> Result<Capture> {
        let capture = scope.limit(capture)?;
        match self.gravity {
            Some(gravity) => gravity.set(capture),
            None => Ok(capture),
        }
    }

    /// What is known of every frame; `camera` is the content of the camera file.
    pub(crate) fn given(&self, camera: Option<&CameraFile>) -> Given {
        Given {
            camera: camera.map(|file| file.camera),
            depth_scale: self.images.depth_scale.or(camera.and_then(|file| file.depth_scale)),
            topics: self.selection.topics.clone(),
            max_pixels: self.images.max_pixels,
        }
    }

    /// In words, what decides the result of a frame beside its files: version, parameters, and what is said of all frames.
    ///
    /// # Errors
    /// When the file of the mask is not there.
    pub(crate) fn in_words(&self, params: &Params, camera: Option<&CameraFile>) -> Result<String> {
        let Self { gravity, images, scope, selection, .. } = self;
        let changed = |path| -> Result<_> { Ok(std::fs::metadata(path)?.modified()?) };
        let mask = scope.mask().map(changed).transpose()?;
        let version = env!("CARGO_PKG_VERSION");
        Ok(format!(
            "{version} {} {camera:?} {:?} {gravity:?} {scope:?} {mask:?} {:?}",
            fingerprint(params),
            images.depth_scale,
            selection.topics
        ))
    }

    /// A note for a user whose `--depth-scale` contradicts the camera file; `camera` is the content of that file.
    pub(crate) fn scale_note(&self, camera: Option<&CameraFile>) -> Option<String> {
        let (asked, said) = (self.images.depth_scale?, camera?.depth_scale?);
        let file = self.camera.as_ref().and_then(CameraArg::file)?;
        (asked != said).then(|| {
            let (times, file) = (said / asked, file.display());
            format!(
                "--depth-scale {asked} replaces the depth scale {said} of {file}: everything is {times} times as far \
                 away; if no object is found, leave --depth-scale out"
            )
        })
    }
}

/// Find the objects in frames; write label images, scene files and pictures.
///
/// For every frame NAME, DIR receives the files that --write asks for. A frame that fails leaves no file. With `- --format frames`
/// frames come by stdin, and each is answered by a line of JSON on stdout; docs/PIPE.md says how.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SegmentArgs {
    /// Folder for the output; created if needed.
    #[arg(long, value_name = "DIR", required_unless_present = "format")]
    pub(crate) out: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) stream: StreamArgs,

    /// Method to use [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    /// What to write for each frame, separated by commas.
    #[arg(long, value_name = "KINDS", value_delimiter = ',', default_value = "labels,points,json")]
    pub(crate) write: Vec<OutputKind>,

    /// Write DIR/report.html too: all frames with every stage as a layer, in space, with objects, parameters and times. It opens from the
    /// file, in any browser, without a network.
    #[arg(long)]
    pub(crate) report: bool,

    /// Repeat in DIR the folders of the inputs, from the folder down that all inputs share.
    #[arg(long)]
    pub(crate) keep_tree: bool,

    /// Go on where an earlier run into DIR ended: frames that it did are skipped, unless their files, the parameters or the version have
    /// changed. DIR/frames.jsonl tells how each frame ended; it stays, which it else does only when a run is cut off.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Also write DIR/summary.json: how many frames are done, how many failed and why, how many objects were found, how fast it was.
    #[arg(long)]
    pub(crate) summary: bool,

    #[command(flatten)]
    pub(crate) frames: FrameArgs,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Say why a pixel or an object is what it is, and which parameter would change that.
///
/// Explains one pixel of one frame: what it belongs to, how its surface (facet) fits, how the borders of that facet vote,
/// what every rule measured, and which single parameter, changed to which value, reverses a decision. Every such value has
/// been tried. With --out it also draws a picture, DIR/NAME.explain.png.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ExplainArgs {
    /// The pixel to explain: column and row, counted from 0.
    #[arg(long, value_name = "X,Y", value_parser = pixel, required_unless_present = "object", conflicts_with = "object")]
    pub(crate) at: Option<[usize; 2]>,

    /// The object to explain, by its number in the label image; the pixel is the middle of its largest facet.
    #[arg(long, value_name = "ID", value_parser = whole(1, u16::MAX))]
    pub(crate) object: Option<u16>,

    /// Instead of explaining, try every parameter, one at a time: which value would take the pixel out of its object, or give it one?
    #[arg(long)]
    pub(crate) repair: bool,

    /// With --repair, a second pixel: which value would make both one object, or part them?
    #[arg(long, value_name = "X,Y", value_parser = pixel, requires = "repair")]
    pub(crate) with: Option<[usize; 2]>,

    #[command(flatten)]
    pub(crate) printed: Printed,

    /// Folder for the picture; created if needed.
    #[arg(long, value_name = "DIR", conflicts_with = "repair")]
    pub(crate) out: Option<PathBuf>,

    /// Method to explain; only `context` can be explained [default: context].
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

/// Print every parameter with its default, range, unit, meaning and source.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct ParamsArgs {
    /// Print JSON.
    #[arg(long, conflicts_with = "toml")]
    pub(crate) json: bool,

    /// Print a commented file for --config, with the values that the other options give.
    #[arg(long)]
    pub(crate) toml: bool,

    #[command(flatten)]
    pub(crate) settings: Settings,
}

/// Print a script with which a shell completes commands.
///
/// For example: objecthood completions bash > ~/.local/share/bash-completion/completions/objecthood
#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell that will read the script.
    pub(crate) shell: Shell,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
