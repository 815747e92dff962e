//! `track --resume`: how far a run came, and what its tracker knew then.

use std::path::{Path, PathBuf};
use std::{fs, io};

use anyhow::{Context, Result, anyhow, ensure};
use objecthood_io::output;
use objecthood_track::{Error, Event, Tracker};
use serde::{Deserialize, Serialize};

use super::cast::Cast;
use super::{Plan, Told};
use crate::inputs::Inputs;
use crate::terminal;

/// Its files in the folder for outputs.
const STATE: &str = "tracker.state";
const PROGRESS: &str = "progress.json";
const LISTS: [&str; 3] = ["tracks.jsonl", "events.jsonl", "support.jsonl"];
/// A state of an image of the greatest size that is read is smaller (bytes).
const MOST_STATE: u64 = 1 << 32;

/// How far a run came.
#[derive(Serialize, Deserialize)]
struct Progress {
    /// SHA-256 of the settings.
    settings: String,
    /// SHA-256 of all frames that were followed.
    frames: String,
    /// SHA-256 of the tracker's state.
    state: String,
    /// Frames followed, and such that failed.
    done: usize,
    failed: usize,
    /// What they are called.
    names: Vec<String>,
    last_stamp_s: Option<f64>,
    /// Bytes of the lists, without the events that the end of the video made certain.
    lists: [usize; 3],
    cast: Cast,
}

/// A run that goes on, or begins.
pub(super) struct Going {
    pub(super) tracker: Tracker,
    pub(super) told: Told,
    /// Frames that were followed, or failed.
    pub(super) done: usize,
}

impl Plan<'_> {
    /// With `--resume`: what decides the result, of each frame.
    pub(super) fn fingerprints(&self) -> Vec<String> {
        if !self.args.resume {
            return Vec::new();
        }
        let Inputs { frames, cameras, .. } = &self.inputs;
        // A frame that is missing fails when its turn comes.
        frames.iter().map(|frame| frame.fingerprint(&self.settings, cameras).unwrap_or_default()).collect()
    }

    /// The run as an earlier one left it, with `--resume` and if nothing has changed; else a new one. What an earlier run left that is of no
    /// use is removed.
    ///
    /// # Errors
    /// When that cannot be removed.
    pub(super) fn go_on(&self, fingerprints: &[String]) -> Result<Going> {
        let without = self.args.without.iter().flat_map(|named| named.0.iter().copied());
        let new = Tracker::new(self.params.clone()).without(without);
        if self.args.resume && self.has_earlier() {
            match self.earlier(fingerprints) {
                Ok(going) => {
                    let (done, total) = (going.done, fingerprints.len());
                    if done < total {
                        terminal::note(&format!(
                            "goes on with frame {done}: {done} of {total} were followed before"
                        ));
                    }
                    return Ok(going);
                }
                Err(reason) => {
                    self.remove_earlier()?;
                    terminal::note(&format!("begins anew with frame 0: {reason:#}"));
                }
            }
        }
        Ok(Going { tracker: new, told: Told::default(), done: 0 })
    }

    /// Whether a run with `--resume` left anything.
    fn has_earlier(&self) -> bool {
        [STATE, PROGRESS].iter().any(|name| self.args.out.join(name).exists())
    }

    /// # Errors
    /// Why the run cannot go on with what an earlier one left.
    fn earlier(&self, fingerprints: &[String]) -> Result<Going> {
        let progress = self.progress()?;
        let Progress { done, failed, last_stamp_s, .. } = progress;
        let followed = done.checked_add(failed).and_then(|count| fingerprints.get(..count));
        let followed = followed.context("more frames were followed than are asked for now")?;
        ensure!(
            progress.settings == self.settings_sum(),
            "the parameters, the options or the version have changed"
        );
        ensure!(progress.frames == sum(followed), "files that were followed have changed");
        let tracker = self.tracker(&progress)?;
        let mut told = Told { done, failed, last_stamp_s, cast: progress.cast, ..Told::default() };
        let lists = [&mut told.lines.tracks, &mut told.lines.events, &mut told.lines.support];
        for ((list, name), length) in lists.into_iter().zip(LISTS).zip(progress.lists) {
            let text = self.kept(name, |path| fs::read_to_string(path))?;
            list.push_str(text.get(..length).with_context(|| damaged(&self.args.out.join(name)))?);
        }
        let events = told.lines.events.lines().map(serde_json::from_str::<Event>);
        told.events =
            events.collect::<Result<_, _>>().with_context(|| damaged(&self.args.out.join(LISTS[1])))?;
        Ok(Going { tracker, told, done: followed.len() })
    }

    fn progress(&self) -> Result<Progress> {
        let bytes = self.kept(PROGRESS, |path| fs::read(path))?;
        // What the parser says of a file that no one writes by hand is of no use.
        serde_json::from_slice(&bytes).map_err(|_| anyhow!("{}", damaged(&self.args.out.join(PROGRESS))))
    }

    fn tracker(&self, progress: &Progress) -> Result<Tracker> {
        let path = self.args.out.join(STATE);
        ensure!(fs::metadata(&path).map_or(0, |state| state.len()) < MOST_STATE, damaged(&path));
        let state = self.kept(STATE, |path| fs::read(path))?;
        ensure!(objecthood_io::sha256(&state) == progress.state, damaged(&path));
        Tracker::restore(self.params.clone(), &state).map_err(|error| match error {
            Error::State { reason } => anyhow!("{}: {reason}", path.display()),
            other => anyhow!("{}: {other}", path.display()),
        })
    }

    /// The content of a file that an earlier run left.
    fn kept<T>(&self, name: &str, read: impl Fn(&Path) -> io::Result<T>) -> Result<T> {
        let path = self.args.out.join(name);
        read(&path).map_err(|e| anyhow!("{} cannot be read ({e})", path.display()))
    }

    /// Removes what an earlier run left: state, lists, and the images of the frames that it followed, as far as it can be told which, and of
    /// those that are given now.
    fn remove_earlier(&self) -> Result<()> {
        let lists = [STATE, PROGRESS].into_iter().chain(LISTS).map(|name| self.args.out.join(name));
        let followed = self.progress().map_or_else(|_| Vec::new(), |progress| progress.names);
        // Whoever wrote the file, nothing is removed elsewhere.
        let followed =
            followed.into_iter().map(PathBuf::from).filter(|name| name.file_name() == Some(name.as_os_str()));
        let given = self.inputs.frames.iter().map(|input| input.name.clone());
        let images = followed.chain(given).flat_map(|name| [self.label_image(&name), self.picture(&name)]);
        lists.chain(images).try_for_each(|path| match fs::remove_file(&path) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => {
                Err(anyhow!("cannot remove {} of an earlier run ({e}): choose another --out", path.display()))
            }
            _ => Ok(()),
        })
    }

    /// Keeps what the tracker knows, before the end of the video makes more certain. `unreadable`: files without a frame, which are not part
    /// of what failed in its turn.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn keep(
        &self,
        tracker: &Tracker,
        told: &Told,
        unreadable: usize,
        fingerprints: &[String],
    ) -> Result<()> {
        let state = tracker.save()?;
        let failed = told.failed - unreadable;
        let count = told.done + failed;
        let followed = &self.inputs.frames[..count];
        let progress = Progress {
            settings: self.settings_sum(),
            frames: sum(&fingerprints[..count]),
            state: objecthood_io::sha256(&state),
            done: told.done,
            failed,
            names: followed.iter().map(|input| input.name.to_string_lossy().into_owned()).collect(),
            last_stamp_s: told.last_stamp_s,
            lists: [&told.lines.tracks, &told.lines.events, &told.lines.support].map(String::len),
            cast: told.cast.clone(),
        };
        let path = |name: &str| self.args.out.join(name);
        let progress = serde_json::to_vec(&progress)?;
        Ok(output::write_together(&[(path(STATE), state), (path(PROGRESS), progress)])?)
    }

    /// SHA-256 of the settings.
    fn settings_sum(&self) -> String {
        objecthood_io::sha256(self.settings.as_bytes())
    }
}

/// SHA-256 of the fingerprints of frames.
fn sum(fingerprints: &[String]) -> String {
    objecthood_io::sha256(fingerprints.concat().as_bytes())
}

fn damaged(path: &Path) -> String {
    format!("{} is damaged, or of another version", path.display())
}
