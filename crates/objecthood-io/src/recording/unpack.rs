//! Chunks of a recording: packed messages.

use std::io::Read;
use std::sync::{Arc, Mutex, PoisonError};

use super::bytes::{Bytes, read};
use super::error::RecordingError;
use crate::text::preview;

/// The most bytes of a chunk. Recorders write chunks of some megabytes, or of one message, and the largest frames have less.
const MAX_UNPACKED: u64 = 96 << 20;

/// Chunks that are kept: messages of a frame stand in one or in two that follow each other.
const KEPT: usize = 2;

/// Where a packed chunk lies and how it is packed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Packed {
    /// Name of the compression.
    pub(crate) compression: Vec<u8>,
    /// Where its packed bytes begin, and how many there are.
    pub(crate) at: u64,
    pub(crate) packed: u64,
    /// How many bytes there are when unpacked, by the file.
    pub(crate) unpacked: u64,
}

impl Packed {
    pub(crate) fn is_plain(&self) -> bool {
        matches!(&self.compression[..], b"" | b"none")
    }

    /// The unpacked bytes. Memory is bounded by [`MAX_UNPACKED`], whatever the file claims or unpacks to.
    ///
    /// # Errors
    /// [`RecordingError`]: `Compression`, `TooLarge`, `Cut`, `Damaged`.
    pub(crate) fn unpack(&self, bytes: &dyn Bytes, format: &'static str) -> Result<Vec<u8>, RecordingError> {
        if self.unpacked > MAX_UNPACKED || self.packed > MAX_UNPACKED {
            return Err(RecordingError::TooLarge {
                bytes: self.unpacked.max(self.packed),
                most: MAX_UNPACKED,
            });
        }
        let packed = read(bytes, self.at, self.packed)?;
        if self.is_plain() {
            return Ok(packed);
        }
        let damaged = |problem: String| RecordingError::Damaged { format, at: self.at, problem };
        let bad = |reason: String| {
            damaged(format!("its chunk cannot be unpacked ({})", preview(reason.as_bytes())))
        };
        // It does not grow, as that would take room for the old and the new one at a time.
        let mut unpacked = Vec::with_capacity(self.unpacked as usize);
        let most = self.unpacked + 1;
        match &self.compression[..] {
            b"lz4" => lz4_flex::frame::FrameDecoder::new(&packed[..]).take(most).read_to_end(&mut unpacked),
            b"zstd" => ruzstd::decoding::StreamingDecoder::new(&packed[..])
                .map_err(|e| bad(e.to_string()))?
                .take(most)
                .read_to_end(&mut unpacked),
            b"bz2" => bzip2::read::BzDecoder::new(&packed[..]).take(most).read_to_end(&mut unpacked),
            other => return Err(RecordingError::Compression { found: preview(other) }),
        }
        .map_err(|e| bad(e.to_string()))?;
        if unpacked.len() as u64 == self.unpacked {
            Ok(unpacked)
        } else {
            Err(damaged(format!("its chunk is not of the {} bytes that it says", self.unpacked)))
        }
    }
}

/// The chunks that were unpacked last.
#[derive(Default)]
pub(crate) struct Unpacked(Mutex<Vec<(u64, Arc<Vec<u8>>)>>);

impl Unpacked {
    /// The content of the chunk at `at`, which `unpack` makes if it is not kept.
    ///
    /// # Errors
    /// Those of `unpack`.
    pub(crate) fn get(
        &self,
        at: u64,
        unpack: impl FnOnce() -> Result<Vec<u8>, RecordingError>,
    ) -> Result<Arc<Vec<u8>>, RecordingError> {
        // Held while it unpacks: threads that want the same chunk wait for it instead of unpacking it too.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, content)) = kept.iter().find(|(of, _)| *of == at) {
            return Ok(Arc::clone(content));
        }
        kept.truncate(KEPT - 1);
        // A large one is not kept beside the next, and beside a copy of a message.
        kept.retain(|(_, content)| Bytes::len(&**content) <= MAX_UNPACKED / 2);
        let content = Arc::new(unpack()?);
        kept.insert(0, (at, Arc::clone(&content)));
        Ok(content)
    }
}
