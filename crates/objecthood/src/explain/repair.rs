//! The search for a repair: tries, for every single parameter, whether it turns the answer for a pixel, or
//! for two.
//!
//! A [`Flip`](crate::explain::Flip) turns one decision that the method made. A repair turns the result, whichever decision led to it.

use std::cmp::{Ordering, Reverse};
use std::fmt;

use rayon::prelude::*;
use serde::Serialize;

use crate::error::Result;
use crate::explain::Explainer;
use crate::explain::belonging::{Belonging, Pixels};
use crate::explain::explanation::as_set;
use crate::explain::guess::{info, is_whole};
use crate::explain::others::{Others, changes};
use crate::explain::trials::{between, ladders};
use crate::params::{Method, ParameterInfo, Params, Sensor};

/// Most halvings of the interval between a value that turns the answer and one that does not.
const HALVINGS: usize = 6;
/// A value is mild enough if undoing this share of the change is too much.
const EXACT: f64 = 0.05;

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(#[serde(serialize_with = "as_set")] f64),
    /// On or off.
    Switch(bool),
    /// One of several names.
    Choice(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Switch(is_on) => write!(f, "{is_on}"),
            Self::Choice(name) => f.write_str(name),
        }
    }
}

/// A change of one parameter that turns the answer, confirmed by a run of the whole method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repair {
    /// The parameter.
    pub parameter: String,
    /// Its present value.
    pub from: Value,
    /// The value that turns the answer. The first values found below and above the present one are made as
    /// mild as halving allows; this is the one that ranks better.
    pub to: Value,
    /// The size of the change: as a share of the present value; of the range, when that is 0; 1 for a choice.
    pub change: f64,
    /// The other objects of the frame that it changes.
    pub others: Others,
}

impl Repair {
    /// The better one comes first: it changes fewer other objects; then the parameter changes by less; then
    /// the name decides.
    pub fn rank(&self, other: &Self) -> Ordering {
        let others = self.others.count().cmp(&other.others.count());
        others
            .then_with(|| self.change.total_cmp(&other.change))
            .then_with(|| self.parameter.cmp(&other.parameter))
    }
}

/// A search that the caller continues for as long as it likes, a few parameters at a time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RepairSearch {
    /// The question.
    #[serde(flatten)]
    pub pixels: Pixels,
    /// The present answer.
    pub now: Belonging,
    /// Number of parameters that were tried.
    pub tried: usize,
    /// The parameters that are still to be tried, those of the last stage first: they cost least.
    pub left: Vec<String>,
    /// What was found, the best first ([`Repair::rank`]).
    pub found: Vec<Repair>,
}

impl RepairSearch {
    /// Nothing is tried yet.
    ///
    /// # Errors
    /// [`Error::OutsideImage`](crate::Error::OutsideImage).
    pub fn new(explainer: &Explainer, pixels: Pixels) -> Result<Self> {
        let now = pixels.belonging(&explainer.discovery().labels)?;
        let stage = |info: &ParameterInfo| info.first_stage(Method::Context);
        let mut table: Vec<ParameterInfo> =
            Params::table().into_iter().filter(|info| stage(info).is_some()).collect();
        table.sort_by_key(|info| Reverse(stage(info)));
        let left = table.into_iter().map(|info| info.name).collect();
        Ok(Self { pixels, now, tried: 0, left, found: Vec::new() })
    }

    /// Tries the next parameters, one on each thread of the pool; false if none is left. A parameter costs up
    /// to 22 runs of the stages from the first one that reads it: five values and six halvings on either
    /// side.
    pub fn step(&mut self, explainer: &Explainer) -> bool {
        let count = rayon::current_num_threads().min(self.left.len());
        let next: Vec<String> = self.left.drain(..count).collect();
        self.tried += count;
        let repair = |parameter: &String| explainer.repair(self.pixels, self.now, parameter);
        let found: Vec<Repair> = next.par_iter().filter_map(repair).collect();
        self.found.extend(found);
        self.found.sort_by(Repair::rank);
        count > 0
    }
}

impl Explainer {
    /// The mildest value found of one parameter that turns the answer.
    fn repair(&self, pixels: Pixels, now: Belonging, parameter: &str) -> Option<Repair> {
        let trials = Trials { explainer: self, pixels, now, parameter };
        let found = match self.subject.params.number(parameter) {
            Some(from) => trials.number(from),
            None => trials.choice(),
        };
        found.into_iter().min_by(Repair::rank)
    }
}

/// The trials of one parameter.
struct Trials<'a> {
    explainer: &'a Explainer,
    pixels: Pixels,
    now: Belonging,
    parameter: &'a str,
}

impl Trials<'_> {
    /// For a number: the mildest value below and above the present one. The nearest value that turns the
    /// answer on either side ends both searches.
    fn number(&self, from: f64) -> Vec<Repair> {
        let Some((least, greatest)) = info(self.parameter).and_then(|info| info.limits()) else {
            return Vec::new();
        };
        let whole = is_whole(self.parameter);
        let sides = ladders(from, (least, greatest), whole);
        let steps = sides.iter().map(Vec::len).max().unwrap_or(0);
        for k in 0..steps {
            let at = |side: &Vec<f64>| {
                let far = *side.get(k)?;
                let others = self.others(&self.with_number(far)?)?;
                let near = k.checked_sub(1).map_or(from, |k| side[k]);
                Some(self.milder(from, (near, far), others, whole))
            };
            let turned: Vec<(f64, Others)> = sides.iter().filter_map(at).collect();
            if turned.is_empty() {
                continue;
            }
            let of = if from == 0.0 { greatest - least } else { from.abs() };
            let repair = |(to, others): (f64, Others)| Repair {
                parameter: self.parameter.to_owned(),
                from: Value::Number(from),
                to: Value::Number(to),
                change: (to - from).abs() / of,
                others,
            };
            return turned.into_iter().map(repair).collect();
        }
        Vec::new()
    }

    /// Halves the interval between a value that does not turn the answer and one that does.
    fn milder(
        &self,
        from: f64,
        (mut near, mut far): (f64, f64),
        mut others: Others,
        whole: bool,
    ) -> (f64, Others) {
        for _ in 0..HALVINGS {
            if (far - near).abs() <= EXACT * (far - from).abs() {
                break;
            }
            let Some(middle) = between(near, far, whole) else { break };
            match self.with_number(middle).and_then(|params| self.others(&params)) {
                Some(fewer) => (far, others) = (middle, fewer),
                None => near = middle,
            }
        }
        (far, others)
    }

    /// For a switch or a choice: every other value that turns the answer.
    fn choice(&self) -> Vec<Repair> {
        let params = &self.explainer.subject.params;
        let (Some(info), Some(from)) = (info(self.parameter), params.choice(self.parameter)) else {
            return Vec::new();
        };
        let value = |name: &str| name.parse().map_or_else(|_| Value::Choice(name.to_owned()), Value::Switch);
        let repair = |to: &str| {
            let others = self.others(&with_choice(params, self.parameter, to)?)?;
            Some(Repair {
                parameter: self.parameter.to_owned(),
                from: value(&from),
                to: value(to),
                change: 1.0,
                others,
            })
        };
        info.choices().into_iter().filter(|to| *to != from).filter_map(repair).collect()
    }

    fn with_number(&self, value: f64) -> Option<Params> {
        self.explainer.subject.params.with_number(self.parameter, value)
    }

    /// The other objects that come and go with these parameters; `None` if they do not turn the answer, or if
    /// the method fails with them.
    fn others(&self, params: &Params) -> Option<Others> {
        let subject = &self.explainer.subject;
        // Only the stages that the parameter affects run again.
        let mut trial = subject.pipeline.clone();
        let then = &trial.discover(&subject.frame, params).ok()?.labels;
        // Objects have other numbers in every run; only the pixels identify them.
        let is_turned = self.pixels.belonging(then).is_ok_and(|then| self.now.is_turned_by(then));
        is_turned.then(|| changes(&self.explainer.discovery().labels, then, self.pixels))
    }
}

/// As [`Params::with_choice`]; the kind of the sensor also sets its sideways noise, unless that was set itself, as it does for users.
fn with_choice(params: &Params, parameter: &str, name: &str) -> Option<Params> {
    let mut other = params.with_choice(parameter, name)?;
    if params.sensor.lateral_noise_px == Sensor::of(params.sensor.profile).lateral_noise_px {
        other.sensor.lateral_noise_px = Sensor::of(other.sensor.profile).lateral_noise_px;
    }
    Some(other)
}
