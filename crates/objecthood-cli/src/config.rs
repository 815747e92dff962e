//! Defaults, then `--config FILE`, then every `--set`, then `--method`, `--profile` and `--all` -> [`Params`].

mod likely;

use std::path::Path;

use anyhow::Result;
use clap::ValueEnum;
use objecthood::params::Sensor;
use objecthood::{Method, ParameterInfo, Params};
use toml::{Table, Value};

use crate::args::{MethodName, Parameters};
use crate::failure::usage;
use crate::terminal;
use likely::no_such_parameter;

/// The parameters in force, for a command that runs the method. Says on stderr which of those that were changed the method
/// does not read.
///
/// # Errors
/// As [`values`].
pub(crate) fn params(parameters: &Parameters, method: Option<MethodName>) -> Result<Params> {
    let params = values(parameters, method)?;
    if let Some(note) = unread(&params)? {
        terminal::note(&note);
    }
    Ok(params)
}

/// The parameters in force.
///
/// # Errors
/// Of usage: a file that cannot be read, a parameter, value or method that does not exist.
pub(crate) fn values(parameters: &Parameters, method: Option<MethodName>) -> Result<Params> {
    let mut given = Given { known: Params::table(), method: None, groups: Table::new() };
    if let Some(path) = &parameters.config {
        given.read_file(path).map_err(|why| usage(format!("{}: {why}", path.display())))?;
    }
    for assignment in &parameters.set {
        given.assign(assignment).map_err(|why| usage(format!("--set {assignment}: {why}")))?;
    }
    let is_lateral_given = given.has("sensor", "lateral_noise_px");
    let mut params: Params = given.groups.try_into().map_err(|e| usage(e.to_string()))?;
    params.method = match method.or(given.method) {
        None => Method::default(),
        Some(MethodName::Paper) => Method::Paper,
        Some(MethodName::Context) => Method::Context,
    };
    if let Some(profile) = parameters.profile {
        params.sensor.profile = profile.into();
    }
    if !is_lateral_given {
        params.sensor.lateral_noise_px = Sensor::of(params.sensor.profile).lateral_noise_px;
    }
    params.objectness.every_hypothesis |= parameters.all;
    params.validate().map_err(|e| usage(e.to_string()))?;
    Ok(params)
}

/// A note for a user who changed parameters that the method does not read.
fn unread(params: &Params) -> Result<Option<String>> {
    let rows = crate::params::rows(params)?;
    let unread = rows.iter().filter(|row| row.is_changed() && row.info.first_stage(params.method).is_none());
    let unread: Vec<&str> = unread.map(|row| row.info.name.as_str()).collect();
    let other = match params.method {
        Method::Paper => Method::Context,
        Method::Context => Method::Paper,
    };
    let (names, method) = (unread.join(", "), params.method);
    let (has, them) = if unread.len() == 1 { ("has", "it") } else { ("have", "them") };
    Ok((!unread.is_empty()).then(|| {
        format!(
            "{names} {has} no effect on the method {method}: only {other} reads {them} (--method {other})"
        )
    }))
}

/// What the user has set so far.
struct Given {
    known: Vec<ParameterInfo>,
    method: Option<MethodName>,
    groups: Table,
}

/// Why something cannot be set, and what to do.
type Complaint = String;

impl Given {
    fn read_file(&mut self, path: &Path) -> Result<(), Complaint> {
        let text = std::fs::read_to_string(path).map_err(|e| {
            format!("{e}: give --config a file like the one `objecthood params --toml` prints")
        })?;
        let table: Table = text.parse().map_err(|e| not_toml(&e, &text))?;
        for (key, value) in table {
            match value {
                Value::String(name) if key == "method" => {
                    let method = MethodName::from_str(&name, false);
                    self.method = Some(
                        method
                            .map_err(|_| format!("there is no method `{name}`: use `paper` or `context`"))?,
                    );
                }
                Value::Table(group) => {
                    for (name, value) in group {
                        self.set(&key, &name, value)?;
                    }
                }
                _ => {
                    return Err(format!(
                        "`{key}` is not a group of parameters: write [group] and below it name = value"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Whether the parameter was set.
    fn has(&self, group: &str, name: &str) -> bool {
        self.groups.get(group).and_then(Value::as_table).is_some_and(|group| group.contains_key(name))
    }

    /// Takes in `group.parameter=value`.
    fn assign(&mut self, assignment: &str) -> Result<(), Complaint> {
        let (key, text) = assignment
            .split_once('=')
            .ok_or("there is no value: write group.parameter=value, as in objectness.threshold=0.6")?;
        let (key, text) = (key.trim(), text.trim());
        if key == "method" {
            return Err("a method is chosen with --method".to_owned());
        }
        let (group, name) = key.split_once('.').ok_or_else(|| no_such_parameter(&self.known, key))?;
        // A word that is no TOML value, as `depth`, is meant as a string.
        let value = text.parse().unwrap_or_else(|_| Value::String(text.to_owned()));
        self.set(group, name, value)
    }

    fn set(&mut self, group: &str, name: &str, value: Value) -> Result<(), Complaint> {
        let key = format!("{group}.{name}");
        let info =
            self.known.iter().find(|p| p.name == key).ok_or_else(|| no_such_parameter(&self.known, &key))?;

        // One value at a time, so that whatever is wrong is wrong with this one.
        let alone = Table::from_iter([(
            group.to_owned(),
            Table::from_iter([(name.to_owned(), value.clone())]).into(),
        )]);
        let params: Params = alone
            .try_into()
            .map_err(|_| format!("{key} = {value} does not fit: it takes {}", expected(info)))?;
        params.validate().map_err(|e| e.to_string())?;

        let group = self.groups.entry(group).or_insert_with(|| Table::new().into());
        if let Some(group) = group.as_table_mut() {
            group.insert(name.to_owned(), value);
        }
        Ok(())
    }
}

/// The values that a parameter takes, in words.
fn expected(info: &ParameterInfo) -> String {
    let Some((least, _)) = info.limits() else { return format!("one of {}", info.range) };
    let takes = |number: f64| Params::default().with_number(&info.name, number).is_some();
    let is_whole = takes(least + 1.0) && !takes(least + 0.5);
    format!("a {}number in {}", if is_whole { "whole " } else { "" }, info.range)
}

/// A mistake in the file's syntax, with the line it is on.
fn not_toml(error: &toml::de::Error, text: &str) -> Complaint {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    format!("line {line} is not TOML: {}", error.message())
}
