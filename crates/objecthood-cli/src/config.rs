//! Defaults, then `--config FILE`, then every `--set`, then `--method` and `--all` -> [`Params`].

use std::path::Path;

use anyhow::Result;
use clap::ValueEnum;
use objecthood::{Method, ParameterInfo, Params};
use toml::{Table, Value};

use crate::args::{MethodName, Settings};
use crate::failure::usage;

/// The parameters in force.
///
/// # Errors
/// Of usage: a file that cannot be read, a parameter that does not exist, a value that it does not take, a method that
/// is not there.
pub(crate) fn params(settings: &Settings, method: Option<MethodName>) -> Result<Params> {
    let mut given = Given { known: Params::table(), method: None, groups: Table::new() };
    if let Some(path) = &settings.config {
        given.read_file(path).map_err(|why| usage(format!("{}: {why}", path.display())))?;
    }
    for assignment in &settings.set {
        given.assign(assignment).map_err(|why| usage(format!("--set {assignment}: {why}")))?;
    }
    let mut params: Params = given.groups.try_into().map_err(|e| usage(e.to_string()))?;
    params.method = match method.or(given.method) {
        None => Method::default(),
        Some(MethodName::Paper) => Method::Paper,
        Some(MethodName::Context) => Method::Context,
    };
    params.objectness.every_hypothesis |= settings.all;
    params.validate().map_err(|e| usage(e.to_string()))?;
    Ok(params)
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

    /// Takes in `stage.parameter=value`.
    fn assign(&mut self, assignment: &str) -> Result<(), Complaint> {
        let (key, text) = assignment
            .split_once('=')
            .ok_or("there is no value: write stage.parameter=value, as in curvature.threshold=0.2")?;
        let (key, text) = (key.trim(), text.trim());
        if key == "method" {
            return Err("a method is chosen with --method".to_owned());
        }
        let (group, name) = key.split_once('.').ok_or_else(|| self.no_such_parameter(key))?;
        // A word that is no TOML value, as `depth`, is meant as a string.
        let value = text.parse().unwrap_or_else(|_| Value::String(text.to_owned()));
        self.set(group, name, value)
    }

    fn set(&mut self, group: &str, name: &str, value: Value) -> Result<(), Complaint> {
        let key = format!("{group}.{name}");
        let info = self.known.iter().find(|p| p.name == key).ok_or_else(|| self.no_such_parameter(&key))?;

        // One value at a time, so that whatever is wrong is wrong with this one.
        let alone = Table::from_iter([(
            group.to_owned(),
            Table::from_iter([(name.to_owned(), value.clone())]).into(),
        )]);
        let params: Params = alone.try_into().map_err(|e: toml::de::Error| {
            format!("{key} = {value} does not fit: {}: it takes {}", e.message(), info.range)
        })?;
        params.validate().map_err(|e| e.to_string())?;

        let group = self.groups.entry(group).or_insert_with(|| Table::new().into());
        if let Some(group) = group.as_table_mut() {
            group.insert(name.to_owned(), value);
        }
        Ok(())
    }

    /// Names what may have been meant, if anything is like it.
    fn no_such_parameter(&self, key: &str) -> Complaint {
        const LIKE: f64 = 0.4;
        let given = key.to_lowercase();
        let names = self.known.iter().map(|p| p.name.as_str());
        // A name without its group is compared with names without their groups.
        let part =
            |name: &'_ str| if given.contains('.') { name.to_owned() } else { after_dot(name).to_owned() };
        let mut likely: Vec<(f64, &str)> =
            names.map(|name| (strsim::normalized_damerau_levenshtein(&part(name), &given), name)).collect();
        likely.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = likely.first().map_or(0.0, |l| l.0);
        if best < LIKE {
            return format!("there is no parameter `{key}`: `objecthood params` lists all");
        }
        let near: Vec<&str> = likely.iter().take_while(|l| l.0 >= best - 0.05).take(3).map(|l| l.1).collect();
        format!(
            "there is no parameter `{key}`: did you mean {}? `objecthood params` lists all",
            in_ticks(&near)
        )
    }
}

fn after_dot(name: &str) -> &str {
    name.split_once('.').map_or(name, |(_, name)| name)
}

fn in_ticks(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" or ")
}

/// A mistake in the file's syntax, with the line it is on.
fn not_toml(error: &toml::de::Error, text: &str) -> Complaint {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    format!("line {line} is not TOML: {}", error.message())
}
