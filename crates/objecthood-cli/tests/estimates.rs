//! The noise of a real recording: handed on from frame to frame it scatters less than frame by frame.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

mod common;

use std::path::PathBuf;

use common::workspace;
use objecthood::{Estimates, Frame, Noise, Params, Pipeline};
use objecthood_io::{Given, Source};

/// The noise of every frame of a folder, each looked at alone, and each after those before it.
fn noises(folder: &str) -> Option<[Vec<Noise>; 2]> {
    let data =
        std::env::var_os("OBJECTHOOD_DATA").map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    let folder = data.join(folder);
    if !folder.is_dir() {
        println!("skipped: no {}", folder.display());
        return None;
    }
    let (mut pipeline, params) = (Pipeline::default(), Params::default());
    let mut look = |frame: &Frame| pipeline.discover(frame, &params).unwrap().estimates.unwrap();
    let mut earlier: Option<Estimates> = None;
    let [mut alone, mut handed_on] = [Vec::new(), Vec::new()];
    for frame in Source::open(&folder, &Given::default()).unwrap() {
        let frame = frame.unwrap().read().unwrap().frame;
        alone.push(look(&frame).noise);
        let estimates = look(&frame.with_estimates(earlier));
        handed_on.push(estimates.noise);
        earlier = Some(estimates);
    }
    Some([alone, handed_on])
}

/// Standard deviation over mean.
fn variation(numbers: &[f64]) -> f64 {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    (numbers.iter().map(|number| (number - mean).powi(2)).sum::<f64>() / count).sqrt() / mean
}

#[test]
fn the_noise_that_is_handed_on_scatters_less_than_that_of_single_frames() {
    for folder in ["video/hand-plush", "video/tum-fr1-rpy"] {
        let Some([alone, handed_on]) = noises(folder) else { continue };
        for k in 0..3 {
            let of =
                |noises: &[Noise]| variation(&noises.iter().map(|n| n.blocks_quanta[k]).collect::<Vec<_>>());
            let (alone, handed_on) = (of(&alone), of(&handed_on));
            println!("{folder}: variation of c({}): {alone:.3} alone, {handed_on:.3} handed on", 8 << k);
            assert!(handed_on < alone && (k == 2 || handed_on <= 0.10), "{folder} {k}: {alone} {handed_on}");
        }
    }
}
