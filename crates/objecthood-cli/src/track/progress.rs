//! `track --resume`: how far a run came, and what its tracker knew then.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use objecthood_io::output;
use objecthood_track::{Error, Event, Tracker};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use super::cast::Cast;
use super::files::{LISTS, Lines};
use super::{Plan, Told};
use crate::inputs::Inputs;
use crate::terminal;

/// Its files in the folder for outputs.
const STATE: &str = "tracker.state";
const PROGRESS: &str = "progress.json";
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
    last_stamp_s: Option<f64>,
    /// Columns and rows of the last frame.
    last_size: Option<(usize, usize)>,
    /// Bytes of the lists, without the events that the end of the video made certain.
    lists: [u64; 3],
    cast: Cast,
}

/// What a line of `tracks.jsonl` says of the images of its frame.
#[derive(Deserialize)]
struct Line {
    frame: usize,
    /// A frame of which nothing is said has none, and no picture.
    camera: Option<IgnoredAny>,
}

/// Why a run neither goes on nor begins anew: what the earlier one left may be of use.
#[derive(Debug)]
struct StillOfUse(String);

impl fmt::Display for StillOfUse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--resume cannot go on: {}", self.0)
    }
}

impl std::error::Error for StillOfUse {}

/// A run that goes on, or begins.
pub(super) struct Going {
    pub(super) tracker: Tracker,
    pub(super) told: Told,
    pub(super) lines: Lines,
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

    /// The run as an earlier one left it, with `--resume` and if nothing has changed; else a new one. Then the lists and the state of the earlier
    /// one are removed, and its images are written over as their frames are followed.
    ///
    /// # Errors
    /// When what the earlier run left may be of use; when it cannot be removed; when the lists cannot be written.
    pub(super) fn go_on(&self, fingerprints: &[String]) -> Result<Going> {
        let without = self.args.without.iter().flat_map(|named| named.0.iter().copied());
        let new = Tracker::new(self.params.clone()).without(without);
        if self.args.resume && self.has_earlier() {
            match self.earlier(fingerprints) {
                Ok(going) => {
                    let (done, total) = (going.done, fingerprints.len());
                    if (1..total).contains(&done) {
                        terminal::note(&format!(
                            "goes on with frame {done}: {done} of {total} were followed before"
                        ));
                    }
                    return Ok(going);
                }
                Err(reason) if reason.is::<StillOfUse>() => return Err(reason),
                Err(reason) => {
                    terminal::note(&format!("begins anew with frame 0: {reason:#}"));
                    self.remove_earlier()?;
                }
            }
        }
        Ok(Going { tracker: new, told: Told::default(), lines: Lines::begin(&self.args.out)?, done: 0 })
    }

    /// Whether a run with `--resume` left anything.
    fn has_earlier(&self) -> bool {
        [STATE, PROGRESS].iter().any(|name| self.args.out.join(name).exists())
    }

    /// # Errors
    /// Why the run cannot go on with what an earlier one left.
    fn earlier(&self, fingerprints: &[String]) -> Result<Going> {
        let progress = self.progress()?;
        ensure!(
            progress.settings == self.settings_sum(),
            "the parameters, the options or the version have changed"
        );
        let Progress { done, failed, last_stamp_s, last_size, .. } = progress;
        let count = done.saturating_add(failed);
        let fewer = || {
            let total = fingerprints.len();
            StillOfUse(format!(
                "{count} frames were followed, and {total} are given now: give all, or choose another --out"
            ))
        };
        let followed = fingerprints.get(..count).ok_or_else(fewer)?;
        ensure!(progress.cast.frames() <= count, damaged(&self.args.out.join(PROGRESS)));
        ensure!(progress.frames == sum(followed), "files that were followed have changed");
        let tracker = self.tracker(&progress)?;
        let mut told = Told { done, failed, last_stamp_s, last_size, cast: progress.cast, ..Told::default() };
        let mut lines = Lines::begin(&self.args.out).map_err(|e| StillOfUse(format!("{e:#}")))?;
        let ([tracks, events, support], [tracks_length, events_length, support_length]) =
            (LISTS, progress.lists);
        self.each_line(tracks, tracks_length, |line| {
            lines.tracks.append(line);
            self.check_images(line)
        })?;
        self.each_line(events, events_length, |line| {
            lines.events.append(line);
            let event: Event = serde_json::from_str(line)
                .map_err(|_| anyhow!("{}", damaged(&self.args.out.join(events))))?;
            told.events.push(event);
            Ok(())
        })?;
        self.each_line(support, support_length, |line| {
            lines.support.append(line);
            Ok(())
        })?;
        lines.check()?;
        Ok(Going { tracker, told, lines, done: followed.len() })
    }

    /// Hands over the lines in the first `length` bytes of a list that an earlier run left, one at a time.
    ///
    /// # Errors
    /// When the list is shorter, or cannot be read; those of `take`.
    fn each_line(&self, name: &str, length: u64, mut take: impl FnMut(&str) -> Result<()>) -> Result<()> {
        let mut rest = BufReader::new(self.kept(name, |path| File::open(path))?.take(length));
        let mut line = String::new();
        while self.kept(name, |_| rest.read_line(&mut line))? > 0 {
            take(&line)?;
            line.clear();
        }
        ensure!(rest.get_ref().limit() == 0, damaged(&self.args.out.join(name)));
        Ok(())
    }

    /// Whether the images of the frame in a line of `tracks.jsonl` are there. They are not opened, so that a long video goes on at once.
    ///
    /// # Errors
    /// When an image is missing, or the line is damaged.
    fn check_images(&self, line: &str) -> Result<()> {
        let is_damaged = || damaged(&self.args.out.join(LISTS[0]));
        let Line { frame, camera } = serde_json::from_str(line).map_err(|_| anyhow!("{}", is_damaged()))?;
        let name = &self.inputs.frames.get(frame).with_context(is_damaged)?.name;
        let has_picture = camera.is_some() && self.args.write.is_some();
        let mut images = [self.label_image(name)].into_iter().chain(has_picture.then(|| self.picture(name)));
        let missing: Option<PathBuf> = images.find(|image| !image.exists());
        missing.map_or(Ok(()), |image| Err(anyhow!("{} is missing", image.display())))
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
    fn kept<T>(&self, name: &str, read: impl FnOnce(&Path) -> io::Result<T>) -> Result<T> {
        let path = self.args.out.join(name);
        let said = |e: &io::Error| format!("{} cannot be read ({e})", path.display());
        read(&path).map_err(|e| match e.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::InvalidData => anyhow!("{}", said(&e)),
            _ => StillOfUse(said(&e)).into(),
        })
    }

    /// Removes the state and the lists that an earlier run left.
    fn remove_earlier(&self) -> Result<()> {
        [STATE].into_iter().chain(LISTS).chain([PROGRESS]).try_for_each(|name| {
            let path = self.args.out.join(name);
            match fs::remove_file(&path) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => {
                    Err(anyhow!("cannot remove {} ({e}): choose another --out", path.display()))
                }
                _ => Ok(()),
            }
        })
    }

    /// Writes the lists and keeps what the tracker knows. `unreadable`: files without a frame, which are not part of what failed in its turn.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn keep(
        &self,
        tracker: &Tracker,
        told: &Told,
        lines: &mut Lines,
        unreadable: usize,
        fingerprints: &[String],
    ) -> Result<()> {
        // A run that is killed here has longer lists than it needs.
        lines.keep()?;
        Ok(output::write_together(&self.state(tracker, told, lines, unreadable, fingerprints)?)?)
    }

    /// The files that say how far the run is and what the tracker knows, before the end of the video makes more certain. They belong behind the lists.
    ///
    /// # Errors
    /// When the state cannot be put into bytes.
    pub(super) fn state(
        &self,
        tracker: &Tracker,
        told: &Told,
        lines: &Lines,
        unreadable: usize,
        fingerprints: &[String],
    ) -> Result<[(PathBuf, Vec<u8>); 2]> {
        let state = tracker.save()?;
        let failed = told.failed - unreadable;
        let progress = Progress {
            settings: self.settings_sum(),
            frames: sum(&fingerprints[..told.done + failed]),
            state: objecthood_io::sha256(&state),
            done: told.done,
            failed,
            last_stamp_s: told.last_stamp_s,
            last_size: told.last_size,
            lists: lines.lengths(),
            cast: told.cast.clone(),
        };
        let path = |name: &str| self.args.out.join(name);
        let progress = serde_json::to_vec(&progress)?;
        Ok([(path(STATE), state), (path(PROGRESS), progress)])
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
