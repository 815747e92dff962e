//! `objecthood demo`: makes a synthetic scene, finds its objects, and compares them with the truth.

mod video;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use objecthood::{Method, Params, Raster};
use objecthood_eval::{ImageScore, ObjectScore, Verdict, VerdictCounts, score};
use objecthood_io::output;
use objecthood_scene::{Family, Sensor};
use objecthood_view::Recording;

use crate::args::{DemoArgs, OutputKind};
use crate::failure::Outcome;
use crate::outputs::{Found, make_folders_of, refuse_file};
use crate::shell::{program, word};
use crate::synthetic::{Made, Recipe, Shot, camera_file, camera_path, color_path, depth_path};
use crate::watch::{Laps, Watch};
use crate::{config, crew, terminal};

/// The family of the scene: objects of all kinds, seldom hidden.
const FAMILY: Family = Family::Tabletop;
/// The camera that takes the picture.
const SENSOR: Sensor = Sensor::Kinect;

/// Shows one scene or video.
///
/// # Errors
/// Of usage; when the files or stdout cannot be written.
pub(crate) fn run(args: &DemoArgs) -> Result<Outcome> {
    if let Some(clip) = args.video {
        return video::run(args, clip);
    }
    let params = config::params(&args.settings.parameters, args.method)?;
    refuse_file("--out", &args.out)?;
    let recipe = Recipe::new(FAMILY, args.seed.into(), SENSOR);
    let text = crew::pool(args.settings.threads())?.install(|| show(recipe, &params, &args.out))?;
    terminal::print(&text)?;
    Ok(Outcome::AllDone)
}

/// Makes a scene, finds its objects and writes all files to `folder`. Returns the text to print.
fn show(recipe: Recipe, params: &Params, folder: &Path) -> Result<String> {
    let Shot { made, capture, truth } = Shot::of(recipe.make()?)?;
    let mut laps = Laps::start();
    let mut recording = Recording::default();
    let mut watch = Watch { laps: &mut laps, next: &mut recording };
    let discovery = objecthood::discover_observed(&capture.frame, params, &mut watch)?;
    let score = score(&discovery.labels, &truth)?;

    let name = recipe.name();
    let found = Found {
        source: &depth_path(folder, &name).display().to_string(),
        capture: &capture,
        params,
        discovery: &discovery,
        recording: Some(&recording),
    };
    let kinds = BTreeSet::from([OutputKind::Labels, OutputKind::Json, OutputKind::Panels]);
    let stem = folder.join(&name);
    let mut files = found.files(&kinds, &stem)?;
    let table = table(&made, &score, &discovery.labels);
    files.push(camera_file(&made.world, folder)?);
    files.extend(made.into_files(folder)?);
    make_folders_of(&files)?;
    output::write_together(&files)?;

    let (stem, next) = (stem.display(), next_steps(folder, &name, recipe.seed, params.method));
    Ok(format!(
        "{name}, method {}: {table}\n{laps}\nfound: {stem}.labels.png {stem}.json\nlook at: {stem}.panels.png\n\n{next}",
        params.method
    ))
}

/// A table with one line per object: under which number, and how well it was found.
fn table(made: &Made, score: &ImageScore, labels: &Raster<u16>) -> String {
    let counts: VerdictCounts = score.objects.iter().map(|object| object.verdict).collect();
    let mut text = format!("{} of {} objects correct", counts.correct, counts.total());
    // Writing to a string cannot fail.
    let _ = match score.hypotheses_off_objects {
        0 => writeln!(text),
        more => writeln!(text, ", {more} found where there is none"),
    };
    text.push_str("  id  object  pixels  visible   IoU  verdict\n");
    // Truth labels ascend with the instances; an instance without a pixel with depth has no label.
    let instances = &made.rendered.truth.instance;
    let seen = instances.as_slice().iter().copied().collect::<BTreeSet<u16>>();
    let objects = made.world.objects().filter(|instance| seen.contains(instance));
    for (instance, ObjectScore { pixels, iou, verdict, .. }) in objects.zip(&score.objects) {
        let kind = made.world.solid(instance).map_or("", |solid| solid.kind());
        let percent = 100.0 * made.rendered.visible_fraction[usize::from(instance) - 1];
        let verdict = in_words(*verdict);
        let id = found_as(instance, instances, labels).map_or_else(|| "-".to_owned(), |id| id.to_string());
        let _ = writeln!(text, "{id:>4}  {kind:<6}  {pixels:>6}  {percent:>5.0} %  {iou:.2}  {verdict}");
    }
    text
}

/// The number, in label image and pictures, under which most of an object was found. `None` if nothing of it was.
fn found_as(instance: u16, instances: &Raster<u16>, labels: &Raster<u16>) -> Option<u16> {
    let mut pixels = BTreeMap::<u16, usize>::new();
    for (&true_id, &label) in instances.as_slice().iter().zip(labels.as_slice()) {
        if true_id == instance && label > 0 {
            *pixels.entry(label).or_default() += 1;
        }
    }
    pixels.into_iter().max_by_key(|&(label, count)| (count, Reverse(label))).map(|(label, _)| label)
}

fn in_words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Correct => "correct",
        Verdict::Missed => "missed: less than half of it was found",
        Verdict::Occlusion => "occlusion: what stands before it cuts it in parts",
        Verdict::Under => "under: joined with something else",
        Verdict::Over => "over: found in pieces",
        Verdict::Boundary => "boundary: its border is off",
    }
}

/// What to do next, as commands.
fn next_steps(folder: &Path, name: &str, seed: u64, method: Method) -> String {
    let (color, depth) = (word(&color_path(folder, name)), word(&depth_path(folder, name)));
    let (camera, again) = (word(&camera_path(folder)), word(&folder.join("again")));
    let program = program();
    let method = if method == Method::default() { String::new() } else { format!(" --method {method}") };
    // After the last seed the first.
    let seed = seed.wrapping_add(1) & u64::from(u32::MAX);
    format!(
        "next:\n  \
         {program} demo --seed {seed}{method}\n  \
         {program} segment --color {color} --depth {depth} --camera {camera} --out {again}{method} --write labels,json,overlay\n  \
         {program} synth --out scenes --scenes 20\n"
    )
}
