//! The lists that `track` writes: a line of JSON each.

use std::mem;
use std::path::Path;

use anyhow::Result;
use objecthood_io::output::Growing;
use objecthood_track::{Event, Relation, Rigid, SupportRelation, Tracked};
use serde_json::{Value, json};

/// The names of the lists: of tracks, events and what stands on what.
pub(super) const LISTS: [&str; 3] = ["tracks.jsonl", "events.jsonl", "support.jsonl"];

/// All lists. Their lines are written as they come, and not held in memory.
pub(super) struct Lines {
    pub(super) tracks: List,
    pub(super) events: List,
    pub(super) support: List,
}

/// A list that grows, and has its name once it is kept or finished.
pub(super) struct List {
    file: Growing,
    /// Bytes.
    length: u64,
    /// Whether all lines could be written so far. Behind one that could not there is none.
    written: objecthood_io::Result<()>,
}

impl List {
    fn begin(path: &Path) -> Result<Self> {
        Ok(Self { file: Growing::create(path)?, length: 0, written: Ok(()) })
    }

    /// Adds whole lines.
    pub(super) fn append(&mut self, lines: &str) {
        if self.written.is_ok() {
            self.written = self.file.append(lines.as_bytes());
            self.length += lines.len() as u64;
        }
    }

    fn push(&mut self, line: &Value) {
        self.append(&format!("{line}\n"));
    }

    /// What it says so far.
    ///
    /// # Errors
    /// When it could not be written, or cannot be read again.
    pub(super) fn values(&mut self) -> Result<Vec<Value>> {
        self.check()?;
        let mut text = Vec::new();
        self.file.copy_to(&mut text)?;
        Ok(serde_json::Deserializer::from_slice(&text).into_iter().collect::<Result<_, _>>()?)
    }

    /// Says this instead.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn replace(&mut self, lines: &[Value]) -> Result<()> {
        *self = Self::begin(self.file.path())?;
        lines.iter().for_each(|line| self.push(line));
        Ok(())
    }

    /// Whether all lines could be written.
    fn check(&mut self) -> objecthood_io::Result<()> {
        mem::replace(&mut self.written, Ok(()))
    }
}

impl Lines {
    /// Begins the lists in a folder.
    ///
    /// # Errors
    /// When one cannot be written.
    pub(super) fn begin(folder: &Path) -> Result<Self> {
        let [tracks, events, support] = LISTS.map(|name| List::begin(&folder.join(name)));
        Ok(Self { tracks: tracks?, events: events?, support: support? })
    }

    /// The lengths of the lists (bytes).
    pub(super) fn lengths(&self) -> [u64; 3] {
        [&self.tracks, &self.events, &self.support].map(|list| list.length)
    }

    /// The lists appear as they are now, and go on to grow.
    ///
    /// # Errors
    /// When one cannot be written, or could not be.
    pub(super) fn keep(&mut self) -> Result<()> {
        self.check()?;
        for list in [&mut self.tracks, &mut self.events, &mut self.support] {
            list.file.keep()?;
        }
        Ok(())
    }

    /// The lists appear.
    ///
    /// # Errors
    /// When one cannot be written, or could not be.
    pub(super) fn finish(mut self) -> Result<()> {
        self.check()?;
        Ok(Growing::finish_together([self.tracks.file, self.events.file, self.support.file])?)
    }

    /// Whether all lines could be written so far; told once.
    ///
    /// # Errors
    /// When one could not be written.
    pub(super) fn check(&mut self) -> objecthood_io::Result<()> {
        [&mut self.tracks, &mut self.events, &mut self.support].into_iter().try_for_each(List::check)
    }

    /// Adds what is said of a frame.
    pub(super) fn frame(&mut self, tracked: &Tracked) {
        let objects: Vec<_> = tracked
            .objects
            .iter()
            .filter_map(|object| {
                let track = object.track?;
                let area = object.box_px;
                Some(json!({
                    "track": track,
                    "state": object.state,
                    "center_m": object.center_m,
                    "pose": pose(&object.pose),
                    "velocity_m_per_s": object.velocity_m_per_s,
                    "motion": object.motion.map(|motion| json!({
                        "translation_m": motion.rigid.translation_m(),
                        "rotation_xyzw": motion.rigid.rotation_xyzw(),
                        "covariance": motion.covariance,
                        "fit": motion.fit,
                    })),
                    "box_px": [area.u, area.v, area.width, area.height],
                    "box_m": object.box_m.map(|box_m| json!({
                        "center_m": box_m.center_m,
                        "rotation_xyzw": box_m.rotation_xyzw,
                        "extents_m": box_m.extents_m,
                    })),
                    "size_px": object.size_px,
                    "objectness": object.objectness,
                    "parts": object.parts,
                    "held_by": tracked.support.iter().find(|edge| is_held(edge) && edge.child == track).map(|edge| edge.parent),
                    "evidence": object.seen_to,
                }))
            })
            .collect();
        let lost: Vec<_> = tracked
            .lost
            .iter()
            .map(|lost| {
                json!({ "track": lost.track, "state": lost.state, "center_m": lost.center_m, "pose": pose(&lost.pose), "for_s": lost.for_s })
            })
            .collect();
        let agents: Vec<_> = tracked
            .agents
            .iter()
            .map(|agent| {
                let area = agent.box_px;
                json!({ "track": agent.id, "size_px": agent.size_px, "box_px": [area.u, area.v, area.width, area.height] })
            })
            .collect();
        let line = json!({
            "frame": tracked.frame,
            "time": tracked.stamp_s,
            "objects": objects,
            "lost": lost,
            "agents": agents,
            "camera": {
                "translation_m": tracked.world_from_camera.translation_m(),
                "rotation_xyzw": tracked.world_from_camera.rotation_xyzw(),
                "covariance": tracked.camera_covariance,
            },
        });
        self.tracks.push(&line);
        for edge in tracked.support.iter().filter(|edge| !is_held(edge)) {
            let parent = edge.parent.map_or(0, |parent| parent.0);
            let line =
                json!({ "frame": tracked.frame, "child": edge.child, "parent": parent, "kind": edge.kind });
            self.support.push(&line);
        }
        for event in &tracked.events {
            self.event(event);
        }
    }

    /// Adds a frame of which nothing is said; `time_s`: when it was taken, if that is known.
    pub(super) fn blank(&mut self, frame: usize, time_s: Option<f64>) {
        let line = json!({ "frame": frame, "time": time_s, "objects": [], "lost": [], "agents": [], "camera": null });
        self.tracks.push(&line);
    }

    pub(super) fn event(&mut self, event: &Event) {
        self.events.push(&json!(event));
    }
}

/// Whether an agent holds a thing: that is said of the thing, and is no support.
fn is_held(edge: &SupportRelation) -> bool {
    edge.kind == Relation::Held
}

fn pose(rigid: &Rigid) -> Value {
    json!({ "position_m": rigid.translation_m(), "rotation_xyzw": rigid.rotation_xyzw() })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// All lines were in memory until the end: more than a gigabyte for an hour of video.
    #[test]
    fn lines_are_written_as_they_come() {
        let folder = tempfile::tempdir().unwrap();
        let on_disk = || -> u64 {
            let files = fs::read_dir(folder.path()).unwrap().flatten();
            files.map(|file| file.metadata().unwrap().len()).sum()
        };
        let mut lines = Lines::begin(folder.path()).unwrap();
        for frame in 0..1000 {
            lines.blank(frame, None);
        }
        let [length, ..] = lines.lengths();
        assert!(on_disk() + 10_000 > length && length > 50_000, "{} of {length} bytes", on_disk());
        assert!(
            LISTS.iter().all(|name| !folder.path().join(name).exists()),
            "none is there before it is whole"
        );
        assert_eq!(lines.tracks.values().unwrap().len(), 1000);
        lines.finish().unwrap();
        assert_eq!(on_disk(), length);
    }
}
