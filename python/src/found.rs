//! What was found in a frame, as columns.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyArray3};
use objecthood::discovery::NodeKind;
use objecthood::explain::Explainer;
use objecthood::{Discovery, Object, ObjectnessParts, Params};
use objecthood_io::explanation::ExplanationFile;
use objecthood_io::output::{coco, instances};
use objecthood_io::scene::{SceneFile, fingerprint, notices};
use objecthood_io::{label_image, output};
use objecthood_view::{overlay, png};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::json;

use crate::arrays::{image, image3, table};
use crate::capture::Capture;
use crate::errors::{InputError, core, file};
use crate::estimates::Estimates;
use crate::parameters::to_json;
use crate::run::{Stoppable, Threads};
use crate::stages::{StageImage, StageImages};

/// What was found in a frame.
#[pyclass(frozen, module = "objecthood._native")]
pub(crate) struct Found {
    pub(crate) capture: Arc<objecthood_io::Capture>,
    pub(crate) source: String,
    pub(crate) params: Arc<Params>,
    pub(crate) discovery: Discovery,
}

#[pymethods]
impl Found {
    /// The frame.
    #[getter]
    fn capture(&self) -> Capture {
        Capture { inner: Arc::clone(&self.capture), source: self.source.clone() }
    }

    /// The object of every pixel, 0 = none.
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        image(py, &self.discovery.labels)
    }

    /// The structure plane of every pixel, 0 = none.
    fn structure<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u16>>> {
        image(py, &self.discovery.structure)
    }

    /// A column of every property that is a number or a vector.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let objects = &self.discovery.objects;
        let columns = PyDict::new(py);
        let (x, y) = (|o: &Object| o.box_px.u as f32, |o: &Object| o.box_px.v as f32);
        let xyxy = |o: &Object| [x(o), y(o), x(o) + o.box_px.width as f32, y(o) + o.box_px.height as f32];
        columns.set_item("ids", column(py, objects, |o| o.id.0))?;
        columns.set_item("objectness", column(py, objects, |o| o.objectness))?;
        columns.set_item("parts", vectors(py, objects, |o| parts(o.parts))?)?;
        columns.set_item("size_px", column(py, objects, |o| o.size_px as i64))?;
        columns.set_item("xyxy", vectors(py, objects, xyxy)?)?;
        columns.set_item("centroids", vectors(py, objects, |o| o.centroid_m)?)?;
        columns.set_item("box_centers", vectors(py, objects, |o| o.box_m.center_m)?)?;
        columns.set_item("box_sizes", vectors(py, objects, |o| o.box_m.extents_m)?)?;
        columns.set_item("box_quaternions", vectors(py, objects, |o| o.box_m.rotation_xyzw)?)?;
        columns.set_item("tops", column(py, objects, |o| o.top_m.unwrap_or(f32::NAN)))?;
        columns.set_item("flat", column(py, objects, |o| o.is_flat))?;
        Ok(columns)
    }

    /// What each object stands on: numbers of objects, 0 = structure or another surface.
    fn parents(&self) -> Vec<Vec<u16>> {
        let nodes = &self.discovery.support.nodes;
        let object = |node: usize| match nodes.get(node).map(|node| node.kind) {
            Some(NodeKind::Object { object }) => object.0,
            _ => 0,
        };
        let parents = |o: &Object| o.parents.iter().map(|node| object(node.0 as usize)).collect();
        self.discovery.objects.iter().map(parents).collect()
    }

    /// The direction against gravity: a unit vector in the camera frame.
    fn up<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.discovery.up.direction)
    }

    /// What this frame and those before it tell, for the next frame; `None` for `paper`.
    fn estimates(&self) -> Option<Estimates> {
        self.discovery.estimates.map(|inner| Estimates { inner })
    }

    /// Normal and offset (m) of each structure plane.
    fn planes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let planes = self.discovery.structure_planes.iter();
        let rows: Vec<[f32; 4]> = planes
            .map(|plane| {
                let [x, y, z] = plane.normal;
                [x, y, z, plane.offset_m]
            })
            .collect();
        table(py, &rows)
    }

    /// What the user should know.
    fn notices(&self) -> Vec<String> {
        notices(&self.capture, &self.discovery)
    }

    /// The points (m) of the pixels of an object, row by row.
    fn points<'py>(&self, py: Python<'py>, id: u16) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let frame = &self.capture.frame;
        let (camera, (width, _)) = (frame.camera(), frame.size());
        let pixels = self
            .discovery
            .labels
            .as_slice()
            .iter()
            .enumerate()
            .filter(|&(i, &label)| label == id && frame.is_valid(i));
        let points = pixels.map(|(i, _)| camera.back_project(i % width, i / width, frame.depth_m()[i]));
        table(py, &points.collect::<Vec<_>>())
    }

    /// The images of the stages, by their names.
    fn stages<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut images = StageImages::default();
        py.detach(|| {
            Threads::new(None)?.run(|stop| {
                let mut observer = Stoppable { stop, next: &mut images };
                objecthood::discover_observed(&self.capture.frame, &self.params, &mut observer).map(drop)
            })
        })?
        .map_err(core)?;
        let stages = PyDict::new(py);
        for (name, stage) in images.0 {
            match stage {
                StageImage::Labels(labels) => stages.set_item(name, image(py, &labels)?)?,
                StageImage::Numbers(numbers) => stages.set_item(name, image(py, &numbers)?)?,
                StageImage::Vectors(vectors) => stages.set_item(name, image3(py, &vectors)?)?,
            }
        }
        Ok(stages)
    }

    /// Why a pixel is what it is, as JSON.
    fn explain(&self, py: Python<'_>, column: usize, row: usize) -> PyResult<String> {
        let explained = py.detach(|| {
            Threads::new(None)?.run(|_| {
                let pipeline = objecthood::Pipeline::default();
                Explainer::new(&pipeline, &self.capture.frame, &self.params)?.explain([column, row])
            })
        })?;
        let explanation = explained.map_err(core)?;
        ExplanationFile::new(&self.source, &self.params, &explanation).to_json().map_err(file)
    }

    /// The scene file.
    fn scene(&self) -> PyResult<String> {
        SceneFile::new(&self.source, &self.capture, &self.params, &self.discovery).to_json().map_err(file)
    }

    /// The image and its annotations as COCO has them, in JSON.
    fn coco(&self, image_id: usize, first_id: usize) -> String {
        let frame = &self.capture.frame;
        let found = instances::of_discovery(frame, &self.discovery);
        let annotations = found.iter().enumerate();
        let annotations: Vec<_> = annotations
            .map(|(row, thing)| coco::annotation(first_id.saturating_add(row), image_id, thing))
            .collect();
        let image = coco::image(image_id, &self.source, frame.size());
        json!({"image": image, "annotations": annotations, "categories": [coco::category()]}).to_string()
    }

    /// The label image as a 16-bit PNG.
    fn label_png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| label_image::encode(&self.discovery.labels)).map_err(file)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The image with what was found drawn over it, as a PNG.
    fn overlay_png<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| png(&overlay(&self.capture.frame, &self.discovery.labels)));
        let bytes = bytes.map_err(|e| InputError::new_err(format!("the picture has no PNG form ({e})")))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The image with what was found drawn over it, H x W x 3.
    fn overlay<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let picture = py.detach(|| overlay(&self.capture.frame, &self.discovery.labels));
        let (width, height) = self.discovery.labels.size();
        let (pixels, _) = picture.as_raw().as_chunks::<3>();
        image3(py, &objecthood::Raster::from_vec(width, height, pixels.to_vec()).map_err(core)?)
    }

    /// The parameters, in JSON.
    fn params(&self) -> PyResult<String> {
        to_json(&self.params)
    }

    /// SHA-256 of all parameters, in hexadecimal.
    fn fingerprint(&self) -> String {
        fingerprint(&self.params)
    }
}

/// Writes files that belong together: none takes its name before all are written whole.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
pub(crate) fn write_together(py: Python<'_>, files: Vec<(PathBuf, Vec<u8>)>) -> PyResult<()> {
    py.detach(|| output::write_together(&files)).map_err(file)
}

/// The parts of an objectness, in the order of `PARTS` in `objecthood/discovery.py`.
fn parts(parts: ObjectnessParts) -> [f32; 6] {
    let ObjectnessParts { size, support, footing, compactness, separation, visibility } = parts;
    [size, support, footing, compactness, separation, visibility]
}

fn column<'py, T: numpy::Element>(
    py: Python<'py>,
    objects: &[Object],
    value: impl Fn(&Object) -> T,
) -> Bound<'py, PyArray1<T>> {
    PyArray1::from_iter(py, objects.iter().map(value))
}

fn vectors<'py, T: numpy::Element + Copy, const N: usize>(
    py: Python<'py>,
    objects: &[Object],
    value: impl Fn(&Object) -> [T; N],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    table(py, &objects.iter().map(value).collect::<Vec<_>>())
}
