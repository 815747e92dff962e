//! The options of `objecthood batch`.

use clap::{Args, ValueEnum};

use super::EXIT_CODES;
use super::images::PairArgs;
use super::number::whole;
use super::settings::{MethodName, Parameters};

/// Find the objects in an archive of frames on a cluster; write Parquet, a row a frame.
///
/// Paths may be URIs, s3:// and gs://. A frame that fails is a row with its error. What an earlier run into OUT did is not done again.
/// `RAY_ADDRESS` names a cluster; without it this machine does the work. docs/RAY.md has the rest.
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct BatchArgs {
    /// Files, folders in the layout of TUM, BOP or ROS 2, and folders of files.
    #[arg(required_unless_present = "depth", conflicts_with = "depth", value_name = "INPUT")]
    pub(crate) inputs: Vec<String>,

    #[command(flatten)]
    pub(crate) pairs: PairArgs,

    /// Folder or URI for the output.
    #[arg(long, value_name = "OUT")]
    pub(crate) out: String,

    /// What spreads the work. It is a package of Python: that of `OBJECTHOOD_PYTHON`, else of python3.
    #[arg(long, value_enum, default_value_t = Engine::Ray)]
    pub(crate) engine: Engine,

    /// Method to use [default: context].
    #[arg(long)]
    pub(crate) method: Option<MethodName>,

    /// Camera of the frames, as for `segment`: fx,fy,cx,cy or a file.
    #[arg(long, value_name = "FX,FY,CX,CY|FILE")]
    pub(crate) camera: Option<String>,

    /// Units of the depth images that are a metre.
    #[arg(long, value_name = "N")]
    pub(crate) depth_scale: Option<f64>,

    /// Topic of a recording to be read; may be repeated.
    #[arg(long = "topic", value_name = "NAME")]
    pub(crate) topics: Vec<String>,

    /// Number of workers [default: one per CPU of the cluster].
    #[arg(long, value_name = "N", value_parser = whole(1_usize, 100_000))]
    pub(crate) workers: Option<usize>,

    #[command(flatten)]
    pub(crate) parameters: Parameters,
}

/// What spreads the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Engine {
    /// Ray: on one machine or a cluster.
    Ray,
}
