//! `track --resume`: how far a run came, and what its tracker knew then.

use std::fs;

use anyhow::Result;
use objecthood_io::output;
use objecthood_track::{Event, Tracker};
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
    /// SHA-256 of the settings and of all frames that were followed.
    fingerprint: String,
    /// SHA-256 of the tracker's state.
    state: String,
    /// Frames followed, and such that failed.
    done: usize,
    failed: usize,
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

    /// The run as an earlier one left it, with `--resume` and if nothing has changed; else a new one.
    pub(super) fn go_on(&self, fingerprints: &[String]) -> Going {
        let without = self.args.without.iter().flat_map(|named| named.0.iter().copied());
        let new = Tracker::new(self.params.clone()).without(without);
        let earlier = if self.args.resume { self.earlier(fingerprints) } else { None };
        earlier.unwrap_or(Going { tracker: new, told: Told::default(), done: 0 })
    }

    fn earlier(&self, fingerprints: &[String]) -> Option<Going> {
        let path = |name: &str| self.args.out.join(name);
        let progress: Progress = serde_json::from_slice(&fs::read(path(PROGRESS)).ok()?).ok()?;
        let done = progress.done.checked_add(progress.failed)?;
        let is_same = done > 0 && progress.fingerprint == self.fingerprint(fingerprints.get(..done)?);
        let is_read = fs::metadata(path(STATE)).is_ok_and(|state| state.len() < MOST_STATE);
        if !is_same || !is_read {
            return None;
        }
        let state = fs::read(path(STATE)).ok()?;
        if objecthood_io::sha256(&state) != progress.state {
            return None;
        }
        let tracker = match Tracker::restore(self.params.clone(), &state) {
            Ok(tracker) => tracker,
            Err(e) => {
                terminal::note(&format!("{}: {e}", path(STATE).display()));
                return None;
            }
        };
        let mut told = Told {
            done: progress.done,
            failed: progress.failed,
            last_stamp_s: progress.last_stamp_s,
            ..Told::default()
        };
        let lists = [&mut told.lines.tracks, &mut told.lines.events, &mut told.lines.support];
        for ((list, name), length) in lists.into_iter().zip(LISTS).zip(progress.lists) {
            list.push_str(fs::read_to_string(path(name)).ok()?.get(..length)?);
        }
        told.cast = progress.cast;
        told.events =
            told.lines.events.lines().map(serde_json::from_str::<Event>).collect::<Result<_, _>>().ok()?;
        Some(Going { tracker, told, done })
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
        let progress = Progress {
            fingerprint: self.fingerprint(&fingerprints[..told.done + failed]),
            state: objecthood_io::sha256(&state),
            done: told.done,
            failed,
            last_stamp_s: told.last_stamp_s,
            lists: [&told.lines.tracks, &told.lines.events, &told.lines.support].map(String::len),
            cast: told.cast.clone(),
        };
        let path = |name: &str| self.args.out.join(name);
        let progress = serde_json::to_vec(&progress)?;
        Ok(output::write_together(&[(path(STATE), state), (path(PROGRESS), progress)])?)
    }

    /// Of the settings and of frames.
    fn fingerprint(&self, fingerprints: &[String]) -> String {
        objecthood_io::sha256((self.settings.clone() + &fingerprints.concat()).as_bytes())
    }
}
