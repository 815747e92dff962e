//! Data sets: where their scenes are, and what is true in each.
//!
//! | layout | told by | truth |
//! |---|---|---|
//! | [`mosd`] | folders of `.pcd` files | the labels of the points |
//! | `osd` | `annotation/`, `image_color/`, and `pcd/` or `disparity/` | images of labels |
//! | `ocid` | folders with `rgb/`, `label/` and `pcd/`, at any depth | images of labels |
//! | `bop` | folders with `scene_camera.json`, `depth/` and `mask_visib/`, at any depth | a mask for each object |

use std::convert::Infallible;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::{fmt, fs, io};

use objecthood::Frame;
use objecthood_io::GridCamera;

use crate::error::{Error, Result};
use crate::truth::Truth;
use crate::{bop, mosd, ocid, osd, painted};

/// Which scenes of a data set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// Those of every folder.
    All,
    /// Those of one folder, for example `learn`.
    Folder(String),
}

impl Split {
    /// Whether a folder is among them.
    pub(crate) fn holds(&self, folder: &str) -> bool {
        match self {
            Self::All => true,
            Self::Folder(name) => name == folder,
        }
    }
}

impl FromStr for Split {
    type Err = Infallible;

    /// `all`, or the name of a folder.
    fn from_str(text: &str) -> std::result::Result<Self, Infallible> {
        Ok(if text == "all" { Self::All } else { Self::Folder(text.to_owned()) })
    }
}

impl fmt::Display for Split {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::All => "all",
            Self::Folder(name) => name,
        })
    }
}

/// A scene that has been found but not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneRef {
    /// What it is called; unique in what [`scenes`] returns.
    pub name: String,
    /// Name of the folder it lies in, or what else splits the data set.
    pub folder: String,
    /// The file of its depth.
    pub path: PathBuf,
    /// How it is read.
    pub(crate) layout: Layout,
}

/// How the files of a scene are read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// A cloud with labels.
    Labelled,
    /// A cloud, or images of depth (mm) and colour, and an image of labels. Those up to `background` are no objects.
    Painted { color: Option<PathBuf>, truth: PathBuf, background: u16 },
    /// An image of a scene of BOP, by its place in the list of them, and a mask for each object.
    Masked { folder: PathBuf, place: usize, masks: Vec<PathBuf> },
}

/// A scene in memory.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the camera saw.
    pub frame: Frame,
    /// What is there.
    pub truth: Truth,
}

/// The scenes of `split` under `root`, by folder and then by the number in their name (`learn2` before `learn10`).
///
/// # Errors
/// [`Error::ReadFolder`] when `root` or a folder in it cannot be listed, [`Error::NoScenes`] with the folders there
/// are when there is nothing, [`Error::SameName`] when two folders hold a scene of the same name.
pub fn scenes(root: &Path, split: &Split) -> Result<Vec<SceneRef>> {
    let mut found = Vec::new();
    for list in [osd::list_scenes, ocid::list_scenes, bop::list_scenes] {
        found.extend(list(root)?);
        if !found.is_empty() {
            break;
        }
    }
    let mut found =
        if found.is_empty() { mosd::list_scenes(root, split)? } else { of_split(root, split, found)? };
    found.sort_by_cached_key(|s| (s.folder.clone(), number_in(&s.name), s.name.clone()));
    let mut by_name: Vec<&SceneRef> = found.iter().collect();
    by_name.sort_by_key(|s| &s.name);
    if let Some([first, second]) = by_name.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(Error::SameName { first: first.path.clone(), second: second.path.clone() });
    }
    Ok(found)
}

/// Those of a split.
fn of_split(root: &Path, split: &Split, mut scenes: Vec<SceneRef>) -> Result<Vec<SceneRef>> {
    let mut folders: Vec<String> = scenes.iter().map(|scene| scene.folder.clone()).collect();
    folders.sort();
    folders.dedup();
    scenes.retain(|scene| split.holds(&scene.folder));
    if scenes.is_empty() {
        return Err(Error::NoScenes { root: root.to_owned(), split: split.clone(), folders });
    }
    Ok(scenes)
}

impl SceneRef {
    /// Reads frame and truth.
    ///
    /// The camera of an organized cloud is fitted from its points; an unorganized one, and images of OSD, were seen by the data set's own
    /// camera; BOP says its cameras. `camera` overrides all of them.
    ///
    /// # Errors
    /// [`Error::Input`] when a file cannot be read, [`Error::NoTruth`] when a cloud has no labels, [`Error::TruthSize`] when an image of
    /// truth has not the size of the frame.
    pub fn load(&self, camera: Option<&GridCamera>) -> Result<Scene> {
        match &self.layout {
            Layout::Labelled => mosd::load(&self.path, camera),
            Layout::Painted { color, truth, background } => {
                painted::load(&self.path, color.as_deref(), truth, *background, camera)
            }
            Layout::Masked { folder, place, masks } => bop::load(folder, *place, masks, camera),
        }
    }
}

/// What lies in a folder, by name, hidden files and folders left out.
pub(crate) fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    let read = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut paths = read().map_err(|reason| Error::ReadFolder { path: folder.to_owned(), reason })?;
    paths.retain(|path| !text(path.file_name()).starts_with('.'));
    paths.sort();
    Ok(paths)
}

pub(crate) fn text(name: Option<&std::ffi::OsStr>) -> String {
    name.unwrap_or_default().to_string_lossy().into_owned()
}

/// The folders in and below `root` that fit, by name. Links to folders are not followed.
pub(crate) fn folders_below(root: &Path, fits: impl Fn(&Path) -> bool + Copy) -> Result<Vec<PathBuf>> {
    if fits(root) {
        return Ok(vec![root.to_owned()]);
    }
    let mut found = Vec::new();
    for path in list(root)?.into_iter().filter(|path| path.is_dir() && !path.is_symlink()) {
        found.extend(folders_below(&path, fits)?);
    }
    Ok(found)
}

/// The names of the folders from `root` down to `folder`.
pub(crate) fn way(root: &Path, folder: &Path) -> Vec<String> {
    let way = folder.strip_prefix(root).unwrap_or(folder);
    way.components().map(|part| text(Some(part.as_os_str()))).collect()
}

/// The digits of `name` as one number of any length, such that numbers compare like their value.
pub(crate) fn number_in(name: &str) -> (usize, String) {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_start_matches('0');
    (digits.len(), digits.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_sorted_by_folder_and_number() {
        let root = tempfile::tempdir().unwrap();
        let touch = |name: &str| {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        };
        let names = |split: &str| -> Vec<String> {
            scenes(root.path(), &split.parse().unwrap()).unwrap().into_iter().map(|s| s.name).collect()
        };
        for name in ["learn/learn10.pcd", "learn/learn9.pcd", "learn/learn011b.pcd", "learn/none.pcd"] {
            touch(name);
        }
        for other in ["learn/notes.txt", "learn/.learn1.pcd", ".git/a1.pcd", "a0.pcd", "empty/readme"] {
            touch(other);
        }
        touch("all2/x1.PCD");
        assert_eq!(names("learn"), ["none", "learn9", "learn10", "learn011b"]);
        assert_eq!(names("all"), ["x1", "none", "learn9", "learn10", "learn011b"]);

        let error = scenes(root.path(), &Split::Folder("test".to_owned())).unwrap_err().to_string();
        assert!(
            error.ends_with("no scenes of split `test`: the splits there are: all, all2, empty, learn"),
            "{error}"
        );
        let error = scenes(&root.path().join("learn"), &Split::All).unwrap_err().to_string();
        assert!(error.contains("folder that holds the folders"), "{error}");
        let error = scenes(&root.path().join("nowhere"), &Split::All).unwrap_err();
        assert!(matches!(error, Error::ReadFolder { .. }));

        touch("other/learn9.pcd");
        assert!(matches!(scenes(root.path(), &Split::All), Err(Error::SameName { .. })));
        assert_eq!(names("other"), ["learn9"]);
    }
}
