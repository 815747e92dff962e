//! What the tests of the command line have in common: running it, and small scenes to run it on.

#![allow(dead_code, reason = "every test program uses its own part of this")]
#![allow(clippy::print_stdout, reason = "a test says that it skips itself")]

pub(crate) mod photo;
pub(crate) mod pipe;
pub(crate) mod scene;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use tempfile::TempDir;

/// What a run left behind.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Run {
    /// The lines of stderr that report an error.
    pub(crate) fn errors(&self) -> Vec<&str> {
        self.stderr.lines().filter(|line| line.starts_with("error: ")).collect()
    }
}

/// The program under test.
pub(crate) fn command() -> Command {
    assert_cmd::cargo::cargo_bin_cmd!("objecthood")
}

/// Runs the program with arguments separated by blanks, in a folder, and expects an exit code.
#[track_caller]
pub(crate) fn run_in(folder: &Path, arguments: &str, code: i32) -> Run {
    let output = command().current_dir(folder).args(arguments.split_whitespace()).output().unwrap();
    let run = Run {
        code: output.status.code().expect("ended by a signal"),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    };
    assert_eq!(run.code, code, "objecthood {arguments}\n{}{}", run.stdout, run.stderr);
    assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    run
}

/// A folder for one test, with what is in it.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes a file, with the folders it lies in.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, bytes).unwrap();
        path
    }

    #[track_caller]
    pub(crate) fn run(&self, arguments: &str, code: i32) -> Run {
        run_in(self.path(), arguments, code)
    }

    /// The arguments are refused as wrong usage, in words that name the mistake, and nothing is printed.
    #[track_caller]
    pub(crate) fn refuses(&self, arguments: &str, said: &str) {
        let run = self.run(arguments, 2);
        assert!(
            run.stderr.starts_with("error: ") && run.stderr.contains(said),
            "{arguments}: {}",
            run.stderr
        );
        assert_eq!(run.stdout, "");
    }

    /// All files in a folder and below: name with `/` -> bytes.
    pub(crate) fn files(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let top = self.path().join(folder);
        let mut files = BTreeMap::new();
        let mut folders = vec![top.clone()];
        while let Some(folder) = folders.pop() {
            let Ok(entries) = std::fs::read_dir(&folder) else { continue };
            for entry in entries {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let name = path.strip_prefix(&top).unwrap().to_string_lossy().replace('\\', "/");
                    files.insert(name, std::fs::read(&path).unwrap());
                }
            }
        }
        files
    }

    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        self.files(folder).into_keys().collect()
    }
}

/// The folder of real data, or nothing and a line that says so.
pub(crate) fn data() -> Option<PathBuf> {
    let data =
        std::env::var_os("OBJECTHOOD_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    let is_there = ["stills", "video", "mosd"].iter().all(|set| data.join(set).is_dir());
    if !is_there {
        println!("skipped: no stills in the data folder, which OBJECTHOOD_DATA names");
    }
    is_there.then_some(data)
}

/// The scenes of mOSD's folder `learn`, or nothing and a line that says so.
pub(crate) fn mosd() -> Option<PathBuf> {
    let data =
        std::env::var_os("OBJECTHOOD_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    let mosd = data.join("mosd");
    if mosd.join("learn").is_dir() {
        return Some(mosd);
    }
    println!("skipped: no data set mOSD; the folder that holds mosd/learn is named by OBJECTHOOD_DATA");
    None
}

pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
