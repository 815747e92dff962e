//! `objecthood eval --tracks`: scores what a tracker says of videos.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use objecthood::Params;
use objecthood_eval::video::{ClipScore, TrueClip, VideoReport};
use objecthood_io::natural;

use crate::args::EvalArgs;
use crate::failure::{Outcome, usage};
use crate::{crew, terminal};

/// A clip: its name, the folder of its truth, the folder of what a tracker says.
struct Clip {
    name: String,
    truth: PathBuf,
    tracks: PathBuf,
}

/// Scores a clip, or every clip of a folder, and prints the figures. A clip that cannot be scored is reported and left out.
///
/// # Errors
/// Of usage; when the figures cannot be written.
pub(super) fn run(args: &EvalArgs, tracks: &Path, truth: &Path) -> Result<Outcome> {
    let clips = clips(tracks, truth)?;
    let bar = terminal::progress_bar(clips.len(), args.settings.verbose);
    let mut scores = Vec::new();
    let mut failed = 0;
    let score = |(): &mut (), clip: &Clip| {
        ClipScore::read(&clip.truth, &clip.tracks).with_context(|| clip.name.clone())
    };
    crew::in_order(&clips, args.settings.threads(), score, |clip, score| {
        bar.inc(1);
        match score {
            Ok(score) => scores.push((clip.name.clone(), score)),
            Err(e) => {
                failed += 1;
                bar.suspend(|| terminal::error(&e));
            }
        }
    })?;
    bar.finish_and_clear();
    if !scores.is_empty() {
        let report = VideoReport::new(&scores);
        super::publish(args, &report, &format!("{report}\n"), &Params::default())?;
    }
    if failed == 0 {
        return Ok(Outcome::AllDone);
    }
    if !scores.is_empty() {
        // Figures of some clips do not compare with those of all.
        let total = clips.len();
        terminal::complain(&format!("{failed} of {total} clips failed: the figures are those of the others"));
    }
    Ok(Outcome::SomeFailed)
}

/// The clip, or the clips in the folder, in the natural order of their names.
fn clips(tracks: &Path, truth: &Path) -> Result<Vec<Clip>> {
    if TrueClip::is_at(truth) {
        let name = truth
            .file_name()
            .map_or_else(|| truth.display().to_string(), |name| name.to_string_lossy().into_owned());
        return Ok(vec![Clip { name, truth: truth.to_owned(), tracks: tracks.to_owned() }]);
    }
    let entries = fs::read_dir(truth).with_context(|| format!("--truth {}", truth.display()))?;
    let mut folders: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    folders.retain(|folder| TrueClip::is_at(folder));
    folders.sort_by(|a, b| natural::compare(a.as_os_str(), b.as_os_str()));
    if folders.is_empty() {
        let advice =
            "name a folder that `objecthood synth --video` made, or the folder that holds such folders";
        return Err(usage(format!("--truth {} holds no clip.json: {advice}", truth.display())));
    }
    let clip = |folder: PathBuf| {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Clip { tracks: tracks.join(&name), truth: folder, name }
    };
    Ok(folders.into_iter().map(clip).collect())
}
