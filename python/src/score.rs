//! How well labels agree with a truth, and synthetic scenes that have one.

use numpy::PyReadonlyArray2;
use objecthood::Raster;
use objecthood_eval::{Roles, Truth, mosd};
use objecthood_scene::{export, generate, render};
use pyo3::prelude::*;
use serde_json::json;

use crate::arrays::raster;
use crate::capture::Capture;
use crate::errors::InputError;

/// The figures of a label image against a truth, as JSON; `ignore` and `background` are labels of the truth that are no objects.
#[pyfunction]
#[pyo3(signature = (labels, truth, ignore, background))]
#[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
pub(crate) fn score(
    labels: PyReadonlyArray2<'_, u16>,
    truth: PyReadonlyArray2<'_, u32>,
    ignore: Option<u32>,
    background: Option<u32>,
) -> PyResult<String> {
    let truth = raster(&truth, <[u32]>::to_vec)?;
    let truth = Truth::new(truth.clone(), truth, Roles { ignore, background }).map_err(wrong)?;
    scored(&raster(&labels, <[u16]>::to_vec)?, &truth)
}

/// As `score`, for a truth with the labels of mOSD, as synthetic scenes have them too: 0 = unknown, 1 to 9 = the table, tens = an object, with its parts.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "what PyO3 hands over")]
pub(crate) fn score_mosd(
    labels: PyReadonlyArray2<'_, u16>,
    truth: PyReadonlyArray2<'_, u32>,
) -> PyResult<String> {
    let truth = mosd::truth_of(&raster(&truth, <[u32]>::to_vec)?).map_err(wrong)?;
    scored(&raster(&labels, <[u16]>::to_vec)?, &truth)
}

fn scored(labels: &Raster<u16>, truth: &Truth) -> PyResult<String> {
    let score = objecthood_eval::score(labels, truth).map_err(wrong)?;
    let figures = json!({
        "metrics": score.metrics,
        "objects": score.objects,
        "hypotheses": score.hypotheses,
        "hypotheses_off_objects": score.hypotheses_off_objects,
    });
    Ok(figures.to_string())
}

/// A synthetic scene, with its truth in the labels of mOSD.
#[pyfunction]
pub(crate) fn synthetic(py: Python<'_>, family: &str, seed: u64, sensor: &str) -> PyResult<Capture> {
    let family = family.parse().map_err(wrong)?;
    let sensor = sensor.parse().map_err(wrong)?;
    py.detach(|| {
        let world = generate(family, seed);
        let rendered = render(&world, sensor).map_err(wrong)?;
        let mut capture = objecthood_io::Capture::new(rendered.frame.clone());
        capture.truth = Some(export::mosd_labels(&world, &rendered, false));
        capture.name = format!("{family}{seed}").into();
        Ok(Capture::new(capture, String::new()))
    })
}

fn wrong(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}
