//! Files and folders on the command line -> the list of frames, each with a name of its own for its outputs.

mod extent;
pub(crate) mod pairs;

use std::collections::{BTreeSet, HashMap, HashSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::Result;
use objecthood_io::camera_file::CameraFile;
use objecthood_io::images::{ImageError, ImageFiles, source_of};
use objecthood_io::{Capture, Error, FrameRef, Given, Selection, Source, Topic};

use crate::advice;
use crate::args::FrameArgs;
use crate::failure::usage;
use extent::Extent;

/// What stands for stdin on the command line.
pub(crate) const STDIN: &str = "-";

/// One frame to look at.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    /// The file, as the user would name it; of images that of the depth.
    pub(crate) path: PathBuf,
    /// Where its outputs go: relative to the folder of outputs, without extension.
    pub(crate) name: PathBuf,
    frame: FrameRef,
}

impl Input {
    /// Reads the frame.
    ///
    /// # Errors
    /// Whatever is wrong with a file, and its path.
    pub(crate) fn open(&self) -> objecthood_io::Result<Capture> {
        self.frame.read()
    }

    /// What decides its result, as [`FrameRef::fingerprint`] has it.
    ///
    /// # Errors
    /// When a file of it is not there.
    pub(crate) fn fingerprint(&self, settings: &str, shared: &[PathBuf]) -> objecthood_io::Result<String> {
        self.frame.fingerprint(settings, shared.iter().map(PathBuf::as_path))
    }

    /// How it is called beside others: its file, and its own name where a file holds many frames.
    pub(crate) fn title(&self) -> String {
        let path = self.path.display();
        match self.name.file_name().filter(|_| self.is_of_recording()) {
            Some(name) => format!("{path}: {}", name.display()),
            None => path.to_string(),
        }
    }

    /// Whether its file holds many frames: the name of each is that of the file and something more. Of images it is what their names have in common.
    pub(crate) fn is_of_recording(&self) -> bool {
        let [stem, name] = [self.path.file_stem(), self.name.file_name()].map(Option::unwrap_or_default);
        name != stem && name.as_encoded_bytes().starts_with(stem.as_encoded_bytes())
    }

    /// The recording that it is of, or the folder that it lies in.
    pub(crate) fn origin(&self) -> &Path {
        if self.is_of_recording() { &self.path } else { parent(&self.path) }
    }

    /// When it was measured (ns), as far as is known before it is read.
    pub(crate) fn stamp_ns(&self) -> Option<i64> {
        self.frame.stamp_ns()
    }

    /// The files that it is read from.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.frame.files()
    }

    /// A file of it that is listed but not there.
    pub(crate) fn missing_file(&self) -> Option<&Path> {
        self.files().find(|file| !file.exists())
    }
}

/// What was found.
#[derive(Debug, Default)]
pub(crate) struct Inputs {
    /// The frames, each once, in the order in which they were given; those of a folder in natural order.
    pub(crate) frames: Vec<Input>,
    /// Files and folders that cannot be read or hold no frame, images without a partner; each is reported like a frame
    /// that failed.
    pub(crate) unreadable: Vec<anyhow::Error>,
    /// What the user should know of folders that are read.
    pub(crate) notices: Vec<String>,
    /// The topics of the recordings.
    pub(crate) topics: Vec<Topic>,
    /// Camera files in folders, whether they are there or not.
    pub(crate) cameras: Vec<PathBuf>,
}

impl Inputs {
    /// The frames of a source; what cannot be read is noted.
    fn readable(&mut self, source: Source) -> Vec<FrameRef> {
        let mut frames = Vec::new();
        for frame in source {
            match frame {
                Ok(frame) => frames.push(frame),
                Err(error) => self.unreadable.push(error.into()),
            }
        }
        frames
    }
}

/// Makes the list of frames; `camera` is the one that the command line gives.
///
/// The outputs are named as the frames are: by the stem of the file, or what the names of images of a frame have in
/// common; with `keep_tree` by its place below the folder that is common to all arguments.
///
/// # Errors
/// Of usage, when no frame is selected, when two frames would have the same outputs, and when it is not said how depth images are to be read.
pub(crate) fn collect(args: &FrameArgs, keep_tree: bool, camera: Option<&CameraFile>) -> Result<Inputs> {
    if args.inputs.iter().any(|input| input == Path::new(STDIN)) {
        return Err(usage(
            "- is stdin, which only `segment - --format frames` reads: name a file, or ./- if that is one",
        ));
    }
    let given = args.given(camera);
    let selection = args.selection.selection();
    let mut inputs = Inputs::default();
    let mut listed = None;
    let mut folders = Folders::default();
    let (frames, tops) = if args.images.pairs.depth.is_empty() {
        open_all(args, &given, &selection, &mut inputs)
    } else {
        let pairs::Pairs { pairs, complaints } = pairs::find(&args.images.pairs)?;
        refuse_unknown_camera_or_unit(&given, &pairs)?;
        inputs.unreadable = complaints;
        let tops: BTreeSet<PathBuf> = pairs.iter().map(|pair| folders.of(&pair.depth)).collect();
        listed = Some(Extent { frames: pairs.len(), seconds: 0.0 });
        let source = source_of(pairs, &given).select(&selection);
        (inputs.readable(source), tops.into_iter().collect())
    };
    if frames.is_empty() && inputs.unreadable.is_empty() {
        let extents = || args.inputs.iter().map(|argument| Extent::at(argument, &given)).collect();
        return Err(no_frame(args, &listed.map_or_else(extents, |extent| vec![extent])));
    }
    if args.images.depth_scale.is_some() && !frames.is_empty() && frames.iter().all(FrameRef::is_metric) {
        return Err(usage("--depth-scale is for depth images but only point clouds are named: leave it out"));
    }

    let root = common_folder(&tops);
    let mut seen = HashSet::new();
    for frame in frames {
        let (path, folder) = (frame.path().to_owned(), folders.of(frame.path()));
        let place = if keep_tree { below(&root, &folder) } else { PathBuf::new() };
        let name = place.join(frame.name());
        // The folder is absolute, so that one file is one file however it was named.
        if seen.insert((folder, path.file_name().map(OsStr::to_owned), name.clone())) {
            inputs.frames.push(Input { path, name, frame });
        }
    }
    refuse_equal_names(&inputs.frames, keep_tree)?;
    Ok(inputs)
}

/// Opens what is named; the frames, and the folder of each argument in absolute form.
fn open_all(
    args: &FrameArgs,
    given: &Given,
    selection: &Selection,
    inputs: &mut Inputs,
) -> (Vec<FrameRef>, Vec<PathBuf>) {
    let mut frames = Vec::new();
    let mut tops = Vec::new();
    for argument in &args.inputs {
        tops.push(absolute(if argument.is_dir() { argument } else { parent(argument) }));
        match Source::open(argument, given) {
            Ok(source) => {
                inputs.notices.extend(source.notices().iter().map(ToString::to_string));
                inputs.cameras.extend_from_slice(source.shared_files());
                inputs.topics.extend_from_slice(source.topics());
                let before = inputs.unreadable.len();
                let found = inputs.readable(source.select(selection));
                if found.is_empty() && inputs.unreadable.len() == before && args.inputs.len() > 1 {
                    let (name, asked, has) =
                        (argument.display(), &args.selection, Extent::at(argument, given));
                    inputs.notices.push(format!("{name}: it has no frame{asked}, but {has}"));
                }
                frames.extend(found);
            }
            Err(error) => inputs.unreadable.push(error.into()),
        }
    }
    (frames, tops)
}

/// No input, each of such an extent, has a frame that is asked for.
fn no_frame(args: &FrameArgs, extents: &[Extent]) -> anyhow::Error {
    let asked = args.selection.to_string();
    if asked.is_empty() {
        return usage("there is no frame in what is named");
    }
    let has = Extent::of_longest(extents, &args.selection.selection());
    usage(format!("there is no frame{asked}: {has}"))
}

/// Refuses image files of which nobody says how they are to be read: once, and before anything is done.
///
/// # Errors
/// Of usage.
fn refuse_unknown_camera_or_unit(given: &Given, pairs: &[ImageFiles]) -> Result<()> {
    let said = |error: ImageError| {
        let error = anyhow::Error::from(Error::from(error));
        format!("{error}{}", advice::of(&error))
    };
    if given.camera.is_none() {
        return Err(usage(said(ImageError::NoCamera)));
    }
    // The numbers of a PNG are always integers.
    let is_png = |pair: &ImageFiles| pair.depth.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if given.depth_scale.is_none() && pairs.iter().any(is_png) {
        return Err(usage(format!("--depth-scale is missing: {}", said(ImageError::NoDepthScale))));
    }
    Ok(())
}

/// Folders in absolute form. Each is looked up once: a million files lie in few.
#[derive(Default)]
struct Folders(HashMap<PathBuf, PathBuf>);

impl Folders {
    /// The folder in which a file lies.
    fn of(&mut self, file: &Path) -> PathBuf {
        let folder = parent(file);
        if let Some(known) = self.0.get(folder) {
            return known.clone();
        }
        self.0.entry(folder.to_owned()).or_insert_with(|| absolute(folder)).clone()
    }
}

/// The folder in which a file lies, as the path names it.
fn parent(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
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

/// The way from `root` down to `folder`: names only, so that it leads nowhere else wherever it is appended. Empty when the folder is not below: a
/// recording may be a folder itself, and lies in the one above.
fn below(root: &Path, folder: &Path) -> PathBuf {
    let way = folder.strip_prefix(root).unwrap_or(Path::new(""));
    way.components().filter(|part| matches!(part, Component::Normal(_))).collect()
}

fn refuse_equal_names(frames: &[Input], keep_tree: bool) -> Result<()> {
    let mut names = HashMap::new();
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
        // A regression: frames of a recording that is a folder lie in the folder above.
        assert_eq!(below(Path::new("/a/recording"), Path::new("/a")), Path::new(""));
    }
}
