//! `objecthood params`: every parameter, for people, for programs, or as a file to start from.

use std::fmt::Write;

use anyhow::{Context, Result};
use objecthood::{ParameterInfo, Params, Reader};
use serde::Serialize;
use serde_json::Value;

use crate::args::ParamsArgs;
use crate::failure::Outcome;
use crate::{config, terminal};

/// A parameter and its value in force.
#[derive(Serialize)]
pub(crate) struct Row {
    #[serde(flatten)]
    pub(crate) info: ParameterInfo,
    value: Value,
}

impl Row {
    /// Whether the value is not the default.
    pub(crate) fn is_changed(&self) -> bool {
        !same(&plain(&self.value), &self.info.default)
    }
}

/// Prints the parameters.
///
/// # Errors
/// Of usage, when the settings are wrong; when stdout cannot be written.
pub(crate) fn run(args: &ParamsArgs) -> Result<Outcome> {
    let params = config::values(&args.settings.parameters, None)?;
    let rows = rows(&params)?;
    let text = if args.json {
        let table = serde_json::json!({ "method": params.method, "parameters": rows });
        format!("{table:#}\n")
    } else if args.toml {
        as_toml(&params, &rows)
    } else {
        as_table(&rows)
    };
    terminal::print(&text)?;
    Ok(Outcome::AllDone)
}

/// Every parameter with its value, in the order of the table.
///
/// # Errors
/// When the parameters have no JSON form.
pub(crate) fn rows(params: &Params) -> Result<Vec<Row>> {
    // By way of text, where a 32-bit 0.14 is written 0.14; as a number it would become 0.14000000059604645.
    let text = serde_json::to_string(params).context("the parameters cannot be written as JSON")?;
    let values: Value = serde_json::from_str(&text).context("the parameters cannot be read as JSON")?;
    let row = |info: ParameterInfo| {
        let value = values.pointer(&format!("/{}", info.name.replace('.', "/"))).cloned().unwrap_or_default();
        Row { info, value }
    };
    Ok(Params::table().into_iter().map(row).collect())
}

fn as_table(rows: &[Row]) -> String {
    let mut text = String::new();
    let width = rows.iter().map(|row| row.info.name.len()).max().unwrap_or(0);
    for row in rows {
        let ParameterInfo { name, default, range, unit, meaning, source, readers, .. } = &row.info;
        let value = plain(&row.value);
        let _ = write!(text, "{name:width$}  {value:>8}  {range} [{unit}]");
        if row.is_changed() {
            let _ = write!(text, "  (default {default})");
        }
        let _ = writeln!(text, "\n    {meaning} [{source}; read by {}]", listed(readers));
    }
    text
}

fn as_toml(params: &Params, rows: &[Row]) -> String {
    let mut text = format!("method = \"{}\"\n", params.method);
    let mut group = "";
    for Row { info, value } in rows {
        let ParameterInfo { name, default, range, unit, meaning, source, readers, .. } = info;
        let (its_group, name) = name.split_once('.').unwrap_or(("", name));
        if its_group != group {
            group = its_group;
            let _ = writeln!(text, "\n[{group}]");
        }
        let _ = writeln!(text, "# {meaning}\n# {range} [{unit}]; default {default}: {source}");
        let _ = writeln!(text, "# read by {}", listed(readers));
        // A JSON scalar is a TOML scalar.
        let _ = writeln!(text, "{name} = {value}");
    }
    text
}

fn listed(readers: &[Reader]) -> String {
    let named = |reader: &Reader| format!("{} (first by its stage {})", reader.method, reader.first_stage);
    readers.iter().map(named).collect::<Vec<_>>().join(" and ")
}

/// A value without quotes.
fn plain(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), |x| x.to_string()),
        other => other.to_string(),
    }
}

/// Whether two values are the same, however they are written: 100 and 100.0.
fn same(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}
