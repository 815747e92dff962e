//! Parameters as JSON, TOML and a table. `objecthood/params.py` is made from the table.

use objecthood::params::{Profile, Sensor};
use objecthood::{ParameterInfo, Params};
use pyo3::prelude::*;

use crate::errors::{ParameterError, core};

/// The parameters in a JSON text, checked.
///
/// # Errors
/// `ParameterError`: a name that does not exist, a value of another type or outside its range.
pub(crate) fn parse(json: &str) -> PyResult<Params> {
    let params: Params = serde_json::from_str(json).map_err(|e| ParameterError::new_err(e.to_string()))?;
    params.validate().map_err(core)?;
    Ok(params)
}

/// The parameters as JSON text.
pub(crate) fn to_json(params: &Params) -> PyResult<String> {
    serde_json::to_string(params).map_err(|e| ParameterError::new_err(e.to_string()))
}

/// Every parameter with name, default, range, unit, meaning, source and readers, as JSON, in the order in which the method uses them.
#[pyfunction]
pub(crate) fn parameter_table() -> PyResult<String> {
    let table: Vec<ParameterInfo> = Params::table();
    serde_json::to_string(&table).map_err(|e| ParameterError::new_err(e.to_string()))
}

/// JSON of parameters in TOML; what is not named keeps its default.
#[pyfunction]
pub(crate) fn params_from_toml(text: &str) -> PyResult<String> {
    let params: Params = toml::from_str(text).map_err(|e| ParameterError::new_err(e.to_string()))?;
    params.validate().map_err(core)?;
    to_json(&params)
}

/// TOML of parameters in JSON.
#[pyfunction]
pub(crate) fn params_to_toml(json: &str) -> PyResult<String> {
    toml::to_string(&parse(json)?).map_err(|e| ParameterError::new_err(e.to_string()))
}

/// JSON of parameters with the figures of a kind of sensor. A lateral noise that is not the default stays.
#[pyfunction]
pub(crate) fn params_with_profile(json: &str, profile: &str) -> PyResult<String> {
    let mut params = parse(json)?;
    let kind: Profile = serde_json::from_value(profile.into()).map_err(|_| {
        ParameterError::new_err(format!(
            "there is no profile `{profile}`: use kinect, stereo, tof, phone or none"
        ))
    })?;
    let is_given = params.sensor.lateral_noise_px != Sensor::default().lateral_noise_px;
    let of_kind = Sensor::of(kind);
    params.sensor.profile = kind;
    if !is_given {
        params.sensor.lateral_noise_px = of_kind.lateral_noise_px;
    }
    to_json(&params)
}
