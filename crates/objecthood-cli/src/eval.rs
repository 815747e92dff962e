//! `objecthood eval`: how good a method, or a folder of label images, is on a data set with truth.

mod comparison;
mod families;
mod pictures;
mod plots;
mod report;
mod stock;
mod subject;
mod support;
mod text;
mod videos;

use std::path::Path;

use anyhow::{Context, Result};
use objecthood::{Params, params};
use objecthood_eval::{Report, SceneRef, Split, mosd, scenes};
use objecthood_io::output;
use serde::Serialize;

use crate::args::EvalArgs;
use crate::failure::{Outcome, usage};
use crate::outputs::refuse_file;
use crate::{crew, terminal};
use stock::Stock;
use subject::Subject;

/// A report under the name of its settings.
#[derive(Serialize)]
struct Named<'a> {
    setting: &'a str,
    #[serde(flatten)]
    report: &'a Report,
}

/// Scores the method or the label images and prints the figures.
///
/// # Errors
/// Of usage; when a scene or label image cannot be read, because figures of the other scenes would not compare with
/// those of all; when the figures cannot be written. A file without truth is no scene: it is reported and left out.
pub(crate) fn run(args: &EvalArgs) -> Result<Outcome> {
    for (option, path) in [("--json", &args.json), ("--report", &args.report)] {
        path.iter().try_for_each(|path| refuse_unusable_file(option, path))?;
    }
    if let Some(families) = &args.synthetic.family {
        return families::run(args, &families.0);
    }
    if let (Some(tracks), Some(truth)) = (&args.tracks, &args.truth) {
        return videos::run(args, tracks, truth);
    }
    let (Some(root), None) = (&args.root, args.support) else { return support::run(args) };
    let subject = Subject::new(args)?;
    for (option, folder) in [("--pictures", &args.pictures), ("--plots", &args.plots)] {
        folder.iter().try_for_each(|folder| refuse_file(option, folder))?;
    }
    let Ok(split) = args.split.parse::<Split>();
    let mut scenes = scenes(root, &split)?;
    let unlabelled = mosd::take_unlabelled(&mut scenes);
    for SceneRef { path, .. } in &unlabelled {
        terminal::error(&objecthood_eval::Error::NoTruth { path: path.clone() }.into());
    }

    let seeds = u64::from(args.seed)..u64::from(args.seed) + u64::from(args.composites);
    let sensor = subject.params().map_or_else(params::Sensor::default, |params| params.sensor.clone());
    let (stock, scored) = crew::pool(args.settings.threads())?.install(|| -> Result<_> {
        let stock = Stock::new(scenes, args.camera, seeds, &sensor)?;
        let scored = subject.score(&stock, args.settings.verbose)?;
        if let (Some(folder), Some(params), [(_, report)]) =
            (&args.pictures, subject.params(), &scored.reports[..])
        {
            pictures::draw(folder, &stock, report, params)?;
        }
        Ok((stock, scored))
    })?;
    let reports = &scored.reports;
    let json = match &reports[..] {
        [(_, report)] => to_json(report)?,
        _ => {
            let named: Vec<_> = reports.iter().map(|(setting, report)| Named { setting, report }).collect();
            to_json(&named)?
        }
    };
    // The files first: whatever becomes of stdout, the figures are safe.
    if let Some(path) = &args.json {
        output::write_atomically(path, json.as_bytes())?;
    }
    let plots = plots::of(&scored, subject.comparison());
    if let Some(folder) = &args.plots {
        plots::write(folder, &plots)?;
    }
    let text = text::of(reports, subject.comparison(), args.per_scene);
    if let Some(path) = &args.report {
        let params = subject.params().cloned().unwrap_or_default();
        report::write(path, &text, &plots, &params, (&stock, &scored))?;
    }
    terminal::print(&text)?;
    Ok(if unlabelled.is_empty() { Outcome::AllDone } else { Outcome::SomeFailed })
}

/// Writes figures of which no scenes are shown to the files that were asked for, then prints them. `text` says them in words.
///
/// # Errors
/// When a file or stdout cannot be written.
fn publish(args: &EvalArgs, figures: &impl Serialize, text: &str, params: &Params) -> Result<()> {
    if let Some(path) = &args.json {
        output::write_atomically(path, to_json(figures)?.as_bytes())?;
    }
    if let Some(path) = &args.report {
        report::write_figures(path, text, params)?;
    }
    terminal::print(text)
}

fn refuse_unusable_file(option: &str, file: &Path) -> Result<()> {
    match file.parent() {
        _ if file.is_dir() => Err(usage(format!("{option} {} is a folder: name a file", file.display()))),
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => Err(usage(format!(
            "{option} {}: the folder {} is not there: make it",
            file.display(),
            folder.display()
        ))),
        _ => Ok(()),
    }
}

fn to_json(figures: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(figures).context("the figures cannot be written as JSON")? + "\n")
}
