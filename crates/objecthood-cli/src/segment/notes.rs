//! What is noted of frames: the first time in full, and at the end of how many more frames it is to be said.

use std::collections::BTreeMap;
use std::path::Path;

use crate::terminal;

/// What was noted, by its words without figures: the frame that had it first, what the note says before its figures, and how many more frames have it.
#[derive(Default)]
pub(super) struct Notes(BTreeMap<String, Note>);

struct Note {
    first: String,
    clause: String,
    more: usize,
}

impl Notes {
    /// Takes the notice of a frame, and says it if it is the first of its kind.
    pub(super) fn take(&mut self, frame: &Path, notice: &str) {
        let words = notice.chars().filter(|c| !c.is_ascii_digit() && *c != '.').collect();
        if let Some(note) = self.0.get_mut(&words) {
            note.more += 1;
            return;
        }
        let first = frame.display().to_string();
        terminal::note(&format!("{first}: {notice}"));
        let clause = notice.split(':').next().unwrap_or(notice).to_owned();
        self.0.insert(words, Note { first, clause, more: 0 });
    }

    /// Says of how many more frames the same is to be said.
    pub(super) fn sum_up(self) {
        for Note { first, clause, more } in self.0.into_values().filter(|note| note.more > 0) {
            let frames = if more == 1 { "frame has" } else { "frames have" };
            terminal::note(&format!("{more} more {frames} the note of {first}: {clause}"));
        }
    }
}
