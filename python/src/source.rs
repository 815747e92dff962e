//! Files -> captures.

use std::path::{Path, PathBuf};

use objecthood_io::camera_file::{self, CameraFile};
use objecthood_io::images::{ImageFiles, source_of};
use objecthood_io::{DEFAULT_MAX_PIXELS, FrameRef, Given, GridCamera, Selection};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::capture::Capture;
use crate::errors::{FileError, InputError, core, file};

/// The frames of a file or a folder, found but not read.
#[pyclass(frozen, module = "objecthood")]
pub(crate) struct Source {
    /// A file that cannot be opened keeps its place, with the message.
    frames: Vec<Result<FrameRef, String>>,
    notices: Vec<String>,
    /// Files that all frames share.
    shared: Vec<PathBuf>,
}

/// The camera of a file, or of fx, fy, cx, cy.
#[derive(FromPyObject)]
pub(crate) enum CameraSource {
    /// Focal lengths and principal point (px).
    Numbers([f64; 4]),
    /// A camera file.
    Path(PathBuf),
}

impl CameraSource {
    fn read(self) -> PyResult<CameraFile> {
        match self {
            Self::Path(path) => camera_file::open(&path).map_err(file),
            Self::Numbers([fx, fy, cx, cy]) => {
                let camera = objecthood::Camera::new(fx, fy, cx, cy).map_err(core)?;
                Ok(CameraFile { camera: GridCamera { camera, size: None }, depth_scale: None })
            }
        }
    }
}

fn given(
    camera: Option<CameraSource>,
    depth_scale: Option<f64>,
    max_pixels: Option<usize>,
    topics: Vec<String>,
) -> PyResult<Given> {
    let camera = camera.map(CameraSource::read).transpose()?;
    Ok(Given {
        camera: camera.map(|known| known.camera),
        depth_scale: depth_scale.or(camera.and_then(|known| known.depth_scale)),
        max_pixels: max_pixels.unwrap_or(DEFAULT_MAX_PIXELS),
        topics,
    })
}

#[pymethods]
impl Source {
    /// Opens what lies at `path`; `frames` and `time` select some of it, `topics` are those of a recording to be read.
    #[new]
    #[pyo3(signature = (path, camera, depth_scale, max_pixels, topics, frames, time))]
    #[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
    #[expect(clippy::too_many_arguments, reason = "as many as there are keywords")]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        camera: Option<CameraSource>,
        depth_scale: Option<f64>,
        max_pixels: Option<usize>,
        topics: Vec<String>,
        frames: Option<&str>,
        time: Option<&str>,
    ) -> PyResult<Self> {
        let given = given(camera, depth_scale, max_pixels, topics)?;
        let frames = frames.map(str::parse).transpose().map_err(refused)?;
        let selection = Selection { frames, time: time.map(str::parse).transpose().map_err(refused)? };
        py.detach(|| {
            let source = objecthood_io::Source::open(&path, &given).map_err(file)?;
            Ok(Self::of(source.select(&selection)))
        })
    }

    /// Frames in image files: of each the colour image, if it has one, and the depth image.
    #[staticmethod]
    fn of_images(
        images: Vec<(Option<PathBuf>, PathBuf)>,
        camera: Option<CameraSource>,
        depth_scale: Option<f64>,
        max_pixels: Option<usize>,
    ) -> PyResult<Self> {
        let given = given(camera, depth_scale, max_pixels, Vec::new())?;
        let images = images.into_iter().map(|(color, depth)| ImageFiles::new(color, depth));
        Ok(Self::of(source_of(images.collect(), &given)))
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    /// Reads a frame.
    fn read(&self, py: Python<'_>, index: usize) -> PyResult<Capture> {
        let frame = self.frame(index)?;
        let capture = py.detach(|| frame.read()).map_err(file)?;
        Ok(Capture::new(capture, frame.path().to_string_lossy().into_owned()))
    }

    /// Name and file of a frame.
    fn name(&self, index: usize) -> PyResult<(String, PathBuf)> {
        let frame = self.frame(index)?;
        Ok((frame.name().to_string_lossy().into_owned(), frame.path().to_owned()))
    }

    /// The place of a frame in the source as it was opened, whatever is selected of it.
    fn number(&self, index: usize) -> PyResult<usize> {
        Ok(self.frame(index)?.number())
    }

    /// The files of a frame alone.
    fn files(&self, index: usize) -> PyResult<Vec<PathBuf>> {
        Ok(self.frame(index)?.files().map(Path::to_owned).collect())
    }

    /// What decides the result of a frame, with `settings` in words; no file is read.
    fn fingerprint(&self, py: Python<'_>, index: usize, settings: &str) -> PyResult<String> {
        let (frame, shared) = (self.frame(index)?, &self.shared);
        py.detach(|| frame.fingerprint(settings, shared.iter().map(PathBuf::as_path))).map_err(file)
    }

    /// When a frame was measured (ns), if that is known without reading it.
    fn stamp_ns(&self, index: usize) -> PyResult<Option<i64>> {
        Ok(self.frame(index)?.stamp_ns())
    }

    /// What the user should know of the source.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.notices.clone()
    }
}

impl Source {
    fn of(source: objecthood_io::Source) -> Self {
        let notices = source.notices().iter().map(ToString::to_string).collect();
        let shared = source.shared_files().to_vec();
        let frames = source.map(|frame| frame.map_err(|e| e.to_string())).collect();
        Self { frames, notices, shared }
    }

    fn frame(&self, index: usize) -> PyResult<&FrameRef> {
        let frame = self.frames.get(index);
        let frame =
            frame.ok_or_else(|| PyIndexError::new_err(format!("there are {} frames", self.frames.len())))?;
        frame.as_ref().map_err(|message| FileError::new_err(message.clone()))
    }
}

/// Reads a frame in image files.
#[pyfunction]
#[pyo3(signature = (depth, color, camera, depth_scale, max_pixels))]
pub(crate) fn read_images(
    py: Python<'_>,
    depth: PathBuf,
    color: Option<PathBuf>,
    camera: Option<CameraSource>,
    depth_scale: Option<f64>,
    max_pixels: Option<usize>,
) -> PyResult<Capture> {
    let given = given(camera, depth_scale, max_pixels, Vec::new())?;
    let path = depth.to_string_lossy().into_owned();
    let capture = py.detach(|| {
        let mut frames = source_of(vec![ImageFiles::new(color, depth)], &given).captures();
        frames.next().transpose()
    });
    let capture =
        capture.map_err(file)?.ok_or_else(|| FileError::new_err(format!("{path}: holds no frame")))?;
    Ok(Capture::new(capture, path))
}

/// What a camera file says: fx, fy, cx, cy (px), and units of depth that make a metre.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
pub(crate) fn read_camera(path: PathBuf) -> PyResult<([f64; 4], Option<f64>)> {
    let CameraFile { camera: GridCamera { camera, .. }, depth_scale } =
        camera_file::open(&path).map_err(file)?;
    Ok(([camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px], depth_scale))
}

/// Endings of the files that are looked for in folders.
#[pyfunction]
pub(crate) fn extensions() -> Vec<&'static str> {
    objecthood_io::extensions().collect()
}

/// A selection that is none.
#[expect(clippy::needless_pass_by_value, reason = "what map_err hands over")]
fn refused(error: objecthood_io::Error) -> PyErr {
    InputError::new_err(error.to_string())
}
