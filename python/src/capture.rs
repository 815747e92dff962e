//! A frame: depth, colour, camera, and what its file says.

use std::sync::Arc;

use numpy::{PyArray2, PyArray3, PyReadonlyArray2, PyReadonlyArray3};
use objecthood::{Camera, Raster};
use objecthood_io::images::{capture_of, metres_of_floats, metres_of_units};
use objecthood_io::{Given, GridCamera};
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::{InputError, core, input};

/// One RGB-D image with its camera. It never changes.
#[pyclass(frozen, module = "objecthood")]
pub(crate) struct Capture {
    pub(crate) inner: Arc<objecthood_io::Capture>,
    /// Where it is from, as the user named it; empty for arrays.
    pub(crate) source: String,
}

impl Capture {
    pub(crate) fn new(capture: objecthood_io::Capture, source: String) -> Self {
        Self { inner: Arc::new(capture), source }
    }

    fn of(
        depth_m: Raster<f32>,
        camera: [f64; 4],
        color: Option<&PyReadonlyArray3<'_, u8>>,
    ) -> PyResult<Self> {
        let color = color.map(arrays::color).transpose()?;
        let [fx, fy, cx, cy] = camera;
        let camera = GridCamera { camera: Camera::new(fx, fy, cx, cy).map_err(core)?, size: None };
        let given = Given { camera: Some(camera), ..Given::default() };
        Ok(Self::new(capture_of(color, depth_m, &given).map_err(input)?, String::new()))
    }
}

#[pymethods]
impl Capture {
    /// Of depth in metres, or in units of which `depth_scale` make a metre.
    #[staticmethod]
    #[pyo3(signature = (depth, camera, color, depth_scale))]
    #[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
    fn of_floats(
        depth: PyReadonlyArray2<'_, f32>,
        camera: [f64; 4],
        color: Option<PyReadonlyArray3<'_, u8>>,
        depth_scale: Option<f64>,
    ) -> PyResult<Self> {
        let depth_m = match depth_scale {
            Some(scale) => arrays::raster(&depth, |raw| metres_of_floats(raw.iter().copied(), scale))?,
            None => arrays::raster(&depth, <[f32]>::to_vec)?,
        };
        Self::of(depth_m, camera, color.as_ref())
    }

    /// Of depth in whole units of which `depth_scale` make a metre.
    #[staticmethod]
    #[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
    fn of_integers(
        depth: PyReadonlyArray2<'_, u16>,
        camera: [f64; 4],
        color: Option<PyReadonlyArray3<'_, u8>>,
        depth_scale: f64,
    ) -> PyResult<Self> {
        let depth_m = arrays::raster(&depth, |raw| metres_of_units(raw.iter().copied(), depth_scale))?;
        Self::of(depth_m, camera, color.as_ref())
    }

    /// The same frame with the direction in which things fall, in the frame of the file's points.
    fn with_gravity(&self, gravity: [f32; 3]) -> PyResult<Self> {
        let up = self.inner.to_camera_direction(gravity).map(|part| -part);
        self.with_up(up)
    }

    /// The same frame with gravity along -z of the world of its pose.
    fn with_gravity_of_pose(&self) -> PyResult<Self> {
        let pose = self
            .inner
            .pose
            .ok_or_else(|| InputError::new_err("the frame has no pose: give gravity as three numbers"))?;
        self.with_up(pose.up())
    }

    /// Name of the frame: of files the name without its ending; empty for arrays.
    #[getter]
    fn name(&self) -> String {
        self.inner.name.to_string_lossy().into_owned()
    }

    /// The file it is from; empty for arrays.
    #[getter]
    fn path(&self) -> &str {
        &self.source
    }

    /// When the depth was measured (ns by the clock of the source), if that is known.
    #[getter]
    fn stamp_ns(&self) -> Option<i64> {
        self.inner.stamp_ns
    }

    /// Rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        let (width, height) = self.inner.frame.size();
        (height, width)
    }

    /// Focal lengths and principal point: fx, fy, cx, cy (px).
    #[getter]
    fn camera(&self) -> (f64, f64, f64, f64) {
        let Camera { fx_px, fy_px, cx_px, cy_px } = self.inner.frame.camera();
        (fx_px, fy_px, cx_px, cy_px)
    }

    /// Depth along the optical axis, H x W float32 (m), NaN = none. A copy.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        arrays::image(py, self.inner.frame.depth_m())
    }

    /// Colour, H x W x 3 uint8 RGB, if there is any. A copy.
    #[getter]
    fn color<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<u8>>>> {
        self.inner.frame.color().map(|color| arrays::image3(py, color)).transpose()
    }

    /// The true label of every pixel, H x W uint32 as the file has it, if there is a truth. A copy.
    #[getter]
    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<u32>>>> {
        self.inner.truth.as_ref().map(|truth| arrays::image(py, truth)).transpose()
    }

    /// Where the camera was, if that is known: position (m) and unit quaternion x, y, z, w that take its points to the world.
    #[getter]
    fn pose(&self) -> Option<([f64; 3], [f64; 4])> {
        self.inner.pose.map(|pose| (pose.position_m, pose.rotation_xyzw))
    }

    fn __repr__(&self) -> String {
        let (width, height) = self.inner.frame.size();
        let color = if self.inner.frame.color().is_some() { "colour" } else { "no colour" };
        let name = if self.source.is_empty() { String::new() } else { format!(" {:?},", self.source) };
        format!("<objecthood.Capture{name} {width}x{height} px, {color}>")
    }
}

impl Capture {
    /// The same frame with what earlier ones told; `None` takes away what it has of that.
    pub(crate) fn with_estimates(&self, estimates: Option<objecthood::Estimates>) -> Self {
        let mut inner = Arc::clone(&self.inner);
        if inner.frame.estimates().copied() != estimates {
            let capture = Arc::make_mut(&mut inner);
            capture.frame = capture.frame.clone().with_estimates(estimates);
        }
        Self { inner, source: self.source.clone() }
    }

    fn with_up(&self, up: [f32; 3]) -> PyResult<Self> {
        let mut capture = objecthood_io::Capture::clone(&self.inner);
        capture.frame = capture.frame.with_up(up).map_err(core)?;
        Ok(Self::new(capture, self.source.clone()))
    }
}
