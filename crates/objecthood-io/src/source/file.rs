//! Files that hold one frame, or a recording of many.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use super::{FrameRef, Source};
use crate::capture::Capture;
use crate::error::{Error, Result};
use crate::formats::{FrameFormat, HEAD_BYTES, decode, read_file, read_head, tell, tell_recording};
use crate::given::Given;
use crate::recording;

/// The frames of the file at `path`. Only its head is read, of a recording also the list of its messages, but all of what is no
/// regular file: a pipe gives its bytes once, so it holds one frame.
///
/// # Errors
/// [`Error::At`] the path: it cannot be read, [`Error::Empty`], [`Error::UnknownFormat`].
pub(super) fn open(path: &Path, given: &Given) -> Result<Source> {
    let judge = |head: &[u8]| tell(head).map(drop);
    let (file, known) = (path.to_owned(), given.clone());
    if !path.is_file() {
        let bytes = read_file(path, judge).map_err(|e| e.at(path))?;
        let format = tell(&bytes[..bytes.len().min(HEAD_BYTES)]).map_err(|e| e.at(path))?;
        return Ok(source(path, format, move || decode(&bytes, &known).map_err(|e| e.at(&file))));
    }
    let head =
        File::open(path).map_err(|reason| Error::Read { reason }).and_then(|mut file| read_head(&mut file));
    let head = head.map_err(|e| e.at(path))?;
    if let Some(format) = tell_recording(&head) {
        return recording::open(path, &[(path.to_owned(), format.log)], given).map_err(|e| e.at(path));
    }
    let format = tell(&head).map_err(|e| e.at(path))?;
    Ok(source(path, format, move || {
        read_file(&file, judge).and_then(|bytes| decode(&bytes, &known)).map_err(|e| e.at(&file))
    }))
}

fn source(
    path: &Path,
    format: &FrameFormat,
    load: impl Fn() -> Result<Capture> + Send + Sync + 'static,
) -> Source {
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_owned();
    let frame = FrameRef::new(path.to_owned(), name, Arc::new(load));
    Source::listed(vec![FrameRef { is_metric: format.is_metric, ..frame }])
}
