//! Files and folders on the command line -> the list of frames, each with a name of its own for its outputs.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use anyhow::{Result, anyhow};

use crate::failure::usage;
use crate::natural;

/// One frame to look at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Input {
    /// The file, as the user would name it.
    pub(crate) path: PathBuf,
    /// Where its outputs go: relative to the folder of outputs, without extension.
    pub(crate) name: PathBuf,
}

/// What was found.
#[derive(Debug)]
pub(crate) struct Inputs {
    /// The frames, each file once, in the order in which they were given; those of a folder in natural order.
    pub(crate) frames: Vec<Input>,
    /// Folders that hold no frame or cannot be read; each is reported like a frame that failed.
    pub(crate) unreadable: Vec<anyhow::Error>,
}

/// A file before its outputs have a name.
struct Found {
    path: PathBuf,
    /// The folder it lies in: absolute, so that one file is one file however it was named.
    folder: PathBuf,
}

/// Makes the list of frames.
///
/// The outputs are named by the stem of the file; with `keep_tree` by its place below the folder that is common to all
/// arguments.
///
/// # Errors
/// Of usage, when two files would have the same outputs.
pub(crate) fn collect(arguments: &[PathBuf], keep_tree: bool) -> Result<Inputs> {
    let mut found = Vec::new();
    let mut unreadable = Vec::new();
    let mut tops = Vec::new();
    for argument in arguments {
        if argument.is_dir() {
            let top = absolute(argument);
            let before = (found.len(), unreadable.len());
            search(argument, &top, &mut found, &mut unreadable);
            if (found.len(), unreadable.len()) == before {
                unreadable.push(anyhow!(
                    "{}: no point cloud ({}) in this folder or below: name one that holds some",
                    argument.display(),
                    extensions()
                ));
            }
            tops.push(top);
        } else {
            let folder =
                absolute(argument.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")));
            found.push(Found { path: argument.clone(), folder: folder.clone() });
            tops.push(folder);
        }
    }
    let mut seen = BTreeSet::new();
    found.retain(|f| seen.insert((f.folder.clone(), f.path.file_name().map(OsStr::to_owned))));

    let root = common_folder(&tops);
    let frames: Vec<Input> = found
        .into_iter()
        .map(|Found { path, folder }| {
            let stem = path.file_stem().unwrap_or(path.as_os_str());
            let place = if keep_tree { below(&root, &folder) } else { PathBuf::new() };
            Input { name: place.join(stem), path }
        })
        .collect();
    refuse_equal_names(&frames, keep_tree)?;
    Ok(Inputs { frames, unreadable })
}

/// Adds the frames of a folder and of those below it. Links to folders are not followed: they may lead in circles.
fn search(folder: &Path, absolute: &Path, found: &mut Vec<Found>, unreadable: &mut Vec<anyhow::Error>) {
    let entries = match entries(folder) {
        Ok(entries) => entries,
        Err(e) => {
            unreadable.push(e);
            return;
        }
    };
    for (entry, is_folder) in entries {
        let path = folder.join(entry.file_name());
        if is_folder {
            search(&path, &absolute.join(entry.file_name()), found, unreadable);
        } else if is_frame(&path) {
            found.push(Found { path, folder: absolute.to_owned() });
        }
    }
}

/// What a folder holds, in natural order, and whether each is a folder itself.
fn entries(folder: &Path) -> Result<Vec<(fs::DirEntry, bool)>> {
    let read = || -> io::Result<_> {
        let entries = fs::read_dir(folder)?.map(|entry| {
            let entry = entry?;
            let is_folder = entry.file_type()?.is_dir();
            Ok((entry, is_folder))
        });
        entries.collect::<io::Result<Vec<_>>>()
    };
    let mut entries = read()
        .map_err(|e| anyhow!("{}: cannot list the folder ({e}): check its permissions", folder.display()))?;
    entries.sort_by(|(a, _), (b, _)| natural::compare(&a.file_name(), &b.file_name()));
    Ok(entries)
}

/// The endings that are looked for, as one reads them: `.pcd`.
fn extensions() -> String {
    objecthood_io::EXTENSIONS.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(", ")
}

fn is_frame(path: &Path) -> bool {
    let extension = path.extension().unwrap_or_default();
    objecthood_io::EXTENSIONS.iter().any(|e| extension.eq_ignore_ascii_case(e)) && path.is_file()
}

/// The absolute form of a folder, without links and dots when it exists.
fn absolute(folder: &Path) -> PathBuf {
    fs::canonicalize(folder).or_else(|_| std::path::absolute(folder)).unwrap_or_else(|_| folder.to_owned())
}

/// The deepest folder in or below which all of `folders` lie.
fn common_folder(folders: &[PathBuf]) -> PathBuf {
    let Some((first, others)) = folders.split_first() else { return PathBuf::new() };
    let is_common = |candidate: &&Path| others.iter().all(|folder| folder.starts_with(candidate));
    first.ancestors().find(is_common).unwrap_or(Path::new("")).to_owned()
}

/// The way from `root` down to `folder`: names only, so that it leads nowhere else wherever it is appended.
fn below(root: &Path, folder: &Path) -> PathBuf {
    let way = folder.strip_prefix(root).unwrap_or(folder);
    way.components().filter(|part| matches!(part, Component::Normal(_))).collect()
}

fn refuse_equal_names(frames: &[Input], keep_tree: bool) -> Result<()> {
    let mut names = BTreeMap::new();
    for frame in frames {
        if let Some(other) = names.insert(&frame.name, &frame.path) {
            let advice = if keep_tree || other.parent() == frame.path.parent() {
                "rename one of them"
            } else {
                "keep them apart with --keep-tree"
            };
            return Err(usage(format!(
                "{} and {} would both be written to {}.*: {advice}",
                other.display(),
                frame.path.display(),
                frame.name.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_common_folder_is_the_deepest() {
        let common = |folders: &[&str]| common_folder(&folders.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(common(&["/a/b/c", "/a/b/d/e"]), Path::new("/a/b"));
        assert_eq!(common(&["/a/b", "/a/b/d"]), Path::new("/a/b"));
        assert_eq!(common(&["/a/b", "/a/bc"]), Path::new("/a"));
        assert_eq!(common(&["/a/b"]), Path::new("/a/b"));
        assert_eq!(common(&[]), Path::new(""));
    }

    #[test]
    fn outputs_stay_below_their_folder() {
        assert_eq!(below(Path::new("/a"), Path::new("/a/b/c")), Path::new("b/c"));
        assert_eq!(below(Path::new("/a"), Path::new("/a")), Path::new(""));
        assert_eq!(below(Path::new(""), Path::new("/a/../b")), Path::new("a/b"));
    }
}
