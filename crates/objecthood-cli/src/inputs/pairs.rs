//! Colour and depth images -> pairs, by what their names have in common.
//!
//! The key of an image is the stem of its name without the word for what it shows and the separators beside: that of
//! `0001-color.png` and of `depth_0001.png` is `0001`. Without such a word it is the stem.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};
use clap::ValueEnum as _;

use super::entries;
use crate::args::OutputKind;
use crate::failure::usage;
use crate::natural;

/// What an image shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Color,
    Depth,
}

/// One frame.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Pair {
    pub(super) color: Option<PathBuf>,
    pub(super) depth: PathBuf,
    /// What names its outputs; never empty.
    pub(super) name: String,
}

/// What was found.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    /// In the order in which the depth images were given; those of a folder or pattern in natural order.
    pub(super) pairs: Vec<Pair>,
    /// Images without a partner, arguments without images.
    pub(super) complaints: Vec<anyhow::Error>,
}

/// Joins colour with depth images. Without colour every depth image is a frame; one file each is a pair whatever the
/// names.
///
/// # Errors
/// Of usage, when two images of a kind have the same key.
pub(super) fn find(color: &[PathBuf], depth: &[PathBuf]) -> Result<Pairs> {
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
        rest.sort_by(|a, b| in_natural_order(a, b));
        complaints.extend(rest.into_iter().map(|color| alone(Role::Color, color)));
    }
    Ok(Pairs { pairs, complaints })
}

fn pair(color: Option<PathBuf>, depth: PathBuf) -> Pair {
    let key = key(Role::Depth, &depth);
    let name = if key.is_empty() { stem(&depth) } else { key };
    Pair { color, depth, name }
}

/// The files that are meant: named, in a named folder, or of a pattern.
fn expand(role: Role, arguments: &[PathBuf], complaints: &mut Vec<anyhow::Error>) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for argument in arguments {
        let pattern = argument.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
        let found = if argument.is_dir() {
            images_in(argument).map(|images| role.pick(images))
        } else if pattern.contains(['*', '?']) && !argument.exists() {
            let folder = argument.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            images_in(folder).map(|mut images| {
                images.retain(|path| matches(&pattern, &file_name(path)));
                // As the shell would write it.
                let folder = argument.parent().unwrap_or(Path::new(""));
                images.iter().filter_map(|path| Some(folder.join(path.file_name()?))).collect()
            })
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
    let mut seen = std::collections::BTreeSet::new();
    files.retain(|file| seen.insert(file.clone()));
    files
}

/// The image files of a folder, in natural order, without those that an earlier run wrote there.
fn images_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let ours: Vec<&str> = OutputKind::value_variants().iter().map(|kind| kind.suffix()).collect();
    let is_image = |path: &Path| has_extension(path, Role::Color.extensions()) && !has_extension(path, &ours);
    let paths = entries(folder)?.into_iter().map(|(entry, _)| folder.join(entry.file_name()));
    Ok(paths.filter(|path| is_image(path) && path.is_file()).collect())
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
            Self::Depth => &[".png", ".tif", ".tiff"],
        }
    }

    /// Of the images of a folder those of this role: those that say so; if none does, those that do not say otherwise.
    fn pick(self, images: Vec<PathBuf>) -> Vec<PathBuf> {
        let says = |role: Self, path: &Path| {
            has_extension(path, self.extensions()) && role.split(&stem(path)).is_some()
        };
        let own = images.iter().any(|path| says(self, path));
        let keep = |path: &PathBuf| if own { says(self, path) } else { !says(self.other(), path) };
        images.into_iter().filter(|path| has_extension(path, self.extensions()) && keep(path)).collect()
    }

    /// What stands before and after the word for this role in a stem. A word is not part of a longer one.
    fn split(self, stem: &str) -> Option<(&str, &str)> {
        let lower = stem.to_ascii_lowercase();
        let is_letter = |c: Option<char>| c.is_some_and(char::is_alphabetic);
        self.words().iter().find_map(|word| {
            lower.match_indices(word).find_map(|(at, _)| {
                let (before, after) = (&stem[..at], &stem[at + word.len()..]);
                let alone = !is_letter(before.chars().next_back()) && !is_letter(after.chars().next());
                alone.then_some((before, after))
            })
        })
    }
}

/// What the names of images of one frame have in common.
fn key(role: Role, path: &Path) -> String {
    let stem = stem(path);
    let Some((before, after)) = role.split(&stem) else { return stem };
    const SEPARATORS: [char; 4] = ['-', '_', '.', ' '];
    let (start, end) = (before.trim_end_matches(SEPARATORS), after.trim_start_matches(SEPARATORS));
    if start.is_empty() || end.is_empty() {
        return format!("{start}{end}");
    }
    // In the middle one of the separators stays.
    format!("{start}{}{end}", &after[..after.len() - end.len()])
}

fn by_key(role: Role, files: &[PathBuf]) -> Result<BTreeMap<String, &PathBuf>> {
    let mut keys = BTreeMap::new();
    for file in files {
        let key = key(role, file);
        if let Some(other) = keys.insert(key.clone(), file) {
            return Err(usage(format!(
                "{} and {} are both the {} image of `{key}`: name the ones that are meant, or rename one of them",
                other.display(),
                file.display(),
                role.word()
            )));
        }
    }
    Ok(keys)
}

fn alone(role: Role, path: &Path) -> anyhow::Error {
    anyhow!(
        "{}: no {} image has the key `{}` as this {} image has: add it, or leave this one out",
        path.display(),
        role.other().word(),
        key(role, path),
        role.word()
    )
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let name = file_name(path).to_ascii_lowercase();
    extensions.iter().any(|extension| name.ends_with(extension))
}

fn in_natural_order(a: &Path, b: &Path) -> Ordering {
    natural::compare(a.as_os_str(), b.as_os_str())
}

/// Whether a name is of a pattern: `*` stands for any characters, `?` for one.
fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // Where the last star stands and how far it reaches so far.
    let mut star: Option<(usize, usize)> = None;
    while n < name.len() {
        if pattern.get(p) == Some(&'*') {
            star = Some((p, n));
            p += 1;
        } else if pattern.get(p).is_some_and(|&c| c == '?' || c == name[n]) {
            (p, n) = (p + 1, n + 1);
        } else if let Some((at, reach)) = star {
            star = Some((at, reach + 1));
            (p, n) = (at + 1, reach + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
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
            assert_eq!(key(Role::Color, Path::new(name)), expected, "{name}");
        }
        assert_eq!(key(Role::Depth, Path::new("a/0001-depth.tiff")), "0001");
        assert_eq!(key(Role::Depth, Path::new("0001-color.png")), "0001-color");
    }

    #[test]
    fn patterns_match_as_in_a_shell() {
        for (pattern, name) in
            [("*", ""), ("*-color.png", "1-color.png"), ("a?c", "abc"), ("*a*b", "xaab"), ("**.p?g", "x.png")]
        {
            assert!(matches(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in
            [("", "a"), ("?", ""), ("*-color.png", "1-depth.png"), ("a*b", "abc"), ("[a]", "a")]
        {
            assert!(!matches(pattern, name), "{pattern} {name}");
        }
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
