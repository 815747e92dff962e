//! What every subcommand takes that runs a method.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use objecthood::params::Profile;

use super::number::whole;
use crate::words::counted;

/// Parameters of a method.
#[derive(Debug, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct Parameters {
    /// Read parameters from a TOML file, such as the one that `objecthood params --toml` prints.
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,

    /// Set one parameter, as in objectness.threshold=0.6; may be repeated. It takes precedence over --config, and the
    /// last value of a parameter counts.
    #[arg(long, value_name = "GROUP.PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,

    /// Kind of the depth sensor: its published noise counts where a frame tells little of its own. Sets `sensor.profile`, and
    /// `sensor.lateral_noise_px` unless that is set too.
    #[arg(long, value_name = "SENSOR")]
    pub(crate) profile: Option<ProfileName>,

    /// Keep every hypothesis with its objectness, even where it is too low for an object.
    #[arg(long)]
    pub(crate) all: bool,
}

/// Parameters, and how the method runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Settings")]
pub(crate) struct Settings {
    #[command(flatten)]
    pub(crate) parameters: Parameters,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Log how long every stage takes.
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
    /// Number of threads, at most one per core [default: one per core].
    #[arg(long = "threads", value_name = "N", value_parser = whole(1_usize, 1024))]
    asked: Option<usize>,
}

impl Threads {
    /// As many as were asked for, but no more than there are cores: with a thousand threads on two cores one frame takes
    /// a minute.
    pub(crate) fn count(&self) -> usize {
        self.asked.unwrap_or(usize::MAX).min(cores())
    }

    /// A note for a user who asked for more threads than there are cores.
    pub(crate) fn note(&self) -> Option<String> {
        let (asked, cores) = (self.asked.filter(|&asked| asked > cores())?, cores());
        let there_are = counted(cores, "core");
        Some(format!("--threads {asked}: this machine has {there_are}, so {cores} will do the work"))
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The kinds of sensors by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProfileName {
    /// Kinect v1, Xtion: structured light.
    Kinect,
    /// RealSense D400: active stereo.
    Stereo,
    /// Azure Kinect, Kinect v2: time of flight.
    Tof,
    /// Phone: few measurements, made dense and smooth.
    Phone,
}

impl From<ProfileName> for Profile {
    fn from(name: ProfileName) -> Self {
        match name {
            ProfileName::Kinect => Self::Kinect,
            ProfileName::Stereo => Self::Stereo,
            ProfileName::Tof => Self::Tof,
            ProfileName::Phone => Self::Phone,
        }
    }
}

/// The methods by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Fits surfaces in disparity, and joins them by their borders and what surrounds them (the default).
    Context,
    /// The published method, equation by equation.
    Paper,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `--threads 1000` took a minute.
    #[test]
    fn no_more_threads_are_used_than_there_are_cores() {
        let threads = |asked| Threads { asked };
        assert_eq!(threads(None).count(), cores());
        assert_eq!(threads(Some(1)).count(), 1);
        assert_eq!(threads(Some(cores() + 1)).count(), cores());
        assert!(threads(None).note().is_none() && threads(Some(cores())).note().is_none());
        let note = threads(Some(1024.max(cores() + 1))).note().unwrap();
        assert!(note.starts_with("--threads ") && note.contains(" core"), "{note}");
    }
}
