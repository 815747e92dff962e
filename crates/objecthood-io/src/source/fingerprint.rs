//! Whether a frame is the one that an earlier run looked at, told without reading it.

use std::fs;
use std::path::Path;
use std::time::UNIX_EPOCH;

use sha2::{Digest, Sha256};

use super::FrameRef;
use crate::error::{Error, Result};
use crate::text::hexadecimal;

impl FrameRef {
    /// SHA-256, in hexadecimal, of everything that decides what is found in this frame: `settings`, which the caller puts into words
    /// (version, parameters, what it knows better than the files), the frame's name and place, and of each of its files and of the
    /// `shared` ones name, size and time of the last change. No file is read, so a million frames take seconds; a file that was changed
    /// within the resolution of the file system's clock, without a change of its size, is not told apart.
    ///
    /// # Errors
    /// [`Error::At`](crate::Error::At) a file of the frame that is not there. Shared files may be missing.
    pub fn fingerprint<'a>(
        &self,
        settings: &str,
        shared: impl IntoIterator<Item = &'a Path>,
    ) -> Result<String> {
        let mut hash = Sha256::new();
        let mut add = |bytes: &[u8]| {
            // With its length, so that no two lists of parts are one.
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        add(settings.as_bytes());
        add(self.name.as_encoded_bytes());
        add(&self.number.to_le_bytes());
        add(&self.stamp_ns.unwrap_or(i64::MIN).to_le_bytes());
        for path in self.files() {
            let state = fs::metadata(path).map_err(|reason| Error::Read { reason }.at(path))?;
            state_of(path, &state).iter().for_each(|part| add(part));
        }
        for path in shared {
            if let Ok(state) = fs::metadata(path) {
                state_of(path, &state).iter().for_each(|part| add(part));
            }
        }
        Ok(hexadecimal(&hash.finalize()))
    }
}

/// SHA-256 of bytes, in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Name, size (bytes) and time of the last change (ns) of a file.
fn state_of(path: &Path, state: &fs::Metadata) -> [Vec<u8>; 3] {
    let since = state.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    let changed_ns = since.map_or(0, |since| since.as_nanos());
    let name = path.file_name().unwrap_or_default().as_encoded_bytes().to_vec();
    [name, state.len().to_le_bytes().to_vec(), changed_ns.to_le_bytes().to_vec()]
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, SystemTime};

    use super::*;
    use crate::{Given, images};

    #[test]
    fn it_changes_with_whatever_decides_the_result() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["1-depth.png", "1-color.png", "2-depth.png", "camera.json"] {
            fs::write(path(name), name).unwrap();
        }
        let frames = |color: bool| {
            let color = color.then(|| path("1-color.png"));
            let files = vec![
                images::ImageFiles::new(color, path("1-depth.png")),
                images::ImageFiles::new(None, path("2-depth.png")),
            ];
            images::source_of(files, &Given::default()).map(|frame| frame.unwrap()).collect::<Vec<_>>()
        };
        let shared = path("camera.json");
        let print = |frame: &FrameRef, settings: &str| frame.fingerprint(settings, [shared.as_path()]);
        let (plain, colored) = (frames(false), frames(true));
        let first = print(&colored[0], "a").unwrap();
        assert_eq!(first.len(), 64);
        assert_eq!(first, print(&colored[0], "a").unwrap());
        let mut others = vec![
            first,
            print(&colored[0], "b").unwrap(),
            print(&colored[1], "a").unwrap(),
            print(&plain[0], "a").unwrap(),
        ];
        let later = SystemTime::UNIX_EPOCH + Duration::from_secs(7);
        for name in ["1-color.png", "camera.json"] {
            fs::File::options().write(true).open(path(name)).unwrap().set_modified(later).unwrap();
            others.push(print(&colored[0], "a").unwrap());
        }
        fs::write(path("1-depth.png"), "longer than before").unwrap();
        others.push(print(&colored[0], "a").unwrap());
        let count = others.len();
        others.sort();
        others.dedup();
        assert_eq!(others.len(), count);

        fs::remove_file(path("1-depth.png")).unwrap();
        assert!(print(&colored[0], "a").unwrap_err().to_string().contains("1-depth.png"));
    }
}
