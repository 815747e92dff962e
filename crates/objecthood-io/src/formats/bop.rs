//! Folders of scenes in the layout of the BOP benchmark.
//!
//! `scene_camera.json` has the camera and the unit of depth of each image by its number; `depth/` has the images, called by the number in
//! six digits, `rgb/` or `gray/` the colour images of the same names. A scene without colour has depth alone.
//!
//! Source: the BOP toolkit, `docs/bop_datasets_format.md`.

use std::path::{Path, PathBuf};

use super::{FolderFormat, Format};
use crate::camera_file;
use crate::capture::Said;
use crate::error::{Error, Result};
use crate::given::Given;
use crate::images::{ImageFiles, frame_of};
use crate::source::Source;

pub(super) const FORMAT: Format = Format::Folder(FolderFormat { is_mine: is_bop, open });

const CAMERAS: &str = "scene_camera.json";
const DEPTH: &str = "depth";
/// Where colour lies, and the endings that data sets of the benchmark have.
const COLOR: [&str; 2] = ["rgb", "gray"];
const ENDINGS: [&str; 4] = ["png", "jpg", "tif", "jpeg"];

/// Units of a metre where a camera does not say: its depth is then in millimetres.
const DEPTH_SCALE: f64 = 1000.0;

fn is_bop(folder: &Path) -> bool {
    folder.join(CAMERAS).is_file() && folder.join(DEPTH).is_dir()
}

/// Lists the frames of a scene in the order of their numbers.
///
/// # Errors
/// [`Error::At`] the file of cameras: it cannot be read, or what is wrong with it; [`Error::NoFrames`] when it names none.
fn open(folder: &Path, given: &Given) -> Result<Source> {
    let path = folder.join(CAMERAS);
    let cameras = camera_file::open_images(&path)?;
    if cameras.is_empty() {
        return Err(Error::NoFrames.at(folder));
    }
    let frames = cameras.into_iter().map(|(number, camera)| {
        let name = format!("{number:06}");
        let find = |part: &str| {
            let files = ENDINGS.iter().map(|ending| folder.join(part).join(format!("{name}.{ending}")));
            files.into_iter().find(|file| file.is_file())
        };
        // A depth image that is missing is told when the frame is read.
        let depth: PathBuf = find(DEPTH).unwrap_or_else(|| folder.join(DEPTH).join(format!("{name}.png")));
        let color = COLOR.iter().find_map(|part| find(part));
        let said = Said {
            camera: Some(camera.camera),
            depth_scale: Some(camera.depth_scale.unwrap_or(DEPTH_SCALE)),
            ..Said::default()
        };
        frame_of(ImageFiles::new(color, depth), given, said)
    });
    Ok(Source::listed(frames.collect()).with_shared_files(vec![path]))
}
