//! The parameters as the page says them: the method, and what differs from the defaults.

use std::collections::BTreeMap;

use objecthood::params::Sensor;
use objecthood::{Method, Params};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::error::{Error, Result};

/// A method, and the parameters that were changed, by the name `group.parameter`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// The method.
    pub method: Method,
    /// The changed parameters.
    pub set: BTreeMap<String, Value>,
}

impl Settings {
    /// What of `params` differs from the defaults.
    ///
    /// # Errors
    /// [`Error::Json`].
    pub fn of(params: &Params) -> Result<Self> {
        let (now, defaults) = (values(params)?, values(&Params::default())?);
        let changed = now.into_iter().filter(|(name, value)| defaults.get(name) != Some(value));
        Ok(Self { method: params.method, set: changed.collect() })
    }

    /// The parameters. As on the command line, the kind of the sensor sets its sideways noise too, unless that is set itself.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first parameter that is wrong.
    pub fn params(&self) -> Result<Params> {
        let mut groups = Map::new();
        for (name, value) in &self.set {
            let wrong = |why: String| Error::Parameter { name: name.clone(), why };
            let (group, parameter) =
                name.split_once('.').ok_or_else(|| wrong("there is no such parameter".to_owned()))?;
            // One value at a time, so that whatever is wrong is wrong with this one.
            let alone = Map::from_iter([(parameter.to_owned(), value.clone())]);
            let params: Params = parsed(Map::from_iter([(group.to_owned(), alone.clone().into())]))
                .map_err(|e| wrong(e.to_string()))?;
            params.validate().map_err(|e| wrong(e.to_string()))?;
            let group = groups.entry(group).or_insert_with(|| Map::new().into());
            if let Some(group) = group.as_object_mut() {
                group.extend(alone);
            }
        }
        let mut params: Params = parsed(groups)?;
        params.method = self.method;
        if !self.set.contains_key("sensor.lateral_noise_px") {
            params.sensor.lateral_noise_px = Sensor::of(params.sensor.profile).lateral_noise_px;
        }
        params.validate()?;
        Ok(params)
    }
}

/// By way of text, where 0.14 is the same number at any width.
fn parsed(groups: Map<String, Value>) -> serde_json::Result<Params> {
    serde_json::from_str(&Value::from(groups).to_string())
}

/// Every parameter by its name, as it is written: a 32-bit 0.14 is 0.14.
///
/// # Errors
/// [`Error::Json`].
pub(crate) fn values(params: &Params) -> Result<BTreeMap<String, Value>> {
    let groups: BTreeMap<String, Value> = serde_json::from_str(&serde_json::to_string(params)?)?;
    let named = groups.into_iter().flat_map(|(group, values)| match values {
        Value::Object(values) => {
            values.into_iter().map(|(name, value)| (format!("{group}.{name}"), value)).collect()
        }
        _ => Vec::new(),
    });
    Ok(named.collect())
}

#[cfg(test)]
mod tests {
    use objecthood::params::Profile;
    use serde_json::json;

    use super::*;

    fn settings(set: &Value) -> Settings {
        serde_json::from_value(json!({ "method": "context", "set": set })).unwrap()
    }

    #[test]
    fn settings_and_parameters_are_two_forms_of_one_thing() {
        let mut params = Params::default();
        assert_eq!(Settings::of(&params).unwrap(), Settings::default());
        params.curvature.threshold = 0.15;
        params.objectness.threshold = 0.25;
        params.method = Method::Paper;
        let settings = Settings::of(&params).unwrap();
        assert_eq!(settings.set.len(), 2);
        assert_eq!(settings.set["curvature.threshold"], json!(0.15));
        assert_eq!(settings.params().unwrap(), params);
    }

    #[test]
    fn the_kind_of_sensor_sets_its_noise_unless_that_is_set() {
        let follows = settings(&json!({ "sensor.profile": "tof" })).params().unwrap();
        assert_eq!(follows.sensor, Sensor::of(Profile::Tof));
        let set =
            settings(&json!({ "sensor.profile": "tof", "sensor.lateral_noise_px": 0.5 })).params().unwrap();
        assert_eq!(set.sensor.lateral_noise_px, 0.5);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (set, said) in [
            (json!({ "objectness.threshold": 7 }), "objectness.threshold"),
            (json!({ "objectness.nothing": 1 }), "nothing"),
            (json!({ "nowhere": 1 }), "no such parameter"),
            (json!({ "sensor.profile": "eye" }), "eye"),
            (json!({ "merging.min_facet_px": "x" }), "merging.min_facet_px"),
        ] {
            let error = settings(&set).params().unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
