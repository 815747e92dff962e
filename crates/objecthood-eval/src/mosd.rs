//! mOSD and data sets laid out like it: table-top scenes as point clouds with a truth label per point.
//!
//! * `ROOT/<folder>/<name><number>.pcd`, one scene a file; the folders `learn` and `test` are mOSD's splits.
//! * Raw labels: 0 = no point; 1..9 = (parts of) the table; 10k..10k+9 = the visible parts of one object, k >= 1.
//! * Roles: the truth label 0 is ignored, 1 is background; objects are numbered from 2.
//!
//! Source: S. Alexandrov's edition of the Object Segmentation Database (A. Richtsfeld, 2012).

use std::convert::Infallible;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::{fmt, fs, io};

use objecthood::{Camera, Frame, Raster};
use objecthood_io::formats::pcd;
use objecthood_io::{Given, GridCamera, open_frame};

use crate::error::{Error, Result};
use crate::truth::{Roles, Truth};

/// What the truth labels mean.
pub const ROLES: Roles = Roles { ignore: Some(0), background: Some(1) };

/// The camera of the data set, which its few unorganized clouds need: a Kinect v1 at 640 x 480.
const CAMERA: GridCamera = GridCamera {
    camera: Camera { fx_px: 525.0, fy_px: 525.0, cx_px: 319.5, cy_px: 239.5 },
    size: Some((640, 480)),
};

/// Which scenes of a data set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Split {
    /// Those of every folder.
    All,
    /// Those of one folder, for example `learn`.
    Folder(String),
}

impl Split {
    fn holds(&self, folder: &str) -> bool {
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
    /// File name without extension; unique in what [`scenes`] returns.
    pub name: String,
    /// Name of the folder it lies in.
    pub folder: String,
    /// The file.
    pub path: PathBuf,
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
    let folders: Vec<PathBuf> = list(root)?.into_iter().filter(|path| path.is_dir()).collect();
    let mut found = Vec::new();
    for folder in folders.iter().filter(|path| split.holds(&text(path.file_name()))) {
        for path in list(folder)?.into_iter().filter(|path| is_pcd(path)) {
            found.push(SceneRef { name: text(path.file_stem()), folder: text(folder.file_name()), path });
        }
    }
    if found.is_empty() {
        let folders = folders.iter().map(|path| text(path.file_name())).collect();
        return Err(Error::NoScenes { root: root.to_owned(), split: split.clone(), folders });
    }
    found.sort_by_cached_key(|s| (s.folder.clone(), number_in(&s.name), s.name.clone()));
    let mut by_name: Vec<&SceneRef> = found.iter().collect();
    by_name.sort_by_key(|s| &s.name);
    if let Some([first, second]) = by_name.array_windows().find(|[a, b]| a.name == b.name) {
        return Err(Error::SameName { first: first.path.clone(), second: second.path.clone() });
    }
    Ok(found)
}

/// Takes the scenes without truth out of a list: files whose header names no labels. What else may be wrong with a file
/// is found when it is read. Reads the head of every file.
pub fn take_unlabelled(scenes: &mut Vec<SceneRef>) -> Vec<SceneRef> {
    scenes.extract_if(.., |scene| scene.has_labels() == Some(false)).collect()
}

fn is_pcd(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pcd"))
}

/// What lies in a folder, by name, hidden files and folders left out.
fn list(folder: &Path) -> Result<Vec<PathBuf>> {
    let read = || fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>();
    let mut paths = read().map_err(|reason| Error::ReadFolder { path: folder.to_owned(), reason })?;
    paths.retain(|path| !text(path.file_name()).starts_with('.'));
    paths.sort();
    Ok(paths)
}

fn text(name: Option<&std::ffi::OsStr>) -> String {
    name.unwrap_or_default().to_string_lossy().into_owned()
}

/// The digits of `name` as one number of any length, such that numbers compare like their value.
fn number_in(name: &str) -> (usize, String) {
    let digits: String = name.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_start_matches('0');
    (digits.len(), digits.to_owned())
}

impl SceneRef {
    /// Whether the file has labels, if its header tells.
    fn has_labels(&self) -> Option<bool> {
        const HEADER_BYTES: u64 = 4096;
        let mut head = Vec::new();
        fs::File::open(&self.path).ok()?.take(HEADER_BYTES).read_to_end(&mut head).ok()?;
        pcd::has_labels(&head)
    }

    /// Reads frame and truth.
    ///
    /// The camera of an organized cloud is fitted from its points, an unorganized one was seen by the data set's own
    /// camera; `camera` overrides both.
    ///
    /// # Errors
    /// [`Error::Input`] when the file cannot be read as a frame, [`Error::NoTruth`] when it has no labels.
    pub fn load(&self, camera: Option<&GridCamera>) -> Result<Scene> {
        let open = |camera| open_frame(&self.path, &Given { camera, ..Given::default() });
        let capture = match open(camera.copied()) {
            Ok(capture) if capture.list.as_ref().is_some_and(|list| list.is_virtual) => open(Some(CAMERA)),
            Err(objecthood_io::Error::At { error, .. })
                if camera.is_none() && matches!(*error, objecthood_io::Error::NoView { .. }) =>
            {
                open(Some(CAMERA))
            }
            capture => capture,
        }?;
        let raw = capture.truth.ok_or_else(|| Error::NoTruth { path: self.path.clone() })?;
        Ok(Scene { frame: capture.frame, truth: truth_of(&raw)? })
    }
}

/// The truth behind raw labels: the table 1, objects renumbered 2.. by ascending label, parts likewise.
///
/// # Errors
/// None: [`Error::PartsSize`] cannot be, as both have the size of `raw`.
pub fn truth_of(raw: &Raster<u32>) -> Result<Truth> {
    Truth::new(renumbered(raw, |label| label / 10 * 10), renumbered(raw, |label| label), ROLES)
}

/// Table labels as 1, object labels as 2.. by ascending `object_of` label.
fn renumbered(raw: &Raster<u32>, object_of: impl Fn(u32) -> u32) -> Raster<u32> {
    let mut objects: Vec<u32> = raw.as_slice().iter().filter(|&&l| l >= 10).map(|&l| object_of(l)).collect();
    objects.sort_unstable();
    objects.dedup();
    raw.map(|&label| match label {
        0 => 0,
        1..10 => 1,
        _ => 2 + objects.partition_point(|&o| o < object_of(label)) as u32,
    })
}

/// The category of a scene of mOSD, by its name; `None` of any other scene. Ranges as in mOSD's README.
pub fn category(name: &str) -> Option<&'static str> {
    let number = |prefix| name.strip_prefix(prefix)?.parse::<u32>().ok();
    match (number("learn"), number("test")) {
        (Some(0..=16), _) | (_, Some(0..=15)) => Some("boxes"),
        (Some(17..=24), _) | (_, Some(16..=23)) => Some("stacked boxes"),
        (Some(25..=32), _) | (_, Some(24..=30)) => Some("occluded objects"),
        (Some(33..=44), _) | (_, Some(31..=42)) => Some("cylindric objects"),
        (_, Some(43..=54)) => Some("mixed objects"),
        (_, Some(55..=65)) => Some("complex scene"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_merged() {
        let raw = Raster::from_vec(8, 1, vec![0, 1, 9, 35, 31, 20, 30, 104]).unwrap();
        let truth = truth_of(&raw).unwrap();
        assert_eq!(truth.labels().as_slice(), [0, 1, 1, 3, 3, 2, 3, 4]);
        assert_eq!(truth.parts().as_slice(), [0, 1, 1, 5, 4, 2, 3, 6]);
        let objects: Vec<_> = (0..4).map(|i| truth.object_at(i)).collect();
        assert_eq!(objects, [None, None, None, Some(3)]);
        assert_eq!((truth.label_at(0), truth.label_at(1)), (None, Some(1)));
    }

    /// A scene of 4 x 2 points in the middle of the data set's image; all valid but the first.
    fn pcd(width: usize, fields: &str) -> String {
        let points = (0..8).map(|i| {
            let p = CAMERA.camera.back_project(300 + i % 4, 200 + i / 4, 1.0);
            let z = if i == 0 { f32::NAN } else { 1.0 };
            format!("{} {} {z} {}\n", p[0], p[1], 20 + i / 4 * 10)
        });
        let (sizes, types) = ("4 4 4 4", "F F F U");
        let height = 8 / width;
        let head = format!(
            "VERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\nCOUNT 1 1 1 1\nWIDTH {width}\n"
        );
        let size = format!("HEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 8\nDATA ascii\n");
        head + &size + &points.collect::<String>()
    }

    fn loaded(content: &str, camera: Option<&GridCamera>) -> Result<Scene> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a1.pcd");
        fs::write(&path, content).unwrap();
        SceneRef { name: "a1".to_owned(), folder: "a".to_owned(), path }.load(camera)
    }

    #[test]
    fn an_unorganized_scene_is_seen_by_the_camera_of_the_data_set() {
        let listed = loaded(&pcd(8, "x y z label"), None).unwrap();
        assert_eq!(listed.frame.size(), (640, 480));
        assert_eq!(listed.frame.camera(), CAMERA.camera);
        assert_eq!(listed.truth.labels().get(301, 200), Some(&2));
        assert_eq!(listed.truth.labels().get(303, 201), Some(&3));
        assert_eq!(listed.truth.labels().get(300, 200), Some(&0), "no depth");

        let small = GridCamera { size: Some((400, 300)), ..CAMERA };
        assert_eq!(loaded(&pcd(8, "x y z label"), Some(&small)).unwrap().frame.size(), (400, 300));
        assert_eq!(loaded(&pcd(4, "x y z label"), None).unwrap().frame.size(), (4, 2));
    }

    #[test]
    fn a_scene_without_labels_is_refused() {
        let error = loaded(&pcd(4, "x y z w"), None).unwrap_err();
        assert!(matches!(error, Error::NoTruth { .. }));
        assert!(error.to_string().contains("a1.pcd: no truth"), "{error}");
    }

    #[test]
    fn scenes_without_labels_are_taken_out() {
        let folder = tempfile::tempdir().unwrap();
        let scene = |name: &str, content: &str| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            SceneRef { name: name.to_owned(), folder: String::new(), path }
        };
        let mut scenes = vec![
            scene("labelled", &pcd(4, "x y z label")),
            scene("plain", &pcd(4, "x y z w")),
            scene("cut", &pcd(4, "x y z w")[..60]),
            scene("noise", "noise"),
            SceneRef { path: folder.path().join("gone"), ..scene("gone", "") },
        ];
        fs::remove_file(folder.path().join("gone")).unwrap();
        let names = |scenes: &[SceneRef]| scenes.iter().map(|s| s.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&take_unlabelled(&mut scenes)), ["plain"]);
        assert_eq!(names(&scenes), ["labelled", "cut", "noise", "gone"]);
    }

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

    #[test]
    fn categories_are_those_of_the_readme() {
        let categories: Vec<_> = (0..45)
            .map(|k| category(&format!("learn{k}")))
            .chain((0..66).map(|k| category(&format!("test{k}"))))
            .collect();
        let runs: Vec<_> =
            categories.chunk_by(|a, b| a == b).map(|run| (run[0].unwrap_or("?"), run.len())).collect();
        let expected = [
            ("boxes", 17),
            ("stacked boxes", 8),
            ("occluded objects", 8),
            ("cylindric objects", 12),
            ("boxes", 16),
            ("stacked boxes", 8),
            ("occluded objects", 7),
            ("cylindric objects", 12),
            ("mixed objects", 12),
            ("complex scene", 11),
        ];
        assert_eq!(runs, expected);
        assert_eq!(category("learn45"), None);
        assert_eq!(category("composite1"), None);
    }
}
