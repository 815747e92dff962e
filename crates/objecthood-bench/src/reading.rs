//! What it costs to read frames, beside the method: the same frames stored as clouds, as pairs of images and as a recording.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use objecthood::{Camera, Frame, Params, Pipeline};
use objecthood_io::output::frames::TumFolder;
use objecthood_io::output::mcap::{McapFile, frame_messages};
use objecthood_io::{Capture, Given, Source};
use rayon::ThreadPoolBuilder;

use crate::figure::{Figure, timed};

/// Between frames of the recording: 30 a second (ns).
const STEP_NS: usize = 33_333_333;

/// Times a frame of `context` on one thread, from files to labels, of frames in memory, and of reading alone: the clouds, and the same
/// frames in whole millimetres as PNG pairs and as raw images in an MCAP file. Those are written to `folder`.
///
/// # Errors
/// When a file cannot be read or written, or the method refuses a frame.
pub fn reading(clouds: &[PathBuf], folder: &Path) -> Result<Vec<Figure>> {
    let frames = captures(clouds).collect::<Result<Vec<_>>>()?;
    let camera = frames.first().context("no frames to read")?.frame.camera();
    let whole = frames.iter().map(|capture| in_millimetres(capture, camera)).collect::<Result<Vec<_>>>()?;
    let (images, recording) = (folder.join("tum"), folder.join("frames.mcap"));
    write(&whole, &images, &recording)?;
    let one = ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut figures = Vec::new();
    for (name, frames, paths) in [
        ("pcd", &frames, clouds),
        ("png", &whole, std::slice::from_ref(&images)),
        ("mcap", &whole, std::slice::from_ref(&recording)),
    ] {
        let mut pipeline = Pipeline::default();
        let mut look = |frame: &Frame| -> Result<()> {
            pipeline.forget();
            Ok(pipeline.discover(frame, &Params::default()).map(drop)?)
        };
        let mut from_files = || captures(paths).try_for_each(|capture| look(&capture?.frame));
        // Once without looking: caches are warm.
        one.install(&mut from_files)?;
        let (done, both) = timed(|| one.install(from_files));
        done?;
        let (done, alone) =
            timed(|| one.install(|| frames.iter().try_for_each(|capture| look(&capture.frame))));
        done?;
        let (done, read) =
            timed(|| one.install(|| captures(paths).try_for_each(|capture| capture.map(drop))));
        done?;
        for (what, spent) in [("both", both), ("alone", alone), ("read", read)] {
            let a_frame = spent.over(frames.len());
            figures.extend(a_frame.figures("all", &format!("reading/{name}/{what}")));
        }
    }
    Ok(figures)
}

fn captures(paths: &[PathBuf]) -> impl Iterator<Item = Result<Capture>> + Send {
    paths.iter().flat_map(|path| -> Box<dyn Iterator<Item = Result<Capture>> + Send> {
        match Source::open(path, &Given::default()) {
            Ok(source) => Box::new(source.captures().map(|capture| Ok(capture?))),
            Err(error) => Box::new(std::iter::once(Err(error.into()))),
        }
    })
}

/// The frame as most sensors give it. It has the camera of the first, as a folder and a recording have one.
fn in_millimetres(capture: &Capture, camera: Camera) -> Result<Capture> {
    let frame = &capture.frame;
    let depth_m = frame.depth_m().map(|&z| ((f64::from(z) * 1000.0).round() / 1000.0) as f32);
    Ok(Capture::new(Frame::new(depth_m, frame.color().cloned(), camera)?))
}

/// Writes the frames as images and as a recording.
fn write(frames: &[Capture], images: &Path, recording: &Path) -> Result<()> {
    let (mut images, mut recording) = (TumFolder::create(images)?, McapFile::create(recording)?);
    for (stamp_ns, capture) in (0..).step_by(STEP_NS).zip(frames) {
        images.add(stamp_ns, capture)?;
        recording.add(&frame_messages(stamp_ns, capture))?;
    }
    images.finish()?;
    Ok(recording.finish()?)
}
