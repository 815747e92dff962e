//! Values -> JSON, in which every number is finite.

use serde::Serialize;
use serde_json::Value;

use crate::error::{Error, Result};

/// JSON for people to read, which ends with a line end.
///
/// # Errors
/// As [`line`].
pub(crate) fn pretty(value: &impl Serialize) -> Result<String> {
    refuse_null(value)?;
    Ok(serde_json::to_string_pretty(value).map_err(no_json)? + "\n")
}

/// JSON on one line, which ends with a line end.
///
/// # Errors
/// [`Error::NotFinite`] names the place of a value that JSON cannot hold, [`Error::NoJson`] tells of a kind of value that it does
/// not know.
pub(crate) fn line(value: &impl Serialize) -> Result<String> {
    refuse_null(value)?;
    Ok(serde_json::to_string(value).map_err(no_json)? + "\n")
}

fn refuse_null(value: &impl Serialize) -> Result<()> {
    match first_null(&serde_json::to_value(value).map_err(no_json)?) {
        Some(place) => Err(Error::NotFinite { place }),
        None => Ok(()),
    }
}

fn no_json(reason: serde_json::Error) -> Error {
    Error::NoJson { reason }
}

/// Where the first null stands. A number that is not finite becomes one, and nothing else does.
fn first_null(value: &Value) -> Option<String> {
    let inside = |place: String, value: &Value| first_null(value).map(|rest| place + &rest);
    match value {
        Value::Null => Some(String::new()),
        Value::Array(values) => {
            values.iter().enumerate().find_map(|(k, value)| inside(format!("[{k}]"), value))
        }
        Value::Object(map) => map.iter().find_map(|(key, value)| inside(format!(".{key}"), value)),
        Value::Bool(_) | Value::Number(_) | Value::String(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_null_is_named() {
        let value = serde_json::json!({"a": [1, {"b": [0, null]}]});
        assert_eq!(first_null(&value).unwrap(), ".a[1].b[1]");
        assert_eq!(first_null(&serde_json::json!({"a": []})), None);
    }
}
