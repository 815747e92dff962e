//! Folders that are searched for files of the formats on the list.

use std::path::Path;

use walkdir::{DirEntry, WalkDir};

use super::{FrameRef, file};
use crate::error::{Error, Result};
use crate::formats::extensions;
use crate::given::Given;
use crate::natural;

/// The frames in a folder and those below it, in natural order. Each file is opened when its turn comes.
pub(super) fn search(folder: &Path, given: Given) -> impl Iterator<Item = Result<FrameRef>> + Send + use<> {
    let searched = folder.to_owned();
    let entries = WalkDir::new(folder).sort_by(|a, b| natural::compare(a.file_name(), b.file_name()));
    entries.into_iter().filter_map(move |entry| match entry {
        Ok(entry) if is_frame(&entry) => Some(file::open(entry.path(), &given)),
        Ok(_) => None,
        Err(error) => Some(Err(said_of_folder(error, &searched))),
    })
}

/// What the labels of points end in, which `objecthood segment` writes; they are no input of a later run.
const POINT_LABELS: &str = ".labels.pcd";

/// Whether an entry is a file, perhaps by a link, with an ending that is looked for.
fn is_frame(entry: &DirEntry) -> bool {
    let extension = entry.path().extension().unwrap_or_default();
    let is_output = entry.file_name().as_encoded_bytes().ends_with(POINT_LABELS.as_bytes());
    !is_output && extensions().any(|e| extension.eq_ignore_ascii_case(e)) && entry.path().is_file()
}

/// A folder that cannot be listed.
fn said_of_folder(error: walkdir::Error, searched: &Path) -> Error {
    let folder = error.path().unwrap_or(searched).to_owned();
    // Only links that lead in circles have no reason from the system, and links are not followed.
    let reason = error.into_io_error().unwrap_or_else(|| std::io::ErrorKind::Other.into());
    Error::List { reason }.at(&folder)
}
