//! Files and folders on the command line -> the list of frames, each with a name of its own for its outputs.

mod pairs;

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};
use std::{fs, io};

use anyhow::{Result, anyhow};
use objecthood_io::camera_file::{self, CameraFile};
use objecthood_io::images::{self, ImageSetup};
use objecthood_io::{Capture, GridCamera, tum};

use crate::args::FrameArgs;
use crate::failure::usage;
use crate::natural;

/// One frame to look at.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Input {
    /// The file, as the user would name it; of images that of the depth.
    pub(crate) path: PathBuf,
    /// Where its outputs go: relative to the folder of outputs, without extension.
    pub(crate) name: PathBuf,
    /// How it is read.
    source: Source,
}

/// How a frame is read.
#[derive(Clone, Debug, PartialEq)]
enum Source {
    /// One file that has everything, but for a camera that may be given.
    Cloud { camera: Option<GridCamera>, max_pixels: usize },
    /// A depth image with perhaps a colour image.
    Images { color: Option<PathBuf>, setup: ImageSetup },
}

impl Input {
    /// Reads the frame.
    ///
    /// # Errors
    /// Whatever is wrong with a file, and its path.
    pub(crate) fn open(&self) -> objecthood_io::Result<Capture> {
        match &self.source {
            Source::Cloud { camera, max_pixels } => {
                objecthood_io::open(&self.path, camera.as_ref(), *max_pixels)
            }
            Source::Images { color, setup } => images::open_images(color.as_deref(), &self.path, setup),
        }
    }

    /// The files that it is read from.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let color = match &self.source {
            Source::Cloud { .. } => None,
            Source::Images { color, .. } => color.as_deref(),
        };
        color.into_iter().chain([self.path.as_path()])
    }
}

/// What was found.
#[derive(Debug)]
pub(crate) struct Inputs {
    /// The frames, each file once, in the order in which they were given; those of a folder in natural order.
    pub(crate) frames: Vec<Input>,
    /// Folders that hold no frame or cannot be read, images without a partner; each is reported like a frame that
    /// failed.
    pub(crate) unreadable: Vec<anyhow::Error>,
    /// What the user should know of folders that are read.
    pub(crate) notices: Vec<String>,
    /// Camera files in folders, whether they are there or not.
    pub(crate) cameras: Vec<PathBuf>,
}

/// A file before its outputs have a name.
struct Found {
    path: PathBuf,
    /// The folder it lies in: absolute, so that one file is one file however it was named.
    folder: PathBuf,
    /// What its outputs are called, without extension.
    stem: OsString,
    source: Source,
}

/// Makes the list of frames; `camera` is the one that the command line gives.
///
/// The outputs are named by the stem of the file, or what the names of images of a frame have in common; with
/// `keep_tree` by its place below the folder that is common to all arguments.
///
/// # Errors
/// Of usage, when two files would have the same outputs, and when it is not said how depth images are to be read.
pub(crate) fn collect(args: &FrameArgs, keep_tree: bool, camera: Option<&CameraFile>) -> Result<Inputs> {
    let mut found = Vec::new();
    let mut unreadable = Vec::new();
    let mut notices = Vec::new();
    let mut cameras = Vec::new();
    let mut tops = Vec::new();
    if args.images.depth.is_empty() {
        let cloud =
            Source::Cloud { camera: camera.map(|file| file.camera), max_pixels: args.images.max_pixels };
        for argument in &args.inputs {
            if argument.is_dir() {
                let top = absolute(argument);
                let before = (found.len(), unreadable.len());
                if tum::is_tum(argument) {
                    cameras.push(argument.join(tum::CAMERA));
                    match tum_frames(argument, args, camera, &mut notices) {
                        Ok(frames) => found.extend(frames),
                        Err(e) => unreadable.push(e),
                    }
                } else {
                    search(argument, &cloud, &mut found, &mut unreadable);
                }
                if (found.len(), unreadable.len()) == before {
                    unreadable.push(anyhow!(
                        "{}: no point cloud ({}) in this folder or below: name one that holds some, or images by \
                         --color and --depth",
                        argument.display(),
                        extensions()
                    ));
                }
                tops.push(top);
            } else {
                found.push(Found::file(argument.clone(), cloud.clone()));
                tops.push(folder_of(argument));
            }
        }
    } else {
        let pairs = pairs::find(&args.images.color, &args.images.depth)?;
        unreadable = pairs.complaints;
        let setup = image_setup(args, camera, &pairs.pairs)?;
        for pairs::Pair { color, depth, name } in pairs.pairs {
            tops.push(folder_of(&depth));
            let found_pair = Found::file(depth, Source::Images { color, setup });
            found.push(Found { stem: name.into(), ..found_pair });
        }
    }
    if args.images.depth_scale.is_some() && !found.is_empty() && !found.iter().any(Found::is_image) {
        return Err(usage("--depth-scale is for depth images but only point clouds are named: leave it out"));
    }
    let mut seen = BTreeSet::new();
    found.retain(|f| seen.insert((f.folder.clone(), f.path.file_name().map(OsStr::to_owned))));

    let root = common_folder(&tops);
    let frames: Vec<Input> = found
        .into_iter()
        .map(|Found { path, folder, stem, source }| {
            let place = if keep_tree { below(&root, &folder) } else { PathBuf::new() };
            Input { name: place.join(stem), path, source }
        })
        .collect();
    refuse_equal_names(&frames, keep_tree)?;
    Ok(Inputs { frames, unreadable, notices, cameras })
}

impl Found {
    /// A file whose outputs are called as it is.
    fn file(path: PathBuf, source: Source) -> Self {
        let stem = path.file_stem().unwrap_or(path.as_os_str()).to_owned();
        Self { folder: folder_of(&path), stem, path, source }
    }

    fn is_image(&self) -> bool {
        matches!(self.source, Source::Images { .. })
    }
}

/// How the images named on the command line are read.
///
/// # Errors
/// Of usage, when camera or unit is missing.
fn image_setup(args: &FrameArgs, camera: Option<&CameraFile>, pairs: &[pairs::Pair]) -> Result<ImageSetup> {
    let Some(&CameraFile { camera, depth_scale }) = camera else {
        return Err(usage(
            "depth images do not say which camera saw them: give it by --camera fx,fy,cx,cy or --camera camera.json",
        ));
    };
    let depth_scale = args.images.depth_scale.or(depth_scale);
    // Said once and before anything is done: the numbers of a PNG are always integers.
    let is_png = |pair: &pairs::Pair| pair.depth.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
    if depth_scale.is_none() && pairs.iter().any(is_png) {
        return Err(usage(format!("--depth-scale is missing: {}", images::ImageError::NoDepthScale)));
    }
    Ok(ImageSetup { camera, depth_scale, max_pixels: args.images.max_pixels })
}

/// The frames of a folder in the layout of TUM. Camera and unit of the command line come before those of its
/// `camera.json`.
fn tum_frames(
    folder: &Path,
    args: &FrameArgs,
    camera: Option<&CameraFile>,
    notices: &mut Vec<String>,
) -> Result<Vec<Found>> {
    let path = folder.join(tum::CAMERA);
    let own = if path.is_file() { Some(camera_file::open(&path)?) } else { None };
    let Some(CameraFile { camera: grid_camera, .. }) = camera.or(own.as_ref()) else {
        return Err(anyhow!(
            "{}: the folder has no camera.json: add one, or give the camera by --camera",
            folder.display()
        ));
    };
    let scales =
        [args.images.depth_scale, camera.and_then(|c| c.depth_scale), own.and_then(|c| c.depth_scale)];
    let setup = ImageSetup {
        camera: *grid_camera,
        depth_scale: Some(scales.into_iter().flatten().next().unwrap_or(tum::DEPTH_SCALE)),
        max_pixels: args.images.max_pixels,
    };
    let tum::TumFolder { pairs, color_alone, depth_alone } = tum::open_folder(folder)?;
    if pairs.is_empty() {
        return Err(anyhow!(
            "{}: none of its {color_alone} colour and {depth_alone} depth images were taken within 20 ms of each \
             other: check the times in rgb.txt and depth.txt",
            folder.display()
        ));
    }
    if color_alone + depth_alone > 0 {
        notices.push(format!(
            "{}: {} frames; {color_alone} colour and {depth_alone} depth images have no partner within 20 ms",
            folder.display(),
            pairs.len()
        ));
    }
    let frame = |(color, depth)| Found::file(depth, Source::Images { color: Some(color), setup });
    Ok(pairs.into_iter().map(frame).collect())
}

/// Adds the frames of a folder and of those below it. Links to folders are not followed: they may lead in circles.
fn search(folder: &Path, cloud: &Source, found: &mut Vec<Found>, unreadable: &mut Vec<anyhow::Error>) {
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
            search(&path, cloud, found, unreadable);
        } else if is_frame(&path) {
            found.push(Found::file(path, cloud.clone()));
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

/// The folder in which a file lies, in absolute form.
fn folder_of(file: &Path) -> PathBuf {
    absolute(file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")))
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
