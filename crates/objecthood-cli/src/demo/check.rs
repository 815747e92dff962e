//! `objecthood demo --check`: the method on scenes of every family.

use anyhow::{Context, Result};
use objecthood::{Params, Pipeline};
use objecthood_eval::{Prediction, Report, SceneReport, VerdictsTable};

use super::{SENSOR, Shot};
use crate::args::DemoArgs;
use crate::failure::Outcome;
use crate::synthetic::{Recipe, recipes};
use crate::watch::{Laps, Watch};
use crate::{crew, terminal};

/// Prints what became of the objects of all scenes.
///
/// # Errors
/// When a scene cannot be scored; when stdout cannot be written.
pub(super) fn run(args: &DemoArgs, params: &Params) -> Result<Outcome> {
    let first = args.seed.unwrap_or(0);
    let mut recipes = recipes(args.family, SENSOR, first, args.scenes);
    // As a data set has its folders; within a family they keep their order.
    recipes.sort_by_key(|recipe| recipe.family.name());
    let bar = terminal::progress_bar(recipes.len(), args.settings.verbose);
    let mut scenes = Vec::new();
    crew::in_order(
        &recipes,
        args.settings.threads(),
        |pipeline, recipe| judge(pipeline, recipe, params).with_context(|| recipe.name()),
        |_, scene| {
            scenes.push(scene);
            bar.inc(1);
        },
    )?;
    bar.finish_and_clear();
    let report = Report::new(scenes.into_iter().collect::<Result<_>>()?)?;

    let (method, last) = (params.method, u64::from(first) + u64::from(args.scenes - 1));
    let (total, table) = (&report.total, VerdictsTable(&report));
    let ranking = total.ranking.map(|ranking| format!("{ranking}\n")).unwrap_or_default();
    terminal::print(&format!(
        "method {method}, synthetic scenes {first} to {last}\n{total}\n{ranking}\n{table}\n"
    ))?;
    Ok(Outcome::AllDone)
}

fn judge(pipeline: &mut Pipeline, recipe: &Recipe, params: &Params) -> Result<SceneReport> {
    let shot = Shot::of(*recipe)?;
    let mut laps = Laps::start();
    let mut watch = Watch { laps: &mut laps, next: &mut () };
    let discovery = pipeline.discover_observed(&shot.capture.frame, params, &mut watch)?;
    tracing::info!("{}: {laps}", recipe.name());
    let prediction = Prediction {
        labels: discovery.labels.clone(),
        objects: Some(discovery.objects.clone()),
        stages: None,
    };
    Ok(SceneReport::of(recipe.name(), recipe.family.name().to_owned(), &shot.truth, &prediction)?)
}
