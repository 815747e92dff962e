//! Colour and depth images -> pairs, by what their names have in common.
//!
//! The key of an image is the stem of its name without the word for what it shows and the separators beside: that of
//! `0001-color.png` and of `depth_0001.png` is `0001`. Without such a word it is the stem.

mod pattern;

use std::collections::{BTreeMap, HashSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Result, anyhow};
use clap::ValueEnum as _;
use objecthood_io::images::ImageFiles;
use objecthood_io::natural;
use walkdir::WalkDir;

use crate::args::{OutputKind, PairArgs};
use crate::failure::usage;

/// What an image shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Color,
    Depth,
}

/// What was found.
#[derive(Debug, Default)]
pub(crate) struct Pairs {
    /// In the order in which the depth images were given; those of a folder or pattern in natural order.
    pub(crate) pairs: Vec<ImageFiles>,
    /// Images without a partner, arguments without images.
    pub(crate) complaints: Vec<anyhow::Error>,
}

/// Joins colour with depth images. Without colour every depth image is a frame; one file each is a pair whatever the
/// names.
///
/// # Errors
/// Of usage, when two images of a kind have the same key.
pub(crate) fn find(PairArgs { color, depth }: &PairArgs) -> Result<Pairs> {
    let mut complaints = Vec::new();
    let depth_files = expand(Role::Depth, depth, &mut complaints);
    let color_files = expand(Role::Color, color, &mut complaints);
    let is_one_pair = |given: &[PathBuf], files: &[PathBuf]| given == files && files.len() == 1;

    let mut pairs = Vec::new();
    if color.is_empty() {
        pairs.extend(depth_files.into_iter().map(|depth| pair(None, depth)));
    } else if is_one_pair(color, &color_files) && is_one_pair(depth, &depth_files) {
        let color = color_files.into_iter().next();
        pairs.extend(depth_files.into_iter().map(|depth| pair(color.clone(), depth)));
    } else {
        let mut color_by_key = by_key(Role::Color, &color_files)?;
        by_key(Role::Depth, &depth_files)?;
        for depth in depth_files {
            match color_by_key.remove(&key(Role::Depth, &depth)) {
                Some(color) => pairs.push(pair(Some(color.clone()), depth)),
                None => complaints.push(alone(Role::Depth, &depth)),
            }
        }
        let mut rest: Vec<_> = color_by_key.into_values().collect();
        rest.sort_by(|a, b| natural::compare(a.as_os_str(), b.as_os_str()));
        complaints.extend(rest.into_iter().map(|color| alone(Role::Color, color)));
    }
    Ok(Pairs { pairs, complaints })
}

/// The frame of these images. It is called by its key, or as the depth image is where the key is empty or no text.
fn pair(color: Option<PathBuf>, depth: PathBuf) -> ImageFiles {
    let files = ImageFiles::new(color, depth);
    match String::from_utf8(key(Role::Depth, &files.depth)) {
        Ok(key) if !key.is_empty() => ImageFiles { name: key.into(), ..files },
        _ => files,
    }
}

/// The files that are meant: named, in a named folder, or of a pattern.
fn expand(role: Role, arguments: &[PathBuf], complaints: &mut Vec<anyhow::Error>) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for argument in arguments {
        let found = if argument.is_dir() {
            images_in(argument).map(|images| role.pick(images))
        } else if pattern::is_pattern(argument) {
            pattern::expand(argument).map(|files| files.into_iter().filter(|path| is_image(path)).collect())
        } else {
            Ok(vec![argument.clone()])
        };
        match found {
            Ok(found) if found.is_empty() => complaints.push(anyhow!(
                "{}: no {} image ({}) here: name files, a folder or a pattern that has some",
                argument.display(),
                role.word(),
                role.extensions().join(", ")
            )),
            Ok(found) => files.extend(found),
            Err(e) => complaints.push(e),
        }
    }
    let mut seen = HashSet::new();
    files.retain(|file| seen.insert(file.clone()));
    files
}

/// The image files of a folder, in natural order.
fn images_in(folder: &Path) -> Result<Vec<PathBuf>> {
    Ok(walk(folder, 1)?.into_iter().filter(|path| is_image(path)).collect())
}

/// Whether a file is an image by its name, and not one that an earlier run wrote.
fn is_image(path: &Path) -> bool {
    static OURS: LazyLock<Vec<&str>> =
        LazyLock::new(|| OutputKind::value_variants().iter().filter_map(|kind| kind.suffix()).collect());
    has_extension(path, Role::Color.extensions()) && !has_extension(path, &OURS)
}

/// The files of a folder and of those below it, at most `depth` names down, in natural order. Links to folders are not
/// followed: they may lead in circles.
fn walk(folder: &Path, depth: usize) -> Result<Vec<PathBuf>> {
    let is_here = folder.as_os_str().is_empty();
    let top = if is_here { Path::new(".") } else { folder };
    let entries = WalkDir::new(top)
        .min_depth(1)
        .max_depth(depth)
        .sort_by(|a, b| natural::compare(a.file_name(), b.file_name()));
    let mut files = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|e| cannot_list(&e, top))?;
        let (kind, path) = (entry.file_type(), entry.into_path());
        if kind.is_file() || kind.is_symlink() && path.is_file() {
            files.push(if is_here { path.strip_prefix(".").unwrap_or(&path).to_owned() } else { path });
        }
    }
    Ok(files)
}

fn cannot_list(error: &walkdir::Error, top: &Path) -> anyhow::Error {
    let reason = error.io_error().map(|e| format!(" ({e})")).unwrap_or_default();
    let folder = error.path().unwrap_or(top).display();
    anyhow!("{folder}: cannot list the folder{reason}: check that it is there, and its permissions")
}

impl Role {
    /// How the help calls it.
    fn word(self) -> &'static str {
        self.words()[0]
    }

    /// The words by which names tell it.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Color => &["color", "colour", "rgb"],
            Self::Depth => &["depth"],
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Color => Self::Depth,
            Self::Depth => Self::Color,
        }
    }

    /// Endings of the files that are looked for.
    fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Color => &[".png", ".jpg", ".jpeg", ".tif", ".tiff"],
            Self::Depth => &[".png", ".tif", ".tiff", ".exr", ".npy"],
        }
    }

    /// Of the images of a folder those of this role: those that say so; if none does, those that do not say otherwise.
    fn pick(self, images: Vec<PathBuf>) -> Vec<PathBuf> {
        let says = |role: Self, path: &Path| {
            has_extension(path, self.extensions()) && role.split(stem(path).as_encoded_bytes()).is_some()
        };
        let own = images.iter().any(|path| says(self, path));
        let keep = |path: &PathBuf| if own { says(self, path) } else { !says(self.other(), path) };
        images.into_iter().filter(|path| has_extension(path, self.extensions()) && keep(path)).collect()
    }

    /// What stands before and after the word for this role in a stem. A word is not part of a longer one.
    fn split(self, stem: &[u8]) -> Option<(&[u8], &[u8])> {
        let lower = stem.to_ascii_lowercase();
        let is_letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
        self.words().iter().find_map(|word| {
            let mut places = (0..=lower.len()).filter(|&at| lower[at..].starts_with(word.as_bytes()));
            places.find_map(|at| {
                let (before, after) = (&stem[..at], &stem[at + word.len()..]);
                let last = String::from_utf8_lossy(before).chars().next_back();
                let next = String::from_utf8_lossy(after).chars().next();
                (!is_letter(last) && !is_letter(next)).then_some((before, after))
            })
        })
    }
}

/// What the names of images of one frame have in common. Bytes, because names need not be text.
fn key(role: Role, path: &Path) -> Vec<u8> {
    let stem = stem(path).as_encoded_bytes();
    let Some((before, after)) = role.split(stem) else { return stem.to_owned() };
    let is_separator = |byte: &u8| b"-_. ".contains(byte);
    let start = before.iter().rposition(|byte| !is_separator(byte)).map_or(0, |last| last + 1);
    let end = after.iter().position(|byte| !is_separator(byte)).unwrap_or(after.len());
    let (start, separators, end) = (&before[..start], &after[..end], &after[end..]);
    // In the middle the separators behind the word stay.
    let between = if start.is_empty() || end.is_empty() { &[][..] } else { separators };
    [start, between, end].concat()
}

fn by_key(role: Role, files: &[PathBuf]) -> Result<BTreeMap<Vec<u8>, &PathBuf>> {
    let mut keys = BTreeMap::new();
    for file in files {
        let key = key(role, file);
        if let Some(other) = keys.insert(key.clone(), file) {
            return Err(usage(format!(
                "{} and {} are both the {} image of `{}`: name the ones that are meant, or rename one of them",
                other.display(),
                file.display(),
                role.word(),
                String::from_utf8_lossy(&key)
            )));
        }
    }
    Ok(keys)
}

fn alone(role: Role, path: &Path) -> anyhow::Error {
    anyhow!(
        "{}: no {} image has `{}` in its name, as this {} image has: add one, or leave this one out",
        path.display(),
        role.other().word(),
        String::from_utf8_lossy(&key(role, path)),
        role.word()
    )
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn stem(path: &Path) -> &OsStr {
    path.file_stem().unwrap_or_default()
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let name = file_name(path).to_ascii_lowercase();
    extensions.iter().any(|extension| name.ends_with(extension))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_what_is_common() {
        for (name, expected) in [
            ("0001-color.png", "0001"),
            ("0001_rgb.jpg", "0001"),
            ("color_0001.png", "0001"),
            ("rgb0001.png", "0001"),
            ("frame-000001.color.png", "frame-000001"),
            ("seq_Color_0001.png", "seq_0001"),
            ("color.png", ""),
            ("0.066667.png", "0.066667"),
            ("discolored.png", "discolored"),
            ("rgbd_1.png", "rgbd_1"),
            ("é-color-é.png", "é-é"),
        ] {
            assert_eq!(String::from_utf8(key(Role::Color, Path::new(name))).unwrap(), expected, "{name}");
        }
        assert_eq!(key(Role::Depth, Path::new("a/0001-depth.tiff")), b"0001");
        assert_eq!(key(Role::Depth, Path::new("0001-color.png")), b"0001-color");
    }

    #[test]
    fn a_folder_gives_what_says_so() {
        let pick = |role: Role, names: &[&str]| -> Vec<String> {
            role.pick(names.iter().map(PathBuf::from).collect()).iter().map(|path| file_name(path)).collect()
        };
        let mixed = ["1-color.png", "1-depth.png", "1-label.png"];
        assert_eq!(pick(Role::Color, &mixed), ["1-color.png"]);
        assert_eq!(pick(Role::Depth, &mixed), ["1-depth.png"]);
        assert_eq!(pick(Role::Color, &["1.jpg", "1-depth.png"]), ["1.jpg"]);
        assert_eq!(pick(Role::Depth, &["1.png", "1.jpg"]), ["1.png"]);
    }
}
