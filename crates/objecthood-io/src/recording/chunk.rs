//! Records that stand in chunks, which may be packed: what the formats that have them share.

use std::marker::PhantomData;

use super::bytes::{Bytes, Window};
use super::error::RecordingError;
use super::log::{Messages, Place};
use super::unpack::{Packed, Unpacked};

/// How a format lays out its records, in the file and in its chunks.
pub(crate) trait Records: Sized + 'static {
    /// Name of the format.
    const NAME: &'static str;

    /// The record at `at` of `len` bytes; `None` when the bytes end before its end.
    fn read(window: &mut Window<'_>, at: u64, len: u64) -> Result<Option<Self>, RecordingError>;

    /// Where it ends.
    fn end(&self) -> u64;

    /// The chunk that it is.
    fn packed(&self, bytes: &dyn Bytes) -> Result<Packed, RecordingError>;

    /// The data of the message whose record is at `at`.
    fn message(bytes: &dyn Bytes, at: u64) -> Result<Vec<u8>, RecordingError>;
}

/// Unpacks a chunk and calls `take` with its bytes, each of its records and where that is among them.
pub(crate) fn each_record<R: Records>(
    packed: &Packed,
    bytes: &dyn Bytes,
    mut take: impl FnMut(&dyn Bytes, &R, u64) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    let content = packed.unpack(bytes, R::NAME)?;
    let mut window = Window::new(&content);
    let mut inside = 0;
    while let Some(record) = R::read(&mut window, inside, content.len() as u64)? {
        take(&content, &record, inside)?;
        inside = record.end();
    }
    Ok(())
}

/// The place of a message `inside` a chunk whose record is at `at`. In a plain chunk it is one of the file.
pub(crate) fn place_in(at: u64, packed: &Packed, inside: u64) -> Place {
    if packed.is_plain() { Place(0, packed.at.saturating_add(inside)) } else { Place(at, inside) }
}

/// Reads messages that stand in the file, or in chunks of it.
pub(crate) struct Chunked<R> {
    bytes: Box<dyn Bytes>,
    unpacked: Unpacked,
    format: PhantomData<fn() -> R>,
}

impl<R: Records> Chunked<R> {
    pub(crate) fn new(bytes: Box<dyn Bytes>) -> Self {
        Self { bytes, unpacked: Unpacked::default(), format: PhantomData }
    }
}

impl<R: Records> Messages for Chunked<R> {
    fn read(&self, Place(chunk, at): Place) -> Result<Vec<u8>, RecordingError> {
        if chunk == 0 {
            return R::message(&*self.bytes, at);
        }
        let content = self.unpacked.get(chunk, || {
            let record = R::read(&mut Window::new(&*self.bytes), chunk, self.bytes.len())?;
            record
                .ok_or(RecordingError::Cut { at: chunk })?
                .packed(&*self.bytes)?
                .unpack(&*self.bytes, R::NAME)
        })?;
        R::message(&*content, at)
    }
}
