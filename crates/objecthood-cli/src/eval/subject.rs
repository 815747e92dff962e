//! What is scored, and on what.

use anyhow::{Context, Result};
use indicatif::ProgressBar;
use objecthood::{Observer, Params};
use objecthood_eval::{
    Composer, LabelFolder, Prediction, Report, Scene, SceneRef, Setting, StageObserver, evaluate,
    evaluate_composites, evaluate_settings,
};

use super::comparison::Comparison;
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

impl Subject {
    /// What the command line names.
    ///
    /// # Errors
    /// Of usage.
    pub(crate) fn new(args: &EvalArgs) -> Result<Self> {
        let settings = &args.settings;
        if let Some(path) = &args.labels {
            if args.method.is_some() || settings.config.is_some() || !settings.set.is_empty() {
                return Err(usage(
                    "--labels scores images that are there already, so no method runs that --method, --config or \
                     --set could act on: leave out one or the other",
                ));
            }
            return Ok(Self::Labels(LabelFolder { path: path.clone(), suffix: args.suffix.clone() }));
        }
        let base = config::params(settings, args.method)?;
        Ok(match Comparison::asked(args.comparison) {
            None => Self::Method(base),
            Some(comparison) => {
                let settings = comparison.settings(&base, &settings.set)?;
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

    /// One report for every setting, by name.
    ///
    /// # Errors
    /// Of the scenes that fail, what the first one fails with.
    pub(crate) fn score(&self, scenes: &[SceneRef], args: &EvalArgs) -> Result<Vec<(String, Report)>> {
        match self {
            Self::Labels(folder) => {
                let bar = terminal::progress_bar(scenes.len(), args.settings.verbose);
                let report = evaluate(scenes, args.camera.as_ref(), |_, reference| {
                    bar.inc(1);
                    folder.read(reference)
                })?;
                bar.finish_and_clear();
                Ok(vec![(folder.path.display().to_string(), report)])
            }
            Self::Method(params) => {
                let setting = Setting { name: params.method.to_string(), params: params.clone() };
                score_settings(params, &[setting], scenes, args, true)
            }
            Self::Comparison { base, comparison, settings } => {
                // The stages take time, and only the paper's comparison is about them.
                score_settings(base, settings, scenes, args, *comparison == Comparison::Ablation)
            }
        }
    }
}

/// Scores every setting on the scenes and on as many composed ones as are asked for; `base` knows the sensor that took
/// the scenes, whatever the settings make of it.
fn score_settings(
    base: &Params,
    settings: &[Setting],
    scenes: &[SceneRef],
    args: &EvalArgs,
    with_stages: bool,
) -> Result<Vec<(String, Report)>> {
    let composites = u64::from(args.composites);
    let runs = settings.len() * (scenes.len() + args.composites as usize);
    let bar = terminal::progress_bar(runs, args.settings.verbose);
    let mut reports =
        evaluate_settings(scenes, args.camera.as_ref(), settings, |setting, scene, reference| {
            predict(setting, scene, &reference.path.display().to_string(), with_stages, &bar)
        })?;
    if composites > 0 {
        let composer = Composer::new(scenes, args.camera, &base.sensor)?;
        let seeds = u64::from(args.seed)..u64::from(args.seed) + composites;
        let composed = evaluate_composites(&composer, seeds, settings, |setting, scene, name| {
            predict(setting, scene, name, with_stages, &bar)
        })?;
        let both = reports.into_iter().zip(composed);
        reports = both.map(|(own, composed)| own.joined(composed)).collect::<objecthood_eval::Result<_>>()?;
    }
    bar.finish_and_clear();
    Ok(settings.iter().map(|setting| setting.name.clone()).zip(reports).collect())
}

/// Runs a method on one scene, which is `source` to the user.
fn predict(
    setting: &Setting,
    scene: &Scene,
    source: &str,
    with_stages: bool,
    bar: &ProgressBar,
) -> Result<Prediction> {
    let (mut laps, mut stages) = (Laps::start(), StageObserver::new(&scene.truth));
    let next: &mut dyn Observer = if with_stages { &mut stages } else { &mut () };
    let mut watch = Watch { laps: &mut laps, next };
    let discovery = objecthood::discover_observed(&scene.frame, &setting.params, &mut watch)
        .with_context(|| source.to_owned())?;
    tracing::info!("{source}, {}: {laps}", setting.name);
    bar.inc(1);
    Ok(Prediction {
        labels: discovery.labels,
        stages: if with_stages { Some(stages.into_stages()?) } else { None },
    })
}
