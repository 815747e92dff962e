//! What is written for users and for other programs, and how: files appear whole or not at all.
//!
//! [`write_together`] writes the files of a frame, [`Growing`] is a file that takes frames one after the other. What goes into files that
//! other programs read is in modules of their own, one a format; label images, scene files and labels of points are beside this module.

pub mod bop;
pub mod coco;
pub mod depth;
pub mod frames;
pub mod instances;
pub mod mcap;
pub mod npz;
pub mod ply;
pub mod rle;
mod ros2;
mod stray;

use std::fs;
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// Writes `bytes` to the file at `path`, which appears, or is replaced, only when all of them are written.
///
/// They go to a temporary file in the same folder, which then takes the name `path`. If that fails nothing is left
/// behind and an earlier file keeps its content. The file has the permissions of any new file.
///
/// A process that is killed leaves its temporary files, `.objecthood-*.part`. The next process that writes to the
/// folder removes them; it leaves alone what a living process writes, which is locked.
///
/// # Errors
/// [`Error::Write`] names the path, what the system says and what to do.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    stage(path, bytes).and_then(|file| take_name(file, path))
}

/// As [`write_atomically`], for files that belong together: none takes its name before all are written whole.
///
/// # Errors
/// As [`write_atomically`], for the first file that cannot be written.
pub fn write_together(files: &[(PathBuf, Vec<u8>)]) -> Result<()> {
    let staged: Vec<_> = files.iter().map(|(path, bytes)| stage(path, bytes)).collect::<Result<_>>()?;
    staged.into_iter().zip(files).try_for_each(|(file, (path, _))| take_name(file, path))
}

/// A file that grows by and by and takes its name when it is finished. If it is dropped before, nothing of it is left.
#[derive(Debug)]
pub struct Growing {
    file: BufWriter<Staged>,
    path: PathBuf,
}

impl Growing {
    /// Begins the file that is to be at `path`.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn create(path: &Path) -> Result<Self> {
        let file = open_staged(path).map_err(|reason| cannot_write(path, reason))?;
        Ok(Self { file: BufWriter::new(file), path: path.to_owned() })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn append(&mut self, bytes: &[u8]) -> Result<()> {
        self.file.write_all(bytes).map_err(|reason| cannot_write(&self.path, reason))
    }

    /// Where the file will be.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The bytes that were appended so far go to `out` too. O(bytes) time, and no memory.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn copy_to(&mut self, out: &mut impl Write) -> Result<()> {
        self.try_copy_to(out).map_err(|reason| cannot_write(&self.path, reason))
    }

    fn try_copy_to(&mut self, out: &mut impl Write) -> io::Result<()> {
        self.file.flush()?;
        let file = self.file.get_mut().as_file_mut();
        let place = file.stream_position()?;
        let copied = file.rewind().and_then(|()| io::copy(file, out));
        // Also when that failed: what is appended later goes behind what is there.
        file.seek(SeekFrom::Start(place))?;
        copied.map(drop)
    }

    /// The file appears, or is replaced, with what was appended so far, and goes on to grow. O(bytes) time, and no memory.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn keep(&mut self) -> Result<()> {
        let mut copy = open_staged(&self.path).map_err(|reason| cannot_write(&self.path, reason))?;
        self.copy_to(copy.as_file_mut())?;
        take_name(copy, &self.path)
    }

    /// The file takes its name.
    ///
    /// # Errors
    /// As [`write_atomically`].
    pub fn finish(self) -> Result<()> {
        Self::finish_together([self])
    }

    /// As [`Growing::finish`], for files that belong together: none takes its name before all are whole.
    ///
    /// # Errors
    /// As [`write_atomically`], for the first file that cannot be written.
    pub fn finish_together(files: impl IntoIterator<Item = Self>) -> Result<()> {
        let whole = |Self { file, path }: Self| match file.into_inner() {
            Ok(file) => Ok((file, path)),
            Err(e) => Err(cannot_write(&path, e.into_error())),
        };
        let staged: Vec<_> = files.into_iter().map(whole).collect::<Result<_>>()?;
        staged.into_iter().try_for_each(|(file, path)| take_name(file, &path))
    }
}

impl Write for Growing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Growing {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// A file that is removed again unless it takes its name.
type Staged = NamedTempFile<fs::File>;

/// The content beside `path`, under another name.
fn stage(path: &Path, bytes: &[u8]) -> Result<Staged> {
    try_stage(path, bytes).map_err(|reason| cannot_write(path, reason))
}

fn take_name(file: Staged, path: &Path) -> Result<()> {
    file.persist(path).map(drop).map_err(|e| cannot_write(path, e.error))
}

fn cannot_write(path: &Path, reason: io::Error) -> Error {
    Error::Write { path: path.to_owned(), advice: advice(reason.kind()), reason }
}

fn try_stage(path: &Path, bytes: &[u8]) -> io::Result<Staged> {
    let mut file = open_staged(path)?;
    file.as_file_mut().write_all(bytes)?;
    Ok(file)
}

/// An empty file beside `path`, under another name.
fn open_staged(path: &Path) -> io::Result<Staged> {
    // Taking the name of a device would replace it by a file.
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "a folder or device of that name exists"));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    stray::remove_strays_once(folder);
    let mut part = tempfile::Builder::new();
    part.prefix(stray::PREFIX).suffix(stray::SUFFIX).make_in(folder, stray::create_locked)
}

fn advice(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::NotFound | ErrorKind::NotADirectory => "make the folder, or correct the path",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "choose a folder in which you may write"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
            "make room on the disk"
        }
        ErrorKind::AlreadyExists | ErrorKind::IsADirectory => "choose another name",
        _ => "check the folder and the disk",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_appears_and_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.json");
        write_atomically(&path, b"first").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"first");
        write_atomically(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["out.json"]);
    }

    #[test]
    fn a_file_that_grows_appears_when_it_is_finished_or_never() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.json");
        let mut growing = Growing::create(&path).unwrap();
        growing.append(b"[1,").unwrap();
        growing.append(b"2]").unwrap();
        assert!(!path.exists());
        growing.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"[1,2]");
        drop(Growing::create(&path).unwrap());
        assert_eq!(names(folder.path()), ["long.json"]);
        assert_eq!(fs::read(&path).unwrap(), b"[1,2]");
    }

    #[test]
    fn a_file_that_is_kept_is_whole_and_grows_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.jsonl");
        let mut growing = Growing::create(&path).unwrap();
        for (line, so_far) in [("1\n", "1\n"), ("22\n", "1\n22\n"), ("3\n", "1\n22\n3\n")] {
            growing.append(line.as_bytes()).unwrap();
            growing.keep().unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), so_far);
        }
        growing.append(b"4\n").unwrap();
        let mut copy = Vec::new();
        growing.copy_to(&mut copy).unwrap();
        assert_eq!(copy, b"1\n22\n3\n4\n");
        assert_eq!(fs::read(&path).unwrap(), b"1\n22\n3\n");
        growing.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), copy);
        assert_eq!(names(folder.path()), ["long.jsonl"]);
    }

    /// They stayed for ever.
    #[test]
    fn the_first_file_in_a_folder_removes_what_a_killed_process_left() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".objecthood-aB3xYz.part"), b"half").unwrap();
        write_atomically(&folder.path().join("out.json"), b"whole").unwrap();
        assert_eq!(names(folder.path()), ["out.json"]);
    }

    #[test]
    fn of_files_that_belong_together_none_appears_when_one_cannot() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a", "b"].map(|name| folder.path().join(name));
        fs::write(&first, b"earlier").unwrap();
        fs::create_dir(&second).unwrap();
        let files = |content: &[u8]| [&first, &second].map(|path| (path.clone(), content.to_vec()));
        assert!(write_together(&files(b"new")).is_err());
        assert_eq!(fs::read(&first).unwrap(), b"earlier");
        assert_eq!(names(folder.path()), ["a", "b"]);
        fs::remove_dir(&second).unwrap();
        write_together(&files(b"new")).unwrap();
        assert!([first, second].iter().all(|path| fs::read(path).unwrap() == b"new"));
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_a_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
        write_atomically(&ours, b"").unwrap();
        fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn what_is_in_the_way_stays() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("dir")).unwrap();
        fs::write(folder.path().join("file"), b"content").unwrap();
        for (path, advice) in [
            ("dir", "choose another name"),
            ("missing/out", "make the folder"),
            ("file/out", "make the folder"),
        ] {
            let path = folder.path().join(path);
            let message = write_atomically(&path, b"new").unwrap_err().to_string();
            assert!(message.starts_with(&format!("{}: cannot be written", path.display())), "{message}");
            assert!(message.contains(advice) && !message.contains(".part"), "{message}");
        }
        assert_eq!(names(folder.path()), ["dir", "file"]);
        assert_eq!(fs::read(folder.path().join("file")).unwrap(), b"content");
    }

    #[test]
    fn a_failed_rename_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x".repeat(300));
        assert!(write_atomically(&path, b"new").is_err());
        assert!(names(folder.path()).is_empty());
    }

    /// Through a link, so that the machine keeps its device even when this fails.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("full");
        std::os::unix::fs::symlink("/dev/full", &link).unwrap();
        let message = write_atomically(&link, b"new").unwrap_err().to_string();
        assert!(message.contains("choose another name"), "{message}");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_explained() {
        let mut full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        assert_eq!(advice(full.write_all(b"new").unwrap_err().kind()), "make room on the disk");
    }
}
