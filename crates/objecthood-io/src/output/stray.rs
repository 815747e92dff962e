//! Files that a process left behind when it was killed while it wrote them.
//!
//! Whoever writes a file holds a lock on it until the file has its name. The system drops the lock when the process
//! ends, however it ends: a file that nobody locks is stray.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The name of a file that is being written begins and ends with these.
pub(super) const PREFIX: &str = ".objecthood-";
pub(super) const SUFFIX: &str = ".part";

/// Creates a file that is being written, locked against [`remove_strays_once`] of every process.
///
/// # Errors
/// [`ErrorKind::AlreadyExists`] when the name is taken, or when another process removed the file in the moment before
/// it was locked; try another name. Otherwise what the system says.
pub(super) fn create_locked(part: &Path) -> io::Result<fs::File> {
    // Created as any file is, so that its permissions honour the umask. What is written may be read again.
    let file = OpenOptions::new().read(true).write(true).create_new(true).open(part)?;
    // A file system without locks does not hand them to those who remove strays either.
    if file.lock().is_ok() && !part.exists() {
        return Err(io::Error::new(ErrorKind::AlreadyExists, "the file was taken for a stray one"));
    }
    Ok(file)
}

/// Removes the stray files of a folder, at the first call for it in this process. What cannot be removed stays.
pub(super) fn remove_strays_once(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if SEEN.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        remove_strays(folder);
    }
}

fn remove_strays(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let parts = entries.flatten().filter(|entry| is_part(&entry.file_name()));
    // Opening anything but a file may wait for ever.
    for entry in parts.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file())) {
        // Some network file systems lock only what is open for writing.
        let Ok(file) = OpenOptions::new().write(true).open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            // If it cannot be removed it does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_part(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    #[test]
    fn strays_of_a_killed_process_are_removed_and_files_being_written_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let others = [".objecthood-notes.txt", "a.part", "a.labels.png"];
        for name in others.iter().chain([&".objecthood-killed.part"]) {
            fs::write(path(name), b"content").unwrap();
        }
        fs::create_dir(path(".objecthood-folder.part")).unwrap();
        let writing = create_locked(&path(".objecthood-writing.part")).unwrap();

        remove_strays(folder.path());
        assert!(!path(".objecthood-killed.part").exists());
        assert!(path(".objecthood-writing.part").exists() && path(".objecthood-folder.part").is_dir());
        assert!(others.iter().all(|name| path(name).exists()));

        drop(writing);
        remove_strays(folder.path());
        assert!(!path(".objecthood-writing.part").exists(), "its writer is gone");
    }

    /// A file that is removed between its creation and its lock is created anew.
    #[test]
    fn whoever_removes_strays_takes_no_file_from_a_writer() {
        let folder = tempfile::tempdir().unwrap();
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    remove_strays(folder.path());
                }
            });
            let path = |k: i32| folder.path().join(format!("{k}.json"));
            let written = (0..500).try_for_each(|k| super::super::write_atomically(&path(k), b"content"));
            done.store(true, Ordering::Relaxed);
            written.unwrap();
        });
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 500);
    }
}
