//! `objecthood eval --support`: scores the support forest on synthetic scenes.

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use objecthood::Method;
use objecthood_eval::support::{FAMILIES, SceneSupport, SupportReport};
use objecthood_scene::Sensor;

use crate::args::EvalArgs;
use crate::failure::{Outcome, usage};
use crate::synthetic::Recipe;
use crate::{config, crew, terminal};

/// Scores the forests of the scenes and prints the figures.
///
/// # Errors
/// Of usage; when a scene cannot be scored; when the figures cannot be written.
pub(super) fn run(args: &EvalArgs) -> Result<Outcome> {
    let params = config::params(&args.settings.parameters, args.method)?;
    if params.method != Method::Context {
        return Err(usage(
            "--support is about the forest of the method context: leave out --method, or see the support graph of \
             paper in the scene files of `objecthood segment --method paper`",
        ));
    }
    let (first, scenes) = (u64::from(args.seed), u64::from(args.support.unwrap_or(0)));
    let recipes: Vec<Recipe> = FAMILIES
        .into_iter()
        .cycle()
        .zip(first..first + scenes)
        .map(|(family, seed)| Recipe::new(family, seed, Sensor::Kinect))
        .collect();
    let bar = terminal::progress_bar(recipes.len(), args.settings.verbose);
    let mut by_family: BTreeMap<&'static str, SceneSupport> = BTreeMap::new();
    let mut failed = None;
    crew::in_order(
        &recipes,
        args.settings.threads(),
        |(): &mut (), recipe| {
            SceneSupport::of(recipe.family, recipe.seed, recipe.sensor, &params)
                .with_context(|| recipe.name())
        },
        |recipe, score| {
            bar.inc(1);
            match score {
                Ok(score) => *by_family.entry(recipe.family.name()).or_default() += score,
                Err(e) => failed = failed.take().or(Some(e)),
            }
        },
    )?;
    bar.finish_and_clear();
    if let Some(e) = failed {
        return Err(e);
    }
    let report = SupportReport::new(first, scenes, by_family);
    super::publish(args, &report, &format!("{report}\n"), &params)?;
    Ok(Outcome::AllDone)
}
