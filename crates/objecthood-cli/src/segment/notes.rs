//! What is noted of frames: the first time in full, and at the end of how many more frames it is to be said.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::inputs::Input;
use crate::terminal;
use crate::words::counted;

/// What was noted, by where the frames are from, and what the note says before its figures.
#[derive(Default)]
pub(super) struct Notes(BTreeMap<(PathBuf, String), Note>);

struct Note {
    /// The frame that had it first.
    first: String,
    /// How many more have it.
    more: usize,
}

impl Notes {
    /// Takes the notice of a frame, and says it if it is the first of its kind in the recording or folder of the frame.
    pub(super) fn take(&mut self, input: &Input, notice: &str) {
        if self.is_new(input.origin(), &input.title(), notice) {
            terminal::note(&format!("{}: {notice}", input.title()));
        }
    }

    fn is_new(&mut self, origin: &Path, frame: &str, notice: &str) -> bool {
        let kind = (origin.to_owned(), before_figures(notice).to_owned());
        let known = self.0.get_mut(&kind).map(|note| note.more += 1);
        if known.is_none() {
            self.0.insert(kind, Note { first: frame.to_owned(), more: 0 });
        }
        known.is_none()
    }

    /// Says of how many more frames the same is to be said.
    pub(super) fn sum_up(self) {
        self.texts().iter().for_each(|text| terminal::note(text));
    }

    fn texts(&self) -> Vec<String> {
        let more = self.0.iter().filter(|(_, note)| note.more > 0);
        more.map(|((_, clause), Note { first, more })| {
            format!("{clause} ..: so in {} after {first}", counted(*more, "more frame"))
        })
        .collect()
    }
}

/// The beginning of a notice, up to the first figure, bracket or colon: it is the same for all frames.
fn before_figures(notice: &str) -> &str {
    let end = notice.find(|c: char| c.is_ascii_digit() || ":(".contains(c)).unwrap_or(notice.len());
    notice[..end].trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_many_frames_have_in_common_is_summed_up_without_figures() {
        let mut notes = Notes::default();
        for (frame, notice) in [
            ("a.png", "it is not clear which surface is the ground: taken is the one 0.95 m from the camera"),
            ("b.png", "edges were smeared over several pixels (3.1 % of the pixels with depth)"),
            ("c.png", "it is not clear which surface is the ground: taken is the one 0.97 m from the camera"),
            ("d.png", "it is not clear which surface is the ground: taken is the one 1.02 m from the camera"),
            ("d.png", "edges were smeared over several pixels (2.2 % of the pixels with depth)"),
            ("d.png", "the frame has no colour"),
        ] {
            notes.is_new(Path::new("in"), frame, notice);
        }
        assert!(notes.is_new(Path::new("other"), "e.png", "the frame has no colour"), "of another folder");
        assert_eq!(
            notes.texts(),
            [
                "edges were smeared over several pixels ..: so in 1 more frame after b.png",
                "it is not clear which surface is the ground ..: so in 2 more frames after a.png"
            ]
        );
    }
}
