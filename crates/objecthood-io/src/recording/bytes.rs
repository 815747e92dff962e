//! Bytes that are read where they are needed, so that a recording of any length takes no memory.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use super::error::RecordingError;

/// The bytes of a file, on the disk or in memory.
pub(crate) trait Bytes: Send + Sync {
    /// How many there are.
    fn len(&self) -> u64;

    /// Those from `at` on that fill `into`.
    ///
    /// # Errors
    /// [`RecordingError::Read`]: they are not there, or the system does not give them.
    fn fill(&self, at: u64, into: &mut [u8]) -> Result<(), RecordingError>;
}

/// The `count` bytes from `at` on. Memory is taken only for bytes that are there.
///
/// # Errors
/// [`RecordingError::Cut`] when they are not.
pub(crate) fn read(bytes: &dyn Bytes, at: u64, count: u64) -> Result<Vec<u8>, RecordingError> {
    let end = at.checked_add(count).filter(|&end| end <= bytes.len());
    if end.is_none() {
        return Err(RecordingError::Cut { at: bytes.len() });
    }
    let mut content = vec![0; usize::try_from(count).map_err(|_| RecordingError::Cut { at })?];
    bytes.fill(at, &mut content)?;
    Ok(content)
}

/// A file, read at any place from any thread.
pub(crate) struct OnDisk {
    file: Mutex<File>,
    len: u64,
}

impl OnDisk {
    /// Opens a file.
    ///
    /// # Errors
    /// [`RecordingError::Read`].
    pub(crate) fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = File::open(path).and_then(|file| Ok((file.metadata()?.len(), file)));
        let (len, file) = file.map_err(|e| RecordingError::Read { reason: e.to_string() })?;
        Ok(Self { file: Mutex::new(file), len })
    }
}

impl Bytes for OnDisk {
    fn len(&self) -> u64 {
        self.len
    }

    fn fill(&self, at: u64, into: &mut [u8]) -> Result<(), RecordingError> {
        // A thread that panicked while it read left no half-done state: each reading begins with its own place.
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(into));
        read.map_err(|e| RecordingError::Read { reason: e.to_string() })
    }
}

impl Bytes for Vec<u8> {
    fn len(&self) -> u64 {
        Self::len(self) as u64
    }

    fn fill(&self, at: u64, into: &mut [u8]) -> Result<(), RecordingError> {
        let from = usize::try_from(at).ok().and_then(|at| self.get(at..)?.get(..into.len()));
        into.copy_from_slice(from.ok_or(RecordingError::Cut { at })?);
        Ok(())
    }
}

/// Small readings one after the other, which often lie near each other.
pub(crate) struct Window<'a> {
    bytes: &'a dyn Bytes,
    at: u64,
    content: Vec<u8>,
}

impl<'a> Window<'a> {
    /// Bytes that are read at a time: a few lists of messages, and little beside a seek.
    const BYTES: u64 = 4096;

    pub(crate) fn new(bytes: &'a dyn Bytes) -> Self {
        Self { bytes, at: 0, content: Vec::new() }
    }

    /// The `count` bytes from `at` on; `None` when the file ends before.
    ///
    /// # Errors
    /// [`RecordingError::Read`].
    pub(crate) fn get(&mut self, at: u64, count: usize) -> Result<Option<&[u8]>, RecordingError> {
        let Some(end) = at.checked_add(count as u64).filter(|&end| end <= self.bytes.len()) else {
            return Ok(None);
        };
        if at < self.at || end > self.at + self.content.len() as u64 {
            let wanted = Self::BYTES.max(count as u64).min(self.bytes.len() - at);
            self.content = read(self.bytes, at, wanted)?;
            self.at = at;
        }
        let from = (at - self.at) as usize;
        Ok(self.content.get(from..from + count))
    }
}
