//! A look at a frame: the method runs, and what the page draws is packed.

use std::collections::BTreeSet;
use std::time::Duration;

use objecthood::{Discovery, Pipeline};
use objecthood_eval::{ImageScore, Truth, Verdict, VerdictCounts, mosd, object_map, score};
use objecthood_io::Capture;
use objecthood_io::scene::SceneFile;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::{Error, Result};
use crate::layers::Layers;
use crate::maps::{NAMES, color, depth, labels};
use crate::pack::{Map, pack};
use crate::settings::{Settings, values};

/// What to look at, and what of it to show.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Look {
    /// The number of the frame.
    pub frame: usize,
    /// The parameters.
    pub settings: Settings,
    /// The maps to pack, by name; docs/PAGE.md lists them.
    pub maps: BTreeSet<String>,
}

/// Looks at a frame, which is called `name`. Of the stages only those run that the pipeline has not kept.
///
/// # Errors
/// [`Error::Parameter`], [`Error::NoMap`], and whatever the method fails with.
pub fn look(pipeline: &mut Pipeline, name: &str, capture: &Capture, asked: &Look) -> Result<Vec<u8>> {
    let (header, maps) = seen(pipeline, name, capture, asked)?;
    pack(header, &maps)
}

/// The header and the maps of a look.
///
/// # Errors
/// As [`look`].
pub(crate) fn seen(
    pipeline: &mut Pipeline,
    name: &str,
    capture: &Capture,
    asked: &Look,
) -> Result<(Value, Vec<Map>)> {
    if let Some(unknown) = asked.maps.iter().find(|map| !NAMES.contains(&map.as_str())) {
        return Err(Error::NoMap(unknown.clone()));
    }
    let params = asked.settings.params()?;
    let (frame, wanted) = (&capture.frame, &asked.maps);
    let mut layers = Layers::new(frame, &params.contraction, wanted);
    let discovery = pipeline.discover_observed(frame, &params, &mut layers)?;
    let Layers { mut maps, laps, .. } = layers;
    if wanted.contains("color") {
        maps.extend(color(frame));
    }
    if wanted.contains("depth") {
        maps.push(depth(frame));
    }
    let truth = capture.truth.as_ref().map(mosd::truth_of).transpose()?;
    if let Some(truth) = truth.as_ref().filter(|_| wanted.contains("truth")) {
        maps.push(labels("truth", &object_map(truth)?));
    }
    let laps: Vec<Value> = laps.iter().map(|(stage, took)| json!([stage, milliseconds(*took)])).collect();
    let header = json!({
        "frame": asked.frame,
        "name": name,
        "settings": asked.settings,
        "values": values(&params)?,
        "scene": SceneFile::new(name, capture, &params, discovery),
        "truth": truth.map(|truth| scored(discovery, &truth)).transpose()?,
        "stages_ms": laps,
    });
    Ok((header, maps))
}

/// How well what was found fits the truth.
fn scored(discovery: &Discovery, truth: &Truth) -> Result<Value> {
    let ImageScore { metrics, objects, hypotheses, hypotheses_off_objects } =
        score(&discovery.labels, truth)?;
    let counts: VerdictCounts = objects.iter().map(|object| object.verdict).collect();
    let verdicts: Vec<Value> = objects
        .iter()
        .map(|object| json!({ "verdict": word(object.verdict), "iou": object.iou, "pixels": object.pixels }))
        .collect();
    Ok(json!({
        "correct": counts.correct,
        "objects": verdicts,
        "hypotheses": hypotheses,
        "off_objects": hypotheses_off_objects,
        "overlap_f": metrics.map(|metrics| metrics.overlap.f),
    }))
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Correct => "correct",
        Verdict::Missed => "missed",
        Verdict::Occlusion => "occlusion",
        Verdict::Under => "under",
        Verdict::Over => "over",
        Verdict::Boundary => "boundary",
    }
}

fn milliseconds(time: Duration) -> f64 {
    (1e5 * time.as_secs_f64()).round() / 100.0
}
