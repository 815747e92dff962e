//! Folders of ROS 2 bags: `metadata.yaml` names the files of one recording, in their order.
//!
//! Source: `rosbag2_storage`.

use std::path::{Path, PathBuf};

use super::{FolderFormat, Format, read_head, tell_recording};
use crate::error::{Error, Result};
use crate::given::Given;
use crate::recording::{self, Opener};
use crate::source::Source;

pub(super) const FORMAT: Format = Format::Folder(FolderFormat { is_mine, open });

const METADATA: &str = "metadata.yaml";

/// The most bytes of the file: it has some hundred for each topic and file.
const MAX_METADATA: u64 = 16 << 20;

fn is_mine(folder: &Path) -> bool {
    metadata(folder).is_some_and(|text| text.contains("rosbag2_bagfile_information"))
}

fn metadata(folder: &Path) -> Option<String> {
    let path = folder.join(METADATA);
    let is_small = std::fs::metadata(&path).is_ok_and(|file| file.is_file() && file.len() <= MAX_METADATA);
    is_small.then(|| std::fs::read_to_string(path).ok()).flatten()
}

/// # Errors
/// [`Error::At`] the folder or a file: it cannot be read, or what is wrong with it.
fn open(folder: &Path, given: &Given) -> Result<Source> {
    let text = metadata(folder).ok_or_else(|| Error::NoFrames.at(folder))?;
    let files = names(&text).map(|name| told(&folder.join(name))).collect::<Result<Vec<_>>>()?;
    if files.is_empty() {
        return Err(Error::NoFrames.at(folder));
    }
    recording::open(folder, &files, given).map_err(|error| error.at(folder))
}

/// The names on the list `relative_file_paths`. The file is written by one program, so its list is read line by line.
fn names(metadata: &str) -> impl Iterator<Item = &str> {
    let after =
        metadata.lines().skip_while(|line| !line.trim_start().starts_with("relative_file_paths:")).skip(1);
    after.map_while(move |line| {
        let line: &str = line;
        line.trim_start().strip_prefix("- ").map(|name| name.trim().trim_matches(['"', '\'']))
    })
}

/// A file and how it is opened.
fn told(path: &Path) -> Result<(PathBuf, Opener)> {
    let head = std::fs::File::open(path)
        .map_err(|reason| Error::Read { reason })
        .and_then(|mut f| read_head(&mut f));
    let format = head.and_then(|head| tell_recording(&head).ok_or(Error::UnknownFormat { looks_like: None }));
    format.map(|format| (path.to_owned(), format.log)).map_err(|error| error.at(path))
}
