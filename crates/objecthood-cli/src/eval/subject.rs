//! What is scored.

use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};
use objecthood::{Observer, Params};
use objecthood_eval::{LabelFolder, Prediction, Report, Scene, Setting, StageObserver};

use super::comparison::Comparison;
use super::stock::Stock;
use crate::args::EvalArgs;
use crate::failure::usage;
use crate::watch::{Laps, Watch};
use crate::{config, terminal};

/// What is to be scored.
pub(crate) enum Subject {
    /// Label images that are there already.
    Labels(LabelFolder),
    /// A method.
    Method(Params),
    /// A method with several settings of its parameters.
    Comparison { base: Params, comparison: Comparison, settings: Vec<Setting> },
}

/// What the scores are.
pub(crate) struct Scored {
    /// A report for every setting, by name.
    pub(crate) reports: Vec<(String, Report)>,
    /// How long the stages of a method took (ms), a list for each scene; empty of label images and comparisons.
    pub(crate) laps: Vec<Vec<(&'static str, f64)>>,
}

impl Subject {
    /// What the command line names.
    ///
    /// # Errors
    /// Of usage.
    pub(crate) fn new(args: &EvalArgs) -> Result<Self> {
        let settings = &args.settings;
        if let Some(path) = &args.labels {
            if args.method.is_some()
                || settings.parameters.config.is_some()
                || !settings.parameters.set.is_empty()
                || settings.parameters.all
            {
                return Err(usage(
                    "--labels scores images that are there already, so no method runs that --method, --config, --set \
                     or --all could act on: leave out one or the other",
                ));
            }
            return Ok(Self::Labels(LabelFolder { path: path.clone(), suffix: args.suffix.clone() }));
        }
        let base = config::params(&settings.parameters, args.method)?;
        Ok(match Comparison::asked(args.comparison) {
            None => Self::Method(base),
            Some(comparison) => {
                let settings = comparison.settings(&base, &settings.parameters.set)?;
                Self::Comparison { base, comparison, settings }
            }
        })
    }

    /// What is compared, if anything is.
    pub(crate) fn comparison(&self) -> Option<Comparison> {
        match self {
            Self::Comparison { comparison, .. } => Some(*comparison),
            Self::Labels(_) | Self::Method(_) => None,
        }
    }

    /// The parameters in force, of whatever is compared; the data set's own sensor among them.
    pub(crate) fn params(&self) -> Option<&Params> {
        match self {
            Self::Labels(_) => None,
            Self::Method(params) | Self::Comparison { base: params, .. } => Some(params),
        }
    }

    /// Scores every scene.
    ///
    /// # Errors
    /// Of the scenes that fail, what the first one fails with.
    pub(crate) fn score(&self, stock: &Stock, verbose: bool) -> Result<Scored> {
        let with_stages = !matches!(self.comparison(), Some(Comparison::Ladder | Comparison::Sensitivity));
        let alone;
        let settings: &[Setting] = match self {
            Self::Labels(folder) => {
                let bar = terminal::progress_bar(stock.len(), verbose);
                let report = stock.evaluate_labels(|reference| {
                    bar.inc(1);
                    folder.read(reference)
                })?;
                bar.finish_and_clear();
                let reports = vec![(folder.path.display().to_string(), report)];
                return Ok(Scored { reports, laps: Vec::new() });
            }
            Self::Method(params) => {
                alone = [Setting { name: params.method.to_string(), params: params.clone() }];
                &alone
            }
            Self::Comparison { settings, .. } => settings,
        };
        let bar = terminal::progress_bar(settings.len() * stock.len(), verbose);
        let laps = Mutex::new(Vec::new());
        // The stages take time, and only the paper's comparison is about them.
        let reports = stock.evaluate(settings, |setting, scene, source| {
            let (prediction, took) = predict(setting, scene, source, with_stages)?;
            bar.inc(1);
            if self.comparison().is_none() {
                laps.lock().unwrap_or_else(PoisonError::into_inner).push(took);
            }
            Ok(prediction)
        })?;
        bar.finish_and_clear();
        let reports = settings.iter().map(|setting| setting.name.clone()).zip(reports).collect();
        Ok(Scored { reports, laps: laps.into_inner().unwrap_or_else(PoisonError::into_inner) })
    }
}

/// Runs a method on one scene, which is `source` to the user; how long its stages took (ms).
fn predict(
    setting: &Setting,
    scene: &Scene,
    source: &str,
    with_stages: bool,
) -> Result<(Prediction, Vec<(&'static str, f64)>)> {
    let (mut laps, mut stages) = (Laps::start(), StageObserver::new(&scene.truth));
    let next: &mut dyn Observer = if with_stages { &mut stages } else { &mut () };
    let mut watch = Watch { laps: &mut laps, next };
    let discovery = objecthood::discover_observed(&scene.frame, &setting.params, &mut watch)
        .with_context(|| source.to_owned())?;
    tracing::info!("{source}, {}: {laps}", setting.name);
    let prediction = Prediction {
        labels: discovery.labels,
        objects: Some(discovery.objects),
        stages: if with_stages { Some(stages.into_stages()?) } else { None },
    };
    Ok((prediction, laps.ended_ms()))
}
