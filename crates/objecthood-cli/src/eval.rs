//! `objecthood eval`: how good a method, or a folder of label images, is on a data set with truth.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result};
use indicatif::ProgressBar;
use objecthood::Params;
use objecthood::params::Channels;
use objecthood_eval::{
    LabelFolder, Prediction, Report, Scene, SceneRef, SettingsTable, Split, StageObserver, StagesTable,
    VerdictsTable, evaluate, evaluate_settings, mosd,
};
use objecthood_io::output;
use serde::Serialize;

use crate::args::EvalArgs;
use crate::failure::{Outcome, usage};
use crate::watch::{Laps, Watch};
use crate::{config, crew, terminal};

/// What is to be scored.
enum Subject {
    /// Label images that are there already.
    Labels(LabelFolder),
    /// A method, with one or several settings of its parameters by name.
    Settings(Vec<(String, Params)>),
}

/// A report under the name of its settings.
#[derive(Serialize)]
struct Named<'a> {
    setting: &'a str,
    #[serde(flatten)]
    report: &'a Report,
}

/// Scores what the command line names and prints the figures.
///
/// # Errors
/// Of usage; when a scene or label image cannot be read, because figures of the other scenes would not compare with
/// those of all; when the figures cannot be written.
pub(crate) fn run(args: &EvalArgs) -> Result<Outcome> {
    let subject = Subject::new(args)?;
    if let Some(path) = &args.json {
        refuse_what_cannot_be_a_file(path)?;
    }
    let Ok(split) = args.split.parse::<Split>();
    let scenes = mosd::scenes(&args.root, &split)?;

    let reports = crew::pool(args.settings.threads())?.install(|| subject.score(&scenes, args))?;
    let (text, json) = match &reports[..] {
        [(_, report)] => (one(&reports, report, args.per_scene), to_json(report)?),
        _ => {
            let named: Vec<_> = reports.iter().map(|(setting, report)| Named { setting, report }).collect();
            (several(&reports, args.per_scene), to_json(&named)?)
        }
    };
    // The file first: whatever becomes of stdout, the figures are safe.
    if let Some(path) = &args.json {
        output::write_atomically(path, json.as_bytes())?;
    }
    terminal::print(&text)?;
    Ok(Outcome::AllDone)
}

impl Subject {
    fn new(args: &EvalArgs) -> Result<Self> {
        let settings = &args.settings;
        if let Some(path) = &args.labels {
            let for_a_method = args.method.is_some() || args.ablation;
            if for_a_method || settings.config.is_some() || !settings.set.is_empty() {
                return Err(usage(
                    "--labels scores images that are there already, so no method runs that --method, --ablation, \
                     --config or --set could act on: leave out one or the other",
                ));
            }
            return Ok(Self::Labels(LabelFolder { path: path.clone(), suffix: args.suffix.clone() }));
        }
        let params = config::params(settings, args.method)?;
        if !args.ablation {
            return Ok(Self::Settings(vec![(params.method.to_string(), params)]));
        }
        let swept =
            |assignment: &&String| ABLATED.iter().any(|name| assignment.trim_start().starts_with(name));
        if let Some(assignment) = settings.set.iter().find(swept) {
            let names = ABLATED.join(" and ");
            return Err(usage(format!(
                "--ablation goes through the values of {names}: leave out --set {assignment}"
            )));
        }
        Ok(Self::Settings(ablation(&params)))
    }

    /// One report for every setting.
    fn score(&self, scenes: &[SceneRef], args: &EvalArgs) -> Result<Vec<(String, Report)>> {
        let camera = args.camera.as_ref();
        let runs = match self {
            Self::Labels(_) => 1,
            Self::Settings(settings) => settings.len(),
        };
        let bar = terminal::progress_bar(runs * scenes.len(), args.settings.verbose);
        let reports = match self {
            Self::Labels(folder) => {
                let report = evaluate(scenes, camera, |_, reference| {
                    bar.inc(1);
                    folder.read(reference)
                })?;
                vec![(folder.path.display().to_string(), report)]
            }
            Self::Settings(settings) => {
                let reports =
                    evaluate_settings(scenes, camera, settings, |(name, params), scene, reference| {
                        discover(name, params, scene, reference, &bar)
                    })?;
                settings.iter().map(|(name, _)| name.clone()).zip(reports).collect()
            }
        };
        bar.finish_and_clear();
        Ok(reports)
    }
}

/// Runs a method on one scene.
fn discover(
    setting: &str,
    params: &Params,
    scene: &Scene,
    reference: &SceneRef,
    bar: &ProgressBar,
) -> Result<Prediction> {
    let path = reference.path.display();
    let mut laps = Laps::start();
    let mut stages = StageObserver::new(&scene.truth);
    let mut watch = Watch { laps: &mut laps, next: &mut stages };
    let discovery =
        objecthood::discover_observed(&scene.frame, params, &mut watch).with_context(|| path.to_string())?;
    tracing::info!("{path}, {setting}: {laps}");
    bar.inc(1);
    Ok(Prediction { labels: discovery.labels, stages: Some(stages.into_stages()?) })
}

/// The parameters that `--ablation` goes through.
const ABLATED: [&str; 2] = ["graph.channels", "curvature.enabled"];

/// The paper's comparison: colour, depth and both, without and with curvature.
fn ablation(params: &Params) -> Vec<(String, Params)> {
    let mut settings = Vec::new();
    for (enabled, word) in [(false, "off"), (true, "on")] {
        for channels in [Channels::Color, Channels::Depth, Channels::Both] {
            let mut params = params.clone();
            params.graph.channels = channels;
            params.curvature.enabled = enabled;
            settings.push((format!("{channels}, curvature {word}"), params));
        }
    }
    settings
}

fn refuse_what_cannot_be_a_file(file: &Path) -> Result<()> {
    match file.parent() {
        _ if file.is_dir() => Err(usage(format!("--json {} is a folder: name a file", file.display()))),
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => Err(usage(format!(
            "--json {}: the folder {} is not there: make it",
            file.display(),
            folder.display()
        ))),
        _ => Ok(()),
    }
}

fn to_json(figures: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(figures).context("the figures cannot be written as JSON")? + "\n")
}

/// One report in words: the line of `tools/score.py`, what became of the objects, and the stages if a method ran.
fn one(reports: &[(String, Report)], report: &Report, per_scene: bool) -> String {
    let mut text = if per_scene { scene_lines(report) } else { String::new() };
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}\n\n{}", report.total, VerdictsTable(report));
    if report.total.stages.is_some() {
        let _ = writeln!(text, "\n{}", StagesTable(reports));
    }
    text
}

/// Several reports side by side.
fn several(reports: &[(String, Report)], per_scene: bool) -> String {
    let mut text = String::new();
    for (setting, report) in reports.iter().filter(|_| per_scene) {
        let _ = writeln!(text, "{setting}\n{}", scene_lines(report));
    }
    let _ = writeln!(text, "{}\n\n{}", SettingsTable(reports), StagesTable(reports));
    text
}

fn scene_lines(report: &Report) -> String {
    report.scenes.iter().map(|scene| format!("{scene}\n")).collect()
}
