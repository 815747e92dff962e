//! `objecthood eval --family`: a method on synthetic scenes, family by family and sensor by sensor.

use anyhow::{Context, Result};
use objecthood::{Params, Pipeline};
use objecthood_eval::{FamiliesTable, FamilyFigures, Prediction, SceneReport};
use objecthood_scene::{Exposure, Family, Sensor};
use serde::Serialize;

use crate::args::{EvalArgs, SyntheticArgs};
use crate::failure::Outcome;
use crate::synthetic::{Made, Recipe, Shot};
use crate::watch::{Laps, Watch};
use crate::{config, crew, terminal};

/// A line of the table in the file of figures.
#[derive(Serialize)]
struct Line<'a> {
    family: &'a str,
    sensor: &'a str,
    #[serde(flatten)]
    figures: FamilyFigures,
}

/// Scores the method on the scenes and prints the figures.
///
/// # Errors
/// Of usage; when a scene cannot be scored; when the figures cannot be written.
pub(super) fn run(args: &EvalArgs, families: &[Family]) -> Result<Outcome> {
    let params = config::params(&args.settings.parameters, args.method)?;
    let SyntheticArgs { sensor: sensors, scenes, holes, .. } = &args.synthetic;
    let (first, scenes) = (u64::from(args.seed), u64::from(*scenes));
    let recipes: Vec<Recipe> = families
        .iter()
        .flat_map(|&family| (first..first + scenes).map(move |seed| (family, seed)))
        .map(|(family, seed)| Recipe { holes: *holes, ..Recipe::new(family, seed, Sensor::Kinect) })
        .collect();
    let bar = terminal::progress_bar(recipes.len(), args.settings.verbose);
    let mut reports = Vec::new();
    crew::in_order(
        &recipes,
        args.settings.threads(),
        |pipeline, recipe| judge(pipeline, recipe, &sensors.0, &params).with_context(|| recipe.name()),
        |_, seen| {
            reports.push(seen);
            bar.inc(1);
        },
    )?;
    bar.finish_and_clear();
    let reports = reports.into_iter().collect::<Result<Vec<_>>>()?;

    let rows = rows(families, &sensors.0, &reports);
    let lines: Vec<Line<'_>> =
        rows.iter().map(|(family, sensor, figures)| Line { family, sensor, figures: *figures }).collect();
    let (method, last, table) = (params.method, first + scenes - 1, FamiliesTable(&rows));
    let text = format!("method {method}, synthetic scenes {first} to {last}, holes {holes}\n\n{table}\n");
    super::publish(args, &lines, &text, &params)?;
    Ok(Outcome::AllDone)
}

/// The scene as every sensor sees it. What takes long, the light, is the same for all.
fn judge(
    pipeline: &mut Pipeline,
    recipe: &Recipe,
    sensors: &[Sensor],
    params: &Params,
) -> Result<Vec<SceneReport>> {
    let world = recipe.world()?;
    let exposure = Exposure::of(&world)?;
    let mut reports = Vec::new();
    for &sensor in sensors {
        let rendered = exposure.seen_by(sensor, recipe.holes).with_context(|| sensor.to_string())?;
        let shot = Shot::of(Made::of(Recipe { sensor, ..*recipe }, world.clone(), rendered)?)?;
        let mut laps = Laps::start();
        let mut watch = Watch { laps: &mut laps, next: &mut () };
        let discovery = pipeline.discover_observed(&shot.capture.frame, params, &mut watch)?;
        tracing::info!("{} {sensor}: {laps}", recipe.name());
        let prediction = Prediction {
            labels: discovery.labels.clone(),
            objects: Some(discovery.objects.clone()),
            stages: None,
        };
        let family = recipe.family.name().to_owned();
        reports.push(SceneReport::of(recipe.name(), family, &shot.truth, &prediction)?);
    }
    Ok(reports)
}

/// A row for each family and sensor and, of several families, one for each sensor over all of them.
fn rows(
    families: &[Family],
    sensors: &[Sensor],
    reports: &[Vec<SceneReport>],
) -> Vec<(String, String, FamilyFigures)> {
    let mut rows = Vec::new();
    let names = families.iter().map(|family| Some(family.name()));
    for of in names.chain((families.len() > 1).then_some(None)) {
        for (k, sensor) in sensors.iter().enumerate() {
            let seen = reports.iter().map(|scene| &scene[k]);
            let own = seen.filter(|report| of.is_none_or(|name| report.folder == name));
            rows.push((of.unwrap_or("all").to_owned(), sensor.to_string(), FamilyFigures::of(own)));
        }
    }
    rows
}
