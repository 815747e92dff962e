//! What it costs to follow objects through a video, beside finding them.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, ensure};
use objecthood::{Estimates, Params, Pipeline};
use objecthood_io::{Given, Source};
use objecthood_track::Tracker;
use rayon::ThreadPoolBuilder;

use crate::figure::{Figure, timed};

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
        discovery.push(spent.cpu);
        let (followed, spent) = timed(|| one.install(|| tracker.update_found(frame, found, stamp_s, None)));
        followed?;
        tracking.push(spent.cpu);
        let (followed, spent) = timed(|| one.install(|| whole.update(frame, stamp_s, None)));
        followed?;
        update.push(spent.cpu);
    }
    ensure!(!update.is_empty(), "{} has no frames", folder.display());
    let clip = folder.file_name().context("a folder without a name")?.to_string_lossy();
    let figure = |series: String, value| Figure { frame: clip.clone().into_owned(), series, value };
    let mut figures = Vec::new();
    for (statistic, of) in [("median", median_ms as fn(&[Duration]) -> f64), ("mean", mean_ms)] {
        let [discovery, tracking, update] = [&discovery, &tracking, &update].map(|times| of(times));
        for (part, ms) in [("discovery", discovery), ("tracking", tracking), ("update", update)] {
            figures.push(figure(format!("{part}/{statistic}/cpu_ms"), ms));
        }
        figures
            .push(figure(format!("tracking of discovery/{statistic}/percent"), 100.0 * tracking / discovery));
    }
    figures.push(figure("update/frames_per_s".into(), 1e3 / mean_ms(&update)));
    Ok(figures)
}

fn median_ms(times: &[Duration]) -> f64 {
    let mut times = times.to_vec();
    times.sort_unstable();
    1e3 * times[times.len() / 2].as_secs_f64()
}

fn mean_ms(times: &[Duration]) -> f64 {
    1e3 * times.iter().sum::<Duration>().as_secs_f64() / times.len() as f64
}
