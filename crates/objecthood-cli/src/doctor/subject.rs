//! What is judged as one: clocks and numbers of two recordings have nothing to do with each other.

use std::path::Path;

use crate::inputs::{Input, Inputs};
use crate::words::counted;

/// A recording, a folder that was named, the frames that have files of their own, or what cannot be read.
pub(super) struct Subject<'a> {
    /// The recording or folder.
    place: Option<&'a Path>,
    pub(super) frames: Vec<&'a Input>,
    /// What is named but cannot be read.
    pub(super) unreadable: &'a [anyhow::Error],
}

impl<'a> Subject<'a> {
    /// The frames of `inputs`, which is what was `named`, in their order. What cannot be read comes last, or is told with the only input there is.
    pub(super) fn all_of(inputs: &'a Inputs, named: &'a [impl AsRef<Path>]) -> Vec<Self> {
        let folders: Vec<&Path> = named.iter().map(AsRef::as_ref).filter(|path| path.is_dir()).collect();
        let mut subjects: Vec<Self> = Vec::new();
        for input in &inputs.frames {
            let place = place_of(input, &folders);
            match subjects.iter_mut().find(|subject| subject.place == place) {
                Some(subject) => subject.frames.push(input),
                None => subjects.push(Self { place, frames: vec![input], unreadable: &[] }),
            }
        }
        let unreadable = inputs.unreadable.as_slice();
        match subjects.as_mut_slice() {
            [only] => only.unreadable = unreadable,
            _ if unreadable.is_empty() => {}
            _ => subjects.push(Self { place: None, frames: Vec::new(), unreadable }),
        }
        subjects
    }

    /// How it is called beside others.
    pub(super) fn title(&self) -> String {
        match (self.place, self.frames.as_slice()) {
            (Some(place), _) => place.display().to_string(),
            (None, []) => "what cannot be read".to_owned(),
            (None, [file]) => file.path.display().to_string(),
            (None, files) => format!("{} in files of their own", counted(files.len(), "frame")),
        }
    }
}

/// The recording or the folder that a frame is of.
fn place_of<'a>(input: &'a Input, folders: &[&'a Path]) -> Option<&'a Path> {
    let folder = || folders.iter().copied().find(|folder| input.path.starts_with(folder));
    if input.is_of_recording() { Some(&input.path) } else { folder() }
}
