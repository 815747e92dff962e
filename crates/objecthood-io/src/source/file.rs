//! Files that hold one frame.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use super::FrameRef;
use crate::capture::Capture;
use crate::error::{Error, Result};
use crate::formats::{decode, read_file, read_head, tell};
use crate::given::Given;

/// The frame of the file at `path`. Only its head is read, but all of what is no regular file: a pipe gives its bytes
/// once.
///
/// # Errors
/// [`Error::At`] the path: it cannot be read, [`Error::Empty`], [`Error::UnknownFormat`].
pub(super) fn open(path: &Path, given: &Given) -> Result<FrameRef> {
    let judge = |head: &[u8]| tell(head).map(drop);
    let (file, given) = (path.to_owned(), *given);
    if !path.is_file() {
        let bytes = read_file(path, judge).map_err(|e| e.at(path))?;
        return Ok(frame(path, move || decode(&bytes, &given).map_err(|e| e.at(&file))));
    }
    let head =
        File::open(path).map_err(|reason| Error::Read { reason }).and_then(|mut file| read_head(&mut file));
    head.and_then(|head| judge(&head)).map_err(|e| e.at(path))?;
    Ok(frame(path, move || {
        read_file(&file, judge).and_then(|bytes| decode(&bytes, &given)).map_err(|e| e.at(&file))
    }))
}

fn frame(path: &Path, load: impl Fn() -> Result<Capture> + Send + Sync + 'static) -> FrameRef {
    FrameRef {
        path: path.to_owned(),
        name: path.file_stem().unwrap_or(path.as_os_str()).to_owned(),
        color: None,
        stamp_ns: None,
        pose: None,
        is_metric: true,
        load: Arc::new(load),
    }
}
