//! Scenes in the layout of BOP whose objects have masks.
//!
//! `mask_visib/IIIIII_OOOOOO.png` holds the visible pixels of object O in image I. What no mask covers is background. The splits are the folders
//! that hold the scenes, such as `test`.
//!
//! Source: the BOP toolkit, `docs/bop_datasets_format.md`.

use std::path::{Path, PathBuf};

use objecthood::Raster;
use objecthood_io::images::open_mask;
use objecthood_io::{DEFAULT_MAX_PIXELS, Given, GridCamera, Source};

use crate::dataset::{Layout, Scene, SceneRef, folders_below, list, text, way};
use crate::error::Result;
use crate::painted;

const MASKS: &str = "mask_visib";

/// The scenes under `root`; none if it has another layout.
pub(crate) fn list_scenes(root: &Path) -> Result<Vec<SceneRef>> {
    let is_scene = |folder: &Path| {
        folder.join("scene_camera.json").is_file()
            && folder.join("depth").is_dir()
            && folder.join(MASKS).is_dir()
    };
    let mut scenes = Vec::new();
    for folder in folders_below(root, is_scene)? {
        let way = way(root, &folder);
        let masks = list(&folder.join(MASKS))?;
        for (place, frame) in Source::open(&folder, &Given::default())?.enumerate() {
            let frame = frame?;
            let image = text(Some(frame.name()));
            let masks = masks.iter().filter(|mask| text(mask.file_stem()).starts_with(&format!("{image}_")));
            let masks: Vec<PathBuf> = masks.cloned().collect();
            // An image without masks is one that nobody looked at.
            if masks.is_empty() {
                continue;
            }
            let name = way.iter().chain([&image]).cloned().collect::<Vec<_>>().join("-");
            let split = way.len().checked_sub(2).and_then(|k| way.get(k)).cloned().unwrap_or_default();
            let layout = Layout::Masked { folder: folder.clone(), place, masks };
            scenes.push(SceneRef { name, folder: split, path: frame.path().to_owned(), layout });
        }
    }
    Ok(scenes)
}

/// Reads frame and truth of an image.
pub(crate) fn load(
    folder: &Path,
    place: usize,
    masks: &[PathBuf],
    camera: Option<&GridCamera>,
) -> Result<Scene> {
    let given = Given { camera: camera.copied(), ..Given::default() };
    let found = Source::open(folder, &given)?.nth(place);
    let frame = found.unwrap_or_else(|| Err(objecthood_io::Error::NoFrames.at(folder)))?.read()?.frame;
    let (width, height) = frame.size();
    let mut objects =
        Raster::from_vec(width, height, vec![0; width * height]).map_err(objecthood_io::Error::from)?;
    for (number, path) in (1_u32..).zip(masks) {
        let mask = open_mask(path, DEFAULT_MAX_PIXELS)?;
        if mask.size() != frame.size() {
            let (path, truth) = (path.clone(), mask.size());
            return Err(crate::Error::TruthSize { path, truth, frame: frame.size() });
        }
        let numbers = objects.as_slice().iter().zip(mask.as_slice());
        let numbers = numbers.map(|(&before, &is_of)| if is_of { number } else { before }).collect();
        objects = Raster::from_vec(width, height, numbers).map_err(objecthood_io::Error::from)?;
    }
    let truth = painted::truth_of(&frame, folder, &objects)?;
    Ok(Scene { frame, truth })
}
