//! The lines of the table of parameters.

use serde::Serialize;

use crate::params::allowed::{OR, TO};
use crate::params::choices::Method;
use crate::stage::Stage;

/// One line of the table of parameters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ParameterInfo {
    /// `group.name`, as in a configuration file and in `--set`.
    pub name: String,
    /// The default value.
    pub default: String,
    /// The values allowed.
    pub range: String,
    /// The unit, or "dimensionless: meaning".
    pub unit: &'static str,
    /// Its meaning.
    pub meaning: String,
    /// The source of the default.
    pub source: &'static str,
    /// The methods that read it, each with the first stage that does.
    pub readers: &'static [Reader],
}

/// A method that reads a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Reader {
    /// The method.
    pub method: Method,
    /// Its first stage that reads the parameter: no earlier stage depends on the value.
    pub first_stage: Stage,
}

impl ParameterInfo {
    /// The first stage of a method that reads it; `None` when the method does not.
    pub fn first_stage(&self, method: Method) -> Option<Stage> {
        self.readers.iter().find(|reader| reader.method == method).map(|reader| reader.first_stage)
    }

    /// The least and the greatest allowed value of a number; `None` for a choice.
    pub fn limits(&self) -> Option<(f64, f64)> {
        let (least, greatest) = self.range.split_once(TO)?;
        Some((least.parse().ok()?, greatest.parse().ok()?))
    }

    /// The allowed values of a choice; empty for a number.
    pub fn choices(&self) -> Vec<&str> {
        if self.limits().is_some() { Vec::new() } else { self.range.split(OR).collect() }
    }
}
