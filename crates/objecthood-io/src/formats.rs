//! The list of formats. To add one: a module that turns bytes into a [`Capture`], and one line here.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Result};
use crate::organize::{Capture, GridCamera, organize};
use crate::pcd;

/// Endings of the files that are looked for in a folder, in lower case. A file that is named is read whatever its ending.
pub const EXTENSIONS: &[&str] = &["pcd"];

/// A file format.
struct Format {
    /// Whether a file that begins like this is one of ours. Need not be sure: reading finds the rest out.
    is_mine: fn(head: &[u8]) -> bool,
    /// Reads the whole file.
    read: fn(bytes: &[u8], camera: Option<&GridCamera>, max_pixels: usize) -> Result<Capture>,
}

const FORMATS: &[Format] = &[Format {
    is_mine: is_pcd,
    read: |bytes, camera, max_pixels| organize(pcd::parse(bytes)?, camera, max_pixels),
}];

/// Bytes that are looked at to tell the format.
const HEAD_BYTES: usize = 512;

/// A PCD file begins with comments and its VERSION.
fn is_pcd(head: &[u8]) -> bool {
    let head = head.trim_ascii_start();
    head.starts_with(b"#") || head.starts_with(b"VERSION")
}

/// Opens the file at `path`, whatever format it is of; `camera` overrides the camera that the file implies, and a
/// frame of more than `max_pixels` is refused.
///
/// # Errors
/// [`Error::At`] the path: whatever is wrong with the file or its content.
pub fn open(path: &Path, camera: Option<&GridCamera>, max_pixels: usize) -> Result<Capture> {
    let bytes = read_file(path, |head| probe(head).map(drop));
    bytes.and_then(|bytes| decode(&bytes, camera, max_pixels)).map_err(|error| error.at(path))
}

/// As [`open`], for the content of a file.
///
/// # Errors
/// [`Error::Empty`], [`Error::UnknownFormat`], or what is wrong with the content.
pub fn decode(bytes: &[u8], camera: Option<&GridCamera>, max_pixels: usize) -> Result<Capture> {
    let format = probe(&bytes[..bytes.len().min(HEAD_BYTES)])?;
    (format.read)(bytes, camera, max_pixels)
}

fn probe(head: &[u8]) -> Result<&'static Format> {
    if head.is_empty() {
        return Err(Error::Empty);
    }
    FORMATS.iter().find(|format| (format.is_mine)(head)).ok_or(Error::UnknownFormat)
}

/// The bytes of a file. `judge` sees the head first, so that a wrong file (a video, a device without end) is not loaded
/// whole.
pub(crate) fn read_file(path: &Path, judge: impl FnOnce(&[u8]) -> Result<()>) -> Result<Vec<u8>> {
    let io = |reason: io::Error| Error::Read { reason };
    let mut file = File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    file.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut bytes).map_err(io)?;
    judge(&bytes)?;
    file.read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(path: &Path, camera: Option<&GridCamera>) -> Result<Capture> {
        super::open(path, camera, 100)
    }

    const ONE_POINT: &str =
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 0 1\n";

    #[test]
    fn the_path_is_said_once() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, said) in [
            ("empty.pcd", &b""[..], "the file is empty"),
            ("noise.pcd", &[0xff, 0x00, 0x13, 0x37], "not a file that objecthood reads"),
            ("cut.pcd", b"# .PCD v0.7\nVERSION 0.7\n", "without a DATA line"),
            ("nan.pcd", ONE_POINT.replace("0 0 1", "0 0 nan").as_bytes(), "no pixel has a valid depth"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            let message = open(&path, None).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
            assert_eq!(message.matches(name).count(), 1, "{message}");
            assert!(!message.contains('\n'), "{message}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        assert!(open(folder.path(), None).unwrap_err().to_string().contains("cannot be read"));
        let missing = folder.path().join("missing.pcd");
        assert!(open(&missing, None).unwrap_err().to_string().contains("cannot be read"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_end_is_not_loaded() {
        let message = open(Path::new("/dev/zero"), None).unwrap_err().to_string();
        assert!(message.contains("not a file that objecthood reads"), "{message}");
    }

    #[test]
    fn a_file_longer_than_its_head_is_read_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.pcd");
        std::fs::write(&path, format!("# {}\n{ONE_POINT}", "x".repeat(3 * HEAD_BYTES))).unwrap();
        assert_eq!(open(&path, None).unwrap().frame.depth_m().as_slice(), [1.0]);
    }
}
