//! Synthetic videos: a folder each.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use objecthood_io::output;
use objecthood_scene::video::{Clip, Video, film};
use objecthood_scene::{Sensor, export};

use crate::args::SynthArgs;
use crate::failure::Outcome;
use crate::outputs::{make_folder, make_folders_of};
use crate::shell::{program, word};
use crate::{crew, terminal};

/// Makes the videos named on the command line: first what happens in each, then the images of all.
///
/// # Errors
/// When the folder cannot be written; when stdout cannot be written. A video or an image that fails is reported, which is
/// no error.
pub(super) fn run(args: &SynthArgs, clips: &[Clip]) -> Result<Outcome> {
    make_folder(&args.out)?;
    let kinds: Vec<(Clip, u64)> = clips
        .iter()
        .flat_map(|&clip| (0..args.clips).map(move |k| (clip, u64::from(args.seed) + u64::from(k))))
        .collect();
    let mut videos = Vec::new();
    let bar = terminal::progress_bar(kinds.len(), false);
    let scripted = |(): &mut (), &(clip, seed): &(Clip, u64)| script(args, clip, seed);
    let told = |_: &(Clip, u64), made: Result<Made, &_>| {
        let Ok(made) = made else { return String::new() };
        let line = made.line();
        videos.push(made);
        line
    };
    let filmed = crew::report_in_order(&kinds, args.threads.count(), &bar, scripted, told)?
        .sum_up("scripts of videos", 0)?;

    let frames: Vec<(&Made, usize)> =
        videos.iter().flat_map(|made| (0..made.video.frames()).map(move |frame| (made, frame))).collect();
    let bar = terminal::progress_bar(frames.len(), false);
    let take = |(): &mut (), &(made, frame): &(&Made, usize)| made.write(frame, args.sensor);
    let shot = crew::report_in_order(&frames, args.threads.count(), &bar, take, |_, _| String::new())?
        .sum_up("frames", 0)?;
    if let ((Outcome::AllDone, Outcome::AllDone), Some(first)) = ((filmed, shot), videos.first()) {
        let tracks = args.out.join(format!("{}-tracks", first.name));
        let (program, clip, tracks) = (program(), word(&first.folder), word(&tracks));
        terminal::print(&format!("\nnext:\n  {program} track {clip} --out {tracks} --summary\n"))?;
    }
    Ok(if filmed == Outcome::AllDone { shot } else { filmed })
}

/// A video and its folder.
struct Made {
    name: String,
    folder: PathBuf,
    video: Video,
}

/// Makes a video and writes its lists.
fn script(args: &SynthArgs, clip: Clip, seed: u64) -> Result<Made> {
    let name = format!("{clip}{seed}");
    let mut video = film(clip, seed, args.fps)?;
    if let Some(size_px) = args.size {
        video = video.at_size(size_px)?;
    }
    let folder = args.out.join(&name);
    write_in(&folder, export::video_lists(&video, args.sensor).with_context(|| name.clone())?)?;
    Ok(Made { name, folder, video })
}

impl Made {
    /// What it is, as the user is told.
    fn line(&self) -> String {
        let (frames, events) = (self.video.frames(), self.video.truth().events.len());
        format!("{}: {frames} frames, {events} events -> {}\n", self.name, self.folder.display())
    }

    /// Takes the picture of a frame and writes its images: all or none.
    fn write(&self, frame: usize, sensor: Sensor) -> Result<()> {
        let named = || format!("{} frame {frame}", self.name);
        let rendered = self.video.render(frame, sensor).with_context(named)?;
        write_in(&self.folder, export::video_frame(&self.video, frame, &rendered).with_context(named)?)
    }
}

/// Writes files in a folder and those below it: all or none.
fn write_in(folder: &Path, files: Vec<(String, Vec<u8>)>) -> Result<()> {
    let files: Vec<_> = files.into_iter().map(|(name, bytes)| (folder.join(name), bytes)).collect();
    make_folders_of(&files)?;
    Ok(output::write_together(&files)?)
}
