//! What it costs to follow objects through a video, beside finding them.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use objecthood::{Estimates, Params, Pipeline};
use objecthood_io::{Given, Source};
use objecthood_track::Tracker;
use rayon::ThreadPoolBuilder;

use crate::figure::{Figure, timed};
use crate::recomputed::median;

/// Frames a second of a clip without times, as `objecthood track` assumes.
const RATE_HZ: f64 = 30.0;

/// Times a clip on one thread, without reading: the discovery of each frame, the tracking of what was found, and both as
/// [`Tracker::update`] does them. That also looks for known things among hypotheses that are no objects, which the tracking alone does not.
///
/// # Errors
/// When a frame cannot be read, the method refuses one, or there is none.
pub fn track(folder: &Path) -> Result<Vec<Figure>> {
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    let params = Params::default();
    let (mut pipeline, mut tracker) = (Pipeline::default(), Tracker::new(params.clone()));
    let mut whole = Tracker::new(params.clone());
    let (mut last_s, mut earlier): (_, Option<Estimates>) = (None, None);
    // CPU time of each frame (ms).
    let [mut discovery, mut tracking, mut update] = [const { Vec::new() }; 3];
    for (number, capture) in Source::open(folder, &Given::default())?.captures().enumerate() {
        let capture = capture?;
        let stamp_s = capture.stamp_s(number, last_s, RATE_HZ);
        last_s = Some(stamp_s);
        let frame = &capture.frame;

        // As the tracker does it: with what earlier frames told.
        let known = frame.clone().with_estimates(earlier);
        let (found, spent) = timed(|| one.install(|| pipeline.discover(&known, &params)));
        let found = found?;
        earlier = found.estimates.or(earlier);
        discovery.push(1e3 * spent.cpu.as_secs_f64());
        let (followed, spent) = timed(|| one.install(|| tracker.update_found(frame, found, stamp_s, None)));
        followed?;
        tracking.push(1e3 * spent.cpu.as_secs_f64());
        let (followed, spent) = timed(|| one.install(|| whole.update(frame, stamp_s, None)));
        followed?;
        update.push(1e3 * spent.cpu.as_secs_f64());
    }
    ensure!(!update.is_empty(), "{} has no frames", folder.display());
    let clip = folder.file_name().context("a folder without a name")?.to_string_lossy();
    let figure = |series: String, value| Figure { frame: clip.clone().into_owned(), series, value };
    let mut figures = Vec::new();
    for (statistic, of) in [("median", median as fn(&mut [f64]) -> f64), ("mean", |values| mean(values))] {
        let [discovery, tracking, update] =
            [&mut discovery, &mut tracking, &mut update].map(|times_ms| of(times_ms));
        for (part, ms) in [("discovery", discovery), ("tracking", tracking), ("update", update)] {
            figures.push(figure(format!("{part}/{statistic}/cpu_ms"), ms));
        }
        let percent = 100.0 * tracking / discovery;
        figures.push(figure(format!("tracking of discovery/{statistic}/percent"), percent));
    }
    figures.push(figure("update/frames_per_s".into(), 1e3 / mean(&update)));
    Ok(figures)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
