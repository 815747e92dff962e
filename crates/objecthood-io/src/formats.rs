//! The list of formats. A format is a file in `formats/` and two lines here: its `mod` and its entry in `FORMATS`.
//!
//! Formats are told apart by content, never by name. Endings only say which files are looked for in a folder.

mod bag;
mod bop;
mod db3;
mod mcap;
pub mod npy;
pub mod npz;
pub mod pcd;
pub mod ply;
mod rosbag2;
pub mod tum;
mod unread;

use std::error::Error as StdError;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

pub use unread::Unread;

use crate::capture::Capture;
use crate::cloud::PointCloud;
use crate::error::{Error, Result};
use crate::given::Given;
use crate::organize::organize;
use crate::recording::Opener;
use crate::source::Source;

/// What is wrong with the content of a file; each format has a type of its own.
pub(crate) type ContentError = Box<dyn StdError + Send + Sync>;

/// Every format of frames.
const FORMATS: &[Format] = &[
    pcd::FORMAT,
    ply::FORMAT,
    npy::FORMAT,
    npz::FORMAT,
    mcap::FORMAT,
    db3::FORMAT,
    bag::FORMAT,
    rosbag2::FORMAT,
    bop::FORMAT,
    tum::FORMAT,
];

/// How frames of a format are found and read.
pub(crate) enum Format {
    /// A file that holds one frame.
    Frame(FrameFormat),
    /// A file that holds many frames.
    Recording(RecordingFormat),
    /// A folder whose files belong together.
    Folder(FolderFormat),
}

/// A file format of single frames.
pub(crate) struct FrameFormat {
    /// Endings of the files that are looked for in a folder, in lower case without the dot.
    pub(crate) extensions: &'static [&'static str],
    /// Whether a file that begins with `head`, at most [`HEAD_BYTES`], is of this format. Need not be sure: `decode` finds
    /// the rest out.
    pub(crate) is_mine: fn(head: &[u8]) -> bool,
    /// Whether it is always in metres, as points are.
    pub(crate) is_metric: bool,
    /// Reads the whole file. Touches nothing else, and takes memory only in proportion to the bytes that are there, or to the pixels
    /// that are given. The error says on one line what is wrong, where, and what to do.
    pub(crate) decode: fn(bytes: &[u8], given: &Given) -> Result<Capture>,
}

/// The frame of a file that a format of point clouds parses.
pub(crate) fn organized<E: StdError + Send + Sync + 'static>(
    cloud: Result<PointCloud, E>,
    given: &Given,
) -> Result<Capture> {
    organize(cloud.map_err(|error| Error::Content(error.into()))?, given)
}

/// A file format of recordings.
pub(crate) struct RecordingFormat {
    /// Endings of the files that are looked for in a folder, in lower case without the dot.
    pub(crate) extensions: &'static [&'static str],
    /// Whether a file that begins with `head`, at most [`HEAD_BYTES`], is of this format.
    pub(crate) is_mine: fn(head: &[u8]) -> bool,
    /// Lists its messages. None of them is kept, and memory grows with their number alone.
    pub(crate) log: Opener,
}

/// A layout of folders.
pub(crate) struct FolderFormat {
    /// Whether a folder has this layout.
    pub(crate) is_mine: fn(folder: &Path) -> bool,
    /// Lists the frames of the folder. No image is read.
    pub(crate) open: fn(folder: &Path, given: &Given) -> Result<Source>,
}

/// Bytes that are looked at to tell the format of a file.
pub(crate) const HEAD_BYTES: usize = 512;

/// The endings of files that are looked for in folders, in lower case without the dot. A file that is named is read
/// whatever its ending.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    FORMATS
        .iter()
        .flat_map(|format| match format {
            Format::Frame(format) => format.extensions,
            Format::Recording(format) => format.extensions,
            Format::Folder(_) => &[],
        })
        .copied()
}

/// Reads the content of a file that holds one frame.
///
/// # Errors
/// * [`Error::Empty`], [`Error::UnknownFormat`];
/// * [`Error::Content`]: what breaks the format;
/// * those of [`organize`], and of [`decode_images`](crate::images::decode_images) where a frame is stored as images.
pub fn decode(bytes: &[u8], given: &Given) -> Result<Capture> {
    let format = tell(&bytes[..bytes.len().min(HEAD_BYTES)])?;
    (format.decode)(bytes, given)
}

/// The format of the file that begins with `head`.
///
/// # Errors
/// [`Error::Empty`], [`Error::UnknownFormat`].
pub(crate) fn tell(head: &[u8]) -> Result<&'static FrameFormat> {
    if head.is_empty() {
        return Err(Error::Empty);
    }
    let frames = FORMATS.iter().filter_map(|format| match format {
        Format::Frame(format) => Some(format),
        Format::Folder(_) | Format::Recording(_) => None,
    });
    let mine = frames.into_iter().find(|format| (format.is_mine)(head));
    let other = || match tell_recording(head) {
        // It came by a pipe or from memory.
        Some(_) => Some(Unread::Recording("a recording, which is read from a file")),
        None => Unread::tell(head),
    };
    mine.ok_or_else(|| Error::UnknownFormat { looks_like: other() })
}

/// The format of the recording that begins with `head`, if it is one.
pub(crate) fn tell_recording(head: &[u8]) -> Option<&'static RecordingFormat> {
    let recordings = FORMATS.iter().filter_map(|format| match format {
        Format::Recording(format) => Some(format),
        Format::Frame(_) | Format::Folder(_) => None,
    });
    recordings.into_iter().find(|format| (format.is_mine)(head))
}

/// The layout of a folder, if it has one.
pub(crate) fn tell_folder(folder: &Path) -> Option<&'static FolderFormat> {
    let folders = FORMATS.iter().filter_map(|format| match format {
        Format::Folder(format) => Some(format),
        Format::Frame(_) | Format::Recording(_) => None,
    });
    folders.into_iter().find(|format| (format.is_mine)(folder))
}

/// The bytes of a file. `judge` sees its head first, so that a wrong file (a video, a device without end) is not loaded.
pub(crate) fn read_file(path: &Path, judge: impl FnOnce(&[u8]) -> Result<()>) -> Result<Vec<u8>> {
    let io = |reason: io::Error| Error::Read { reason };
    let mut file = File::open(path).map_err(io)?;
    let mut bytes = read_head(&mut file)?;
    judge(&bytes)?;
    file.read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

/// The first [`HEAD_BYTES`] of a file, or all of a shorter one.
pub(crate) fn read_head(file: &mut File) -> Result<Vec<u8>> {
    let mut head = Vec::new();
    let read = file.take(HEAD_BYTES as u64).read_to_end(&mut head);
    read.map_err(|reason| Error::Read { reason })?;
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first line of a ROS bag begins as a comment of PCD does, and the second was called a bad PCD header.
    #[test]
    fn a_recording_is_recognised_and_gets_no_advice_about_pcd() {
        for (head, kind) in [
            (&b"#ROSBAG V1.2\nE\0\0\0"[..], "a ROS 1 bag of version 1"),
            (b"\x1a\x45\xdf\xa3", "a Matroska video"),
            (b"\x89PNG\r\n\x1a\n", "an image"),
        ] {
            let message = decode(head, &Given::default()).unwrap_err().to_string();
            assert_eq!(message, format!("not a file that objecthood reads, but {kind}"));
        }
        let message = decode(b"\x7fELF", &Given::default()).unwrap_err().to_string();
        assert_eq!(message, "not a file that objecthood reads");
    }

    /// The mark before the header made it no PCD file.
    #[test]
    fn a_point_cloud_with_a_byte_order_mark_is_read() {
        let file = "\u{feff}# .PCD\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n\
                    DATA ascii\n0 0 1\n";
        assert_eq!(decode(file.as_bytes(), &Given::default()).unwrap().frame.depth_m().as_slice(), [1.0]);
    }
}
