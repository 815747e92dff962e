//! Frames as folders that other programs read: the layouts of TUM and of BOP.
//!
//! Depth is 16-bit PNG. Its unit is the first of a millimetre, 1/5000 and 1/10000 m in which all depths are whole; without one the finest that
//! holds the farthest depth, and [`Rounding`] says what was lost.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use image::{ImageFormat, RgbImage};
use objecthood::{Camera, Frame, Raster};
use serde_json::json;

use super::bop::List;
use super::depth::WholeUnits;
use super::{Growing, cannot_write, write_together};
use crate::capture::Capture;
use crate::error::{Error, Result};
use crate::label_image;

/// Units of depth that make a metre, as they are common.
const SCALES: [f64; 3] = [1000.0, 5000.0, 10_000.0];

/// What depth lost when it was made whole units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounding {
    /// How far a depth may be from what it was (m).
    pub error_m: f32,
    /// Pixels that are too far to be written, and have no depth now.
    pub lost_px: usize,
}

impl Rounding {
    fn of(whole: &WholeUnits) -> Self {
        Self { error_m: whole.error_m, lost_px: whole.lost_px }
    }

    /// What two frames lost.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { error_m: self.error_m.max(other.error_m), lost_px: self.lost_px + other.lost_px }
    }
}

/// A folder in the layout of the TUM RGB-D benchmark: `rgb/`, `depth/`, lists of both with stamps, `groundtruth.txt` if there are poses, and
/// `camera.json`, which is ours and which [`Source`](crate::Source) reads.
#[derive(Debug)]
pub struct TumFolder {
    folder: PathBuf,
    rgb: Growing,
    depth: Growing,
    poses: Option<Growing>,
    /// Camera and depth scale of all frames.
    common: Option<(Camera, (usize, usize), f64)>,
    count: usize,
}

impl TumFolder {
    /// Begins the folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(folder: &Path) -> Result<Self> {
        make(folder, &["rgb", "depth"])?;
        let list = |name: &str| Growing::create(&folder.join(name));
        let (rgb, depth) = (list("rgb.txt")?, list("depth.txt")?);
        Ok(Self { folder: folder.to_owned(), rgb, depth, poses: None, common: None, count: 0 })
    }

    /// Adds a frame that was measured at `stamp_ns`, which the layout has in microseconds.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::NotForLayout`] without colour, and when the camera is not that of the frames before.
    pub fn add(&mut self, stamp_ns: i64, capture: &Capture) -> Result<Rounding> {
        let frame = &capture.frame;
        let no = |reason| Error::NotForLayout { layout: "TUM", reason };
        let color = frame.color().ok_or_else(|| no("the frame has no colour"))?;
        let (camera, size, scale) =
            *self.common.get_or_insert_with(|| (frame.camera(), frame.size(), best_units(frame).0));
        if (camera, size) != (frame.camera(), frame.size()) {
            return Err(no("the frame has another camera or size than the first one"));
        }
        let whole = WholeUnits::of(frame.depth_m(), scale);
        let rounding = Rounding::of(&whole);
        let name = format!("{:06}.png", self.count);
        self.count += 1;
        let path = |kind: &str| self.folder.join(kind).join(&name);
        write_together(&[(path("rgb"), rgb_png(color)?), (path("depth"), depth_png(frame, whole)?)])?;
        let stamp_us = stamp_ns.div_euclid(1000);
        let stamp = format!("{}.{:06}", stamp_us.div_euclid(1_000_000), stamp_us.rem_euclid(1_000_000));
        self.rgb.append(format!("{stamp} rgb/{name}\n").as_bytes())?;
        self.depth.append(format!("{stamp} depth/{name}\n").as_bytes())?;
        if let Some(pose) = capture.pose {
            let poses = match &mut self.poses {
                Some(poses) => poses,
                None => self.poses.insert(Growing::create(&self.folder.join("groundtruth.txt"))?),
            };
            let ([x, y, z], [qx, qy, qz, qw]) = (pose.position_m, pose.rotation_xyzw);
            poses.append(format!("{stamp} {x} {y} {z} {qx} {qy} {qz} {qw}\n").as_bytes())?;
        }
        Ok(rounding)
    }

    /// Ends the lists, which take their names.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(self) -> Result<()> {
        if let Some((Camera { fx_px, fy_px, cx_px, cy_px }, (width, height), scale)) = self.common {
            let camera = json!({
                "fx": fx_px, "fy": fy_px, "cx": cx_px, "cy": cy_px,
                "width": width, "height": height, "depth_scale": scale,
            });
            super::write_atomically(&self.folder.join("camera.json"), format!("{camera:#}\n").as_bytes())?;
        }
        self.poses.map(Growing::finish).transpose()?;
        self.rgb.finish()?;
        self.depth.finish()
    }
}

/// A scene in the layout of BOP: `rgb/`, `depth/` and `scene_camera.json`, which has for every image `cam_K`, `depth_scale` (millimetres of a
/// unit), and `cam_R_w2c`, `cam_t_w2c` (mm) where the pose is known.
#[derive(Debug)]
pub struct BopScene {
    folder: PathBuf,
    cameras: List,
    count: usize,
}

impl BopScene {
    /// Begins the scene in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(folder: &Path) -> Result<Self> {
        make(folder, &["rgb", "depth"])?;
        let cameras = List::create(&folder.join("scene_camera.json"), '{', '}')?;
        Ok(Self { folder: folder.to_owned(), cameras, count: 0 })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn add(&mut self, capture: &Capture) -> Result<Rounding> {
        let frame = &capture.frame;
        let (scale, whole) = best_units(frame);
        let rounding = Rounding::of(&whole);
        let path = |kind: &str| self.folder.join(kind).join(format!("{:06}.png", self.count));
        let mut files = vec![(path("depth"), depth_png(frame, whole)?)];
        if let Some(color) = frame.color() {
            files.push((path("rgb"), rgb_png(color)?));
        }
        write_together(&files)?;
        let Camera { fx_px, fy_px, cx_px, cy_px } = frame.camera();
        let mut camera = json!({
            "cam_K": [fx_px, 0.0, cx_px, 0.0, fy_px, cy_px, 0.0, 0.0, 1.0],
            "depth_scale": 1000.0 / scale,
        });
        if let Some(pose) = capture.pose {
            let to_camera = DMat3::from_quat(pose.rotation().inverse());
            let origin_mm = to_camera * DVec3::from(pose.position_m) * -1000.0;
            camera["cam_R_w2c"] = json!(to_camera.transpose().to_cols_array());
            camera["cam_t_w2c"] = json!(origin_mm.to_array());
        }
        self.cameras.push(&format!("\"{}\": ", self.count), &camera)?;
        self.count += 1;
        Ok(rounding)
    }

    /// Ends the list of cameras, which takes its name.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(self) -> Result<()> {
        self.cameras.finish()
    }
}

/// The unit for a frame, as units in a metre, and its depth in it.
fn best_units(frame: &Frame) -> (f64, WholeUnits) {
    let in_units = |scale: f64| (scale, WholeUnits::of(frame.depth_m(), scale));
    let exact = SCALES.into_iter().map(in_units).find(|(_, whole)| whole.is_exact());
    let finest = || SCALES.into_iter().rev().map(in_units).find(|(_, whole)| whole.lost_px == 0);
    exact.or_else(finest).unwrap_or_else(|| in_units(SCALES[0]))
}

fn make(folder: &Path, below: &[&str]) -> Result<()> {
    let made = below.iter().try_for_each(|name| fs::create_dir_all(folder.join(name)));
    made.map_err(|reason| cannot_write(folder, reason))
}

fn depth_png(frame: &Frame, whole: WholeUnits) -> Result<Vec<u8>> {
    let (width, height) = frame.size();
    label_image::encode(&Raster::from_vec(width, height, whole.units)?)
}

fn rgb_png(color: &Raster<[u8; 3]>) -> Result<Vec<u8>> {
    let png = |reason: String| Error::Png { reason };
    let size = u32::try_from(color.width()).ok().zip(u32::try_from(color.height()).ok());
    let samples = color.as_slice().as_flattened().to_vec();
    let image = size.and_then(|(width, height)| RgbImage::from_raw(width, height, samples));
    let image = image.ok_or_else(|| png("more than 2^31 columns or rows".into()))?;
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(|e| png(e.to_string()))?;
    Ok(bytes.into_inner())
}
