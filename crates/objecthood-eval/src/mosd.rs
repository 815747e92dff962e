//! mOSD and data sets laid out like it: table-top scenes as point clouds with a truth label per point.
//!
//! * `ROOT/<folder>/<name><number>.pcd`, one scene a file; the folders `learn` and `test` are mOSD's splits.
//! * Raw labels: 0 = no point; 1..9 = (parts of) the table; 10k..10k+9 = the visible parts of one object, k >= 1.
//! * Roles: the truth label 0 is ignored, 1 is background; objects are numbered from 2.
//!
//! Source: S. Alexandrov's edition of the Object Segmentation Database (A. Richtsfeld, 2012).

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use objecthood::{Camera, Raster};
use objecthood_io::formats::pcd;
use objecthood_io::{Given, GridCamera, open_frame};

use crate::dataset::{Layout, Scene, SceneRef, Split, list, text};
use crate::error::{Error, Result};
use crate::truth::{Roles, Truth};

/// What the truth labels mean.
pub const ROLES: Roles = Roles { ignore: Some(0), background: Some(1) };

/// The camera of the data set, which its few unorganized clouds and the images of OSD need: a Kinect v1 at 640 x 480.
pub(crate) const CAMERA: GridCamera = GridCamera {
    camera: Camera { fx_px: 525.0, fy_px: 525.0, cx_px: 319.5, cy_px: 239.5 },
    size: Some((640, 480)),
};

/// The scenes of `split` under `root`.
///
/// # Errors
/// [`Error::ReadFolder`] when `root` or a folder in it cannot be listed, [`Error::NoScenes`] with the folders there
/// are when there is nothing.
pub(crate) fn list_scenes(root: &Path, split: &Split) -> Result<Vec<SceneRef>> {
    let folders: Vec<PathBuf> = list(root)?.into_iter().filter(|path| path.is_dir()).collect();
    let mut found = Vec::new();
    for folder in folders.iter().filter(|path| split.holds(&text(path.file_name()))) {
        for path in list(folder)?.into_iter().filter(|path| is_pcd(path)) {
            let (name, folder) = (text(path.file_stem()), text(folder.file_name()));
            found.push(SceneRef { name, folder, path, layout: Layout::Labelled });
        }
    }
    if found.is_empty() {
        let folders = folders.iter().map(|path| text(path.file_name())).collect();
        return Err(Error::NoScenes { root: root.to_owned(), split: split.clone(), folders });
    }
    Ok(found)
}

/// Takes the scenes without truth out of a list: files whose header names no labels. What else may be wrong with a file
/// is found when it is read. Reads the head of every file.
pub fn take_unlabelled(scenes: &mut Vec<SceneRef>) -> Vec<SceneRef> {
    scenes
        .extract_if(.., |scene| scene.layout == Layout::Labelled && has_labels(scene) == Some(false))
        .collect()
}

fn is_pcd(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("pcd"))
}

/// Whether the file of a scene has labels, if its header tells.
fn has_labels(scene: &SceneRef) -> Option<bool> {
    const HEADER_BYTES: u64 = 4096;
    let mut head = Vec::new();
    fs::File::open(&scene.path).ok()?.take(HEADER_BYTES).read_to_end(&mut head).ok()?;
    pcd::has_labels(&head)
}

/// Reads frame and truth of a labelled cloud.
///
/// # Errors
/// [`Error::Input`] when the file cannot be read as a frame, [`Error::NoTruth`] when it has no labels.
pub(crate) fn load(path: &Path, camera: Option<&GridCamera>) -> Result<Scene> {
    let open = |camera| open_frame(path, &Given { camera, ..Given::default() });
    let capture = match open(camera.copied()) {
        Ok(capture) if capture.list.as_ref().is_some_and(|list| list.is_virtual) => open(Some(CAMERA)),
        Err(objecthood_io::Error::At { error, .. })
            if camera.is_none() && matches!(*error, objecthood_io::Error::NoView { .. }) =>
        {
            open(Some(CAMERA))
        }
        capture => capture,
    }?;
    let raw = capture.truth.ok_or_else(|| Error::NoTruth { path: path.to_owned() })?;
    Ok(Scene { frame: capture.frame, truth: truth_of(&raw)? })
}

/// The truth behind raw labels: the table 1, objects renumbered 2.. by ascending label, parts likewise.
///
/// # Errors
/// None: [`Error::PartsSize`] cannot be, as both have the size of `raw`.
pub fn truth_of(raw: &Raster<u32>) -> Result<Truth> {
    Truth::new(renumbered(raw, |label| label / 10 * 10), renumbered(raw, |label| label), ROLES)
}

/// Raw labels with this truth: [`truth_of`] reads it back, without the parts of objects.
pub fn labels_of(truth: &Truth) -> Raster<u32> {
    let mut labels = truth.labels().clone();
    for (i, label) in labels.as_mut_slice().iter_mut().enumerate() {
        *label = match (truth.label_at(i), truth.object_at(i)) {
            (None, _) => 0,
            (Some(_), None) => 1,
            // Objects may be numbered from 0.
            (Some(_), Some(object)) => 10 * (object + 1),
        };
    }
    labels
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
        load(&path, camera)
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
            SceneRef { name: name.to_owned(), folder: String::new(), path, layout: Layout::Labelled }
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
