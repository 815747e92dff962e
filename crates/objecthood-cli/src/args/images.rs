//! What is said of images: which, by which camera, and what of them is looked at.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;
use objecthood_io::camera_file::{self, CameraFile};
use objecthood_io::images::open_mask;
use objecthood_io::scope::{DepthRange, Region, Scope};
use objecthood_io::{DEFAULT_MAX_PIXELS, Error, GridCamera, extensions};

use super::number::whole;
use crate::failure::usage;

/// Image files that make frames.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Images")]
pub(crate) struct PairArgs {
    /// Colour images (PNG, JPEG, TIFF), registered to the depth: files, a folder, or a pattern such as '*-color.png';
    /// joined with the depth images by what is left of their names without `color`, `rgb` and `depth`.
    #[arg(long, value_name = "PATH", num_args = 1.., requires = "depth")]
    pub(crate) color: Vec<PathBuf>,

    /// Depth images (16-bit PNG, 16-bit or float TIFF, EXR, NPY): files, a folder, or a pattern such as '*-depth.png'.
    #[arg(long, value_name = "PATH", num_args = 1..)]
    pub(crate) depth: Vec<PathBuf>,
}

/// Frames in image files.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Images")]
pub(crate) struct ImageArgs {
    #[command(flatten)]
    pub(crate) pairs: PairArgs,

    /// Units of the depth images that are a metre: 1000 for millimetres, 5000 for TUM, 10000 for YCB-Video. Needed for
    /// integer depth, unless the camera file says it.
    #[arg(long, value_name = "N", value_parser = positive)]
    pub(crate) depth_scale: Option<f64>,

    /// Refuse frames of more pixels; each takes about 200 bytes a pixel while it is looked at.
    #[arg(long, value_name = "N", default_value_t = DEFAULT_MAX_PIXELS, value_parser = whole(1_usize, objecthood::Raster::<f32>::MAX_PIXELS))]
    pub(crate) max_pixels: usize,
}

/// Limits of what is looked at, in frames of any kind.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "What is looked at")]
pub(crate) struct ScopeArgs {
    /// Look at these depths only, in metres; either end may be left out.
    #[arg(long, value_name = "NEAREST..FARTHEST")]
    range: Option<DepthRange>,

    /// Look at this part of the image only, in pixels.
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT")]
    roi: Option<Region>,

    /// Look at the pixels only that are not black in this image, which has the size of the frames.
    #[arg(long, value_name = "FILE")]
    mask: Option<PathBuf>,
}

impl ScopeArgs {
    /// The limits, with the mask read.
    ///
    /// # Errors
    /// Of usage, when the mask cannot be.
    pub(crate) fn read(&self, max_pixels: usize) -> Result<Scope> {
        let mask = self.mask.as_deref().map(|path| open_mask(path, max_pixels)).transpose();
        let mask = mask.map_err(|e| usage(format!("--mask {e}")))?;
        Ok(Scope { range: self.range, region: self.roi, mask })
    }

    /// The file of the mask.
    pub(crate) fn mask(&self) -> Option<&Path> {
        self.mask.as_deref()
    }
}

/// A camera, or where to read it.
#[derive(Clone, Debug)]
pub(crate) enum CameraArg {
    Given(GridCamera),
    File(PathBuf),
}

impl CameraArg {
    /// Numbers are a camera; anything else that may be a file is one.
    pub(crate) fn parse(text: &str) -> Result<Self, Error> {
        let is_named =
            |text: &str| [".json", ".yaml", ".yml", ".txt"].iter().any(|e| text.to_lowercase().ends_with(e));
        let is_file = |text: &str| is_named(text) || Path::new(text).exists();
        match text.parse() {
            Ok(camera) => Ok(Self::Given(camera)),
            Err(_) if is_file(text) => Ok(Self::File(text.into())),
            Err(e) => Err(e),
        }
    }

    /// The file that it is read from, if it is.
    pub(crate) fn file(&self) -> Option<&Path> {
        match self {
            Self::Given(_) => None,
            Self::File(path) => Some(path),
        }
    }

    /// The camera.
    ///
    /// # Errors
    /// Of usage, when the file cannot be read or holds none.
    pub(crate) fn read(&self) -> Result<CameraFile> {
        match self {
            Self::Given(camera) => Ok(CameraFile { camera: *camera, depth_scale: None }),
            Self::File(path) => camera_file::open(path).map_err(|e| usage(format!("--camera {e}"))),
        }
    }
}

/// What may be named without an option.
pub(super) fn inputs_help() -> String {
    let endings = extensions().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ");
    format!(
        "Clouds, arrays and recordings ({endings}), folders that are searched for them, folders in the layout of TUM (rgb.txt, depth.txt) or BOP (scene_camera.json)"
    )
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "give a positive number, for example 1000 for millimetres".to_owned())
}
