//! Parameters as a number that tells them apart.

use objecthood::Params;
use serde_json::Value;

/// SHA-256 of all parameters as canonical JSON (keys sorted, no spaces), in hexadecimal.
pub fn fingerprint(params: &Params) -> String {
    let value = serde_json::to_value(params).expect("parameters are numbers, switches and words");
    let mut text = String::new();
    write_canonical(&value, &mut text);
    crate::sha256(text.as_bytes())
}

/// Writes JSON with sorted keys, whatever order the map has in this build of `serde_json`.
fn write_canonical(value: &Value, text: &mut String) {
    let Value::Object(map) = value else {
        return *text += &value.to_string();
    };
    let mut entries: Vec<(&String, &Value)> = map.iter().collect();
    entries.sort_by_key(|(key, _)| *key);
    for (k, (key, value)) in entries.into_iter().enumerate() {
        *text += if k == 0 { "{" } else { "," };
        *text += &Value::from(key.as_str()).to_string();
        *text += ":";
        write_canonical(value, text);
    }
    *text += if map.is_empty() { "{}" } else { "}" };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn canonical_json_does_not_depend_on_order() {
        let text = |json: &str| {
            let mut text = String::new();
            write_canonical(&serde_json::from_str(json).unwrap(), &mut text);
            text
        };
        assert_eq!(
            text(r#"{"b": {"z": 1, "y": [1.5, "a\n"]}, "a": {}}"#),
            r#"{"a":{},"b":{"y":[1.5,"a\n"],"z":1}}"#
        );
    }

    #[test]
    fn the_fingerprint_tells_parameters_apart() {
        let default = fingerprint(&Params::default());
        assert_eq!(default.len(), 64);
        assert_eq!(default, fingerprint(&Params::default()));
        let mut other = Params::default();
        other.curvature.threshold += 0.01;
        assert_ne!(default, fingerprint(&other));
    }
}
