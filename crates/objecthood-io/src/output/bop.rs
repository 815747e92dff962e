//! Objects of a run in the layout of BOP, the benchmark of pose estimation.
//!
//! | file | what |
//! |---|---|
//! | `objecthood_results.json` | the list of detections that BOP's task "2D detection and segmentation of unseen objects" takes |
//! | `SCENE/mask_visib/IMAGE_INSTANCE.png` | the pixels of an object, 255, in an 8-bit image; instances count from 0 |
//! | `SCENE/scene_gt.json` | the pose of each object: that of its box (`cam_R_m2c` row by row, `cam_t_m2c` in mm); `obj_id` is its number in the label image |
//! | `SCENE/scene_gt_info.json` | its boxes and pixel counts |
//! | `SCENE/scene_camera.json` | `cam_K` |
//!
//! Nothing is known of what is hidden: `bbox_obj` is `bbox_visib`, `px_count_all` is `px_count_visib`, `visib_fract` is 1. `time` is -1, BOP's
//! sign for "not measured": equal inputs give equal files. Source: BOP toolkit, `docs/bop_datasets_format.md`, and the rules of the challenge of 2024.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat};
use image::{GrayImage, ImageFormat};
use objecthood::{Camera, OrientedBox, PixelBox, Raster};
use serde_json::{Value, json};

use super::instances::Instance;
use super::{Growing, cannot_write};
use crate::error::{Error, Result};

/// The file of detections, of all scenes.
pub const RESULTS: &str = "objecthood_results.json";

/// The category of things of which nothing is known.
const CATEGORY: u8 = 1;

/// Which image of a data set a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ImageId {
    /// Number of the scene.
    pub scene: u32,
    /// Number of the image in it.
    pub image: u32,
}

impl ImageId {
    /// The numbers of frames, given as their paths and names: the name of a frame, if it is a number, and the nearest folder above
    /// whose name is one, else scene 0. If they do not tell the frames apart: images 0, 1, 2, .. of scene 0.
    pub fn of_frames<'a>(frames: impl Iterator<Item = (&'a Path, &'a Path)> + Clone) -> Vec<Self> {
        let number =
            |name: &Path| name.to_str().filter(|name| name.bytes().all(|b| b.is_ascii_digit()))?.parse().ok();
        let told: Option<Vec<Self>> = frames
            .clone()
            .map(|(path, name)| {
                let scene = path.ancestors().skip(1).find_map(|above| number(above.file_name()?.as_ref()));
                Some(Self { scene: scene.unwrap_or(0), image: number(name.file_name()?.as_ref())? })
            })
            .collect();
        let counted = || (0..).zip(frames).map(|(image, _)| Self { scene: 0, image }).collect();
        told.filter(|ids| {
            let mut sorted = ids.clone();
            sorted.sort_unstable();
            sorted.windows(2).all(|pair| pair[0] != pair[1])
        })
        .unwrap_or_else(counted)
    }

    fn scene_folder(self, folder: &Path) -> PathBuf {
        folder.join(format!("{:06}", self.scene))
    }
}

/// The masks of a frame's objects, with their paths below `folder`.
///
/// # Errors
/// [`Error::Png`] when the image is larger than a PNG can be.
pub fn masks(
    folder: &Path,
    id: ImageId,
    labels: &Raster<u16>,
    found: &[Instance],
) -> Result<Vec<(PathBuf, Vec<u8>)>> {
    let masks = id.scene_folder(folder).join("mask_visib");
    let named = found.iter().enumerate();
    named
        .map(|(k, instance)| {
            Ok((masks.join(format!("{:06}_{k:06}.png", id.image)), mask(labels, instance.id)?))
        })
        .collect()
}

/// An 8-bit PNG, 255 at the pixels of a label.
fn mask(labels: &Raster<u16>, label: u16) -> Result<Vec<u8>> {
    let png = |reason: String| Error::Png { reason };
    let samples = labels.as_slice().iter().map(|&l| if l == label { 255 } else { 0 }).collect();
    let size = u32::try_from(labels.width()).ok().zip(u32::try_from(labels.height()).ok());
    let image = size.and_then(|(width, height)| GrayImage::from_raw(width, height, samples));
    let image = image.ok_or_else(|| png("more than 2^31 columns or rows".into()))?;
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|e| png(e.to_string()))?;
    Ok(bytes.into_inner())
}

/// The lists of a run, which grow frame by frame.
#[derive(Debug)]
pub struct BopLists {
    folder: PathBuf,
    results: List,
    scenes: BTreeMap<u32, Scene>,
}

/// The lists of a scene.
#[derive(Debug)]
struct Scene {
    poses: List,
    info: List,
    cameras: List,
}

impl BopLists {
    /// Begins the lists in a folder that is there.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(folder: &Path) -> Result<Self> {
        let results = List::create(&folder.join(RESULTS), '[', ']')?;
        Ok(Self { folder: folder.to_owned(), results, scenes: BTreeMap::new() })
    }

    /// Adds the objects of a frame.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn add(&mut self, id: ImageId, camera: Camera, found: &[Instance]) -> Result<()> {
        for instance in found {
            self.results.push("", &result(id, instance))?;
        }
        if !self.scenes.contains_key(&id.scene) {
            self.scenes.insert(id.scene, Scene::create(&id.scene_folder(&self.folder))?);
        }
        let Some(scene) = self.scenes.get_mut(&id.scene) else { return Ok(()) };
        let key = format!("\"{}\": ", id.image);
        scene.poses.push(&key, &found.iter().map(pose).collect())?;
        scene.info.push(&key, &found.iter().map(info).collect())?;
        let Camera { fx_px, fy_px, cx_px, cy_px } = camera;
        let cam_k = [fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0];
        scene.cameras.push(&key, &json!({"cam_K": cam_k}))
    }

    /// Ends the lists, which take their names.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(self) -> Result<()> {
        for Scene { poses, info, cameras } in self.scenes.into_values() {
            [poses, info, cameras].into_iter().try_for_each(List::finish)?;
        }
        self.results.finish()
    }
}

impl Scene {
    fn create(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder).map_err(|reason| cannot_write(folder, reason))?;
        let list = |name: &str| List::create(&folder.join(name), '{', '}');
        Ok(Self {
            poses: list("scene_gt.json")?,
            info: list("scene_gt_info.json")?,
            cameras: list("scene_camera.json")?,
        })
    }
}

/// JSON with an element a line.
#[derive(Debug)]
pub(super) struct List {
    file: Growing,
    /// What stands before the next element.
    before: String,
    end: char,
}

impl List {
    pub(super) fn create(path: &Path, begin: char, end: char) -> Result<Self> {
        Ok(Self { file: Growing::create(path)?, before: format!("{begin}\n"), end })
    }

    pub(super) fn push(&mut self, key: &str, value: &Value) -> Result<()> {
        let before = std::mem::replace(&mut self.before, ",\n".to_owned());
        self.file.append(format!("{before}{key}{value}").as_bytes())
    }

    pub(super) fn finish(mut self) -> Result<()> {
        let begin = if self.before == ",\n" { "\n" } else { &self.before };
        let end = format!("{begin}{}\n", self.end);
        self.file.append(end.as_bytes())?;
        self.file.finish()
    }
}

/// A detection.
fn result(id: ImageId, instance: &Instance) -> Value {
    json!({
        "scene_id": id.scene,
        "image_id": id.image,
        "category_id": CATEGORY,
        "score": instance.score,
        "bbox": rectangle(instance.box_px),
        "segmentation": instance.mask,
        "time": -1,
    })
}

fn rectangle(area: PixelBox) -> [usize; 4] {
    [area.u, area.v, area.width, area.height]
}

fn pose(instance: &Instance) -> Value {
    let OrientedBox { center_m, rotation_xyzw, .. } = instance.box_m;
    let rotation = DMat3::from_quat(DQuat::from_array(rotation_xyzw.map(f64::from)).normalize());
    json!({
        "cam_R_m2c": rotation.transpose().to_cols_array(),
        "cam_t_m2c": center_m.map(|c| 1000.0 * f64::from(c)),
        "obj_id": instance.id,
    })
}

fn info(instance: &Instance) -> Value {
    json!({
        "bbox_obj": rectangle(instance.box_px),
        "bbox_visib": rectangle(instance.box_px),
        "px_count_all": instance.area_px,
        "px_count_valid": instance.measured_px,
        "px_count_visib": instance.area_px,
        "visib_fract": 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_by_their_names_where_these_tell_them_apart() {
        let ids = |frames: &[(&str, &str)]| {
            let frames: Vec<(&Path, &Path)> =
                frames.iter().map(|&(p, n)| (Path::new(p), Path::new(n))).collect();
            ImageId::of_frames(frames.into_iter()).iter().map(|id| (id.scene, id.image)).collect::<Vec<_>>()
        };
        assert_eq!(
            ids(&[("bop/000048/depth/000001.png", "000001"), ("bop/000049/depth/000001.png", "000001")]),
            [(48, 1), (49, 1)]
        );
        assert_eq!(ids(&[("a/7.pcd", "7"), ("a/3.pcd", "3")]), [(0, 7), (0, 3)]);
        assert_eq!(ids(&[("a/learn7.pcd", "learn7"), ("a/3.pcd", "3")]), [(0, 0), (0, 1)]);
        assert_eq!(ids(&[("a/3.pcd", "3"), ("b/3.pcd", "3")]), [(0, 0), (0, 1)]);
        assert_eq!(ids(&[("a/99999999999.pcd", "99999999999")]), [(0, 0)]);
    }
}
