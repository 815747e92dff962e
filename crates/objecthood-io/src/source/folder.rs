//! Folders that are searched for files of the formats on the list.

use std::path::Path;

use walkdir::{DirEntry, WalkDir};

use super::{FrameRef, Source, file};
use crate::error::{Error, Result};
use crate::formats::extensions;
use crate::given::Given;
use crate::natural;

/// The frames in a folder and those below it, in natural order. Each file is opened when its turn comes.
pub(super) fn search(folder: &Path, given: &Given) -> impl Iterator<Item = Result<FrameRef>> + Send + use<> {
    let (searched, given) = (folder.to_owned(), given.clone());
    let entries = WalkDir::new(folder).sort_by(|a, b| natural::compare(a.file_name(), b.file_name()));
    entries.into_iter().flat_map(move |entry| match entry {
        Ok(entry) if is_frame(&entry) => file::open(entry.path(), &given).unwrap_or_else(Source::failed),
        Ok(_) => Source::listed(Vec::new()),
        Err(error) => Source::failed(said_of_folder(error, &searched)),
    })
}

/// What the names of files end in, before their ending, that hold what `objecthood segment` found: they are no input of a later run.
const LABELS: &str = ".labels";

/// Whether an entry is a file, perhaps by a link, with an ending that is looked for.
fn is_frame(entry: &DirEntry) -> bool {
    let extension = entry.path().extension().unwrap_or_default();
    let stem = entry.path().file_stem().unwrap_or_default();
    let is_output = stem.as_encoded_bytes().ends_with(LABELS.as_bytes());
    !is_output && extensions().any(|e| extension.eq_ignore_ascii_case(e)) && entry.path().is_file()
}

/// A folder that cannot be listed.
fn said_of_folder(error: walkdir::Error, searched: &Path) -> Error {
    let folder = error.path().unwrap_or(searched).to_owned();
    // Only links that lead in circles have no reason from the system, and links are not followed.
    let reason = error.into_io_error().unwrap_or_else(|| std::io::ErrorKind::Other.into());
    Error::List { reason }.at(&folder)
}
