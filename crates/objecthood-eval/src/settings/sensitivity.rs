//! How much depends on each number: every parameter that the method reads, changed alone.

use objecthood::{ParameterInfo, Params};
use serde_json::Value;

use super::Setting;
use crate::error::Result;

/// Name of the setting in which nothing is changed.
const UNCHANGED: &str = "(nothing changed)";
/// What numbers are multiplied by.
const FACTORS: [f64; 2] = [0.7, 1.3];

/// `params` as they are, then every number that their method reads at 0.7 and 1.3 of its value, whole numbers rounded, and
/// every choice at its other values. A value beyond what is allowed becomes the limit. The name of a setting says what
/// is set: `border.gap_quanta = 2.8`. What this does not change (0, or 1 rounded to 1) has no setting.
///
/// # Errors
/// [`Error::Params`](crate::Error::Params) when a parameter of the table is not among the values, which a test rules out.
pub fn sensitivity(params: &Params) -> Result<Vec<Setting>> {
    let values = serde_json::to_value(params)?;
    let mut settings = vec![Setting { name: UNCHANGED.to_owned(), params: params.clone() }];
    for info in Params::table().iter().filter(|info| info.first_stage(params.method).is_some()) {
        let pointer = format!("/{}", info.name.replace('.', "/"));
        let value = values.pointer(&pointer).unwrap_or(&Value::Null);
        for other in others(info, value) {
            let mut values = values.clone();
            if let Some(place) = values.pointer_mut(&pointer) {
                *place = other.clone();
            }
            let word = other.as_str().map_or_else(|| other.to_string(), str::to_owned);
            let name = format!("{} = {word}", info.name);
            settings.push(Setting { name, params: serde_json::from_value(values)? });
        }
    }
    Ok(settings)
}

/// Whether a setting of [`sensitivity`] changes a choice, not a number: its name says which parameter it is.
pub fn changes_choice(setting: &str) -> bool {
    let parameter = setting.split(" = ").next();
    Params::table().iter().any(|info| Some(info.name.as_str()) == parameter && info.limits().is_none())
}

/// The values to try in place of one.
fn others(info: &ParameterInfo, value: &Value) -> Vec<Value> {
    let mut others: Vec<Value> = match (info.limits(), value.as_f64()) {
        (Some(limits), Some(number)) => {
            FACTORS.iter().map(|factor| scaled(number, *factor, limits, !value.is_f64())).collect()
        }
        _ => info
            .choices()
            .into_iter()
            .map(|word| word.parse::<bool>().map_or(word.into(), Value::Bool))
            .collect(),
    };
    others.retain(|other| other != value);
    others
}

fn scaled(number: f64, factor: f64, (least, greatest): (f64, f64), is_whole: bool) -> Value {
    let scaled = (number * factor).clamp(least, greatest);
    if is_whole { Value::from(scaled.round() as u64) } else { Value::from(in_four_digits(scaled)) }
}

/// Rounded to four digits, so that the name of a setting says exactly what it is.
fn in_four_digits(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use objecthood::Method;

    use super::*;

    fn names(params: &Params) -> Vec<String> {
        sensitivity(params).unwrap().into_iter().map(|setting| setting.name).collect()
    }

    #[test]
    fn every_parameter_of_the_method_is_changed_and_no_other() {
        for method in [Method::Paper, Method::Context] {
            let params = Params { method, ..Params::default() };
            let names = names(&params);
            for info in Params::table() {
                let settings =
                    names.iter().filter(|name| name.split(" = ").next() == Some(&info.name)).count();
                let expected = match info.choices().len() {
                    _ if info.first_stage(method).is_none() => 0,
                    // 30 % of nothing is nothing, and beyond a limit there is nothing.
                    0 => {
                        let (least, greatest) = info.limits().unwrap();
                        let value: f64 = info.default.parse().unwrap();
                        let scaled = FACTORS.map(|factor| (factor * value).clamp(least, greatest));
                        scaled.into_iter().filter(|scaled| *scaled != value).count()
                    }
                    choices => choices - 1,
                };
                assert_eq!(settings, expected, "{method} {}", info.name);
                assert_eq!(changes_choice(&format!("{} = 1", info.name)), !info.choices().is_empty());
            }
        }
    }

    #[test]
    fn a_setting_is_what_its_name_says() {
        let params = Params { method: Method::Context, ..Params::default() };
        for setting in sensitivity(&params).unwrap().into_iter().skip(1) {
            setting.params.validate().unwrap();
            let (group, value) = setting.name.split_once('.').unwrap();
            let (name, value) = value.split_once(" = ").unwrap();
            let (was, is) =
                (serde_json::to_value(&params).unwrap(), serde_json::to_string(&setting.params).unwrap());
            let mut is: Value = serde_json::from_str(&is).unwrap();
            assert_eq!(is[group][name].to_string().trim_matches('"'), value);
            is[group][name] = was[group][name].clone();
            assert_eq!(serde_json::from_value::<Params>(is).unwrap(), params, "nothing else is changed");
        }
    }

    #[test]
    fn values_are_rounded_and_kept_within_their_limits() {
        let mut params = Params { method: Method::Paper, ..Params::default() };
        params.objectness.min_p_o = 0.9;
        params.smoothing.sigma_px = 0.0;
        params.curvature.offset_px = 1;
        let names = names(&params);
        let of = |name: &str| -> Vec<&String> { names.iter().filter(|n| n.starts_with(name)).collect() };
        assert_eq!(of("objectness.min_p_o"), ["objectness.min_p_o = 0.63", "objectness.min_p_o = 1.0"]);
        assert!(of("smoothing.sigma_px").is_empty() && of("curvature.offset_px").is_empty());
        assert_eq!(of("graph.channels"), ["graph.channels = color", "graph.channels = depth"]);
        assert_eq!(of("graph.min_size_px"), ["graph.min_size_px = 70", "graph.min_size_px = 130"]);
        assert_eq!(
            of("sensor.disparity"),
            ["sensor.disparity_quantum_per_m = 0.001995", "sensor.disparity_quantum_per_m = 0.003705"]
        );
    }

    /// What the table does not say a method reads may be anything: all of it changed at once changes nothing.
    #[test]
    fn what_a_method_does_not_read_does_not_matter() {
        use objecthood_scene::{Family, Sensor, generate, render};
        let frame = render(&generate(Family::Vessels, 1), Sensor::Kinect).unwrap().frame;
        for method in [Method::Paper, Method::Context] {
            let params = Params { method, ..Params::default() };
            let mut values = serde_json::to_value(&params).unwrap();
            for info in Params::table().iter().filter(|info| info.first_stage(method).is_none()) {
                let place = values.pointer_mut(&format!("/{}", info.name.replace('.', "/"))).unwrap();
                *place = others(info, place).remove(0);
            }
            let changed: Params = serde_json::from_value(values).unwrap();
            assert_ne!(changed, params);
            let [a, b] = [&params, &changed].map(|params| objecthood::discover(&frame, params).unwrap());
            assert_eq!(a.labels, b.labels, "{method}");
            assert_eq!(a.structure, b.structure, "{method}");
            assert_eq!(
                format!("{:?}", (a.objects, a.support)),
                format!("{:?}", (b.objects, b.support)),
                "{method}"
            );
        }
    }
}
