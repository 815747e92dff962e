//! `objecthood info`: what is in an input.

use std::fmt::Write;

use anyhow::Result;
use objecthood::Camera;
use objecthood_io::{Capture, Topic};
use serde_json::json;

use crate::args::{CameraArg, InfoArgs};
use crate::failure::Outcome;
use crate::inputs::{Input, Inputs};
use crate::{inputs, terminal};

/// Lists the frames named on the command line and reads the first of them.
///
/// # Errors
/// Of usage; when the first frame cannot be read; when stdout cannot be written.
pub(crate) fn run(args: &InfoArgs) -> Result<Outcome> {
    let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
    let Inputs { frames, unreadable, notices, topics, .. } =
        inputs::collect(&args.frames, true, camera.as_ref())?;
    notices.iter().for_each(|notice| terminal::note(notice));
    unreadable.iter().for_each(terminal::error);
    let Some(first) = frames.first() else { return Ok(Outcome::SomeFailed) };
    let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
    let capture = args.frames.read(first, &scope)?;
    terminal::print(&if args.printed.json {
        as_json(&frames, &capture, &topics)
    } else {
        as_text(&frames, &capture, &topics)
    })?;
    Ok(if unreadable.is_empty() { Outcome::AllDone } else { Outcome::SomeFailed })
}

/// When the first and the last frame were measured (ns), if both say it.
fn stamps_ns(frames: &[Input], first: &Capture) -> Option<[i64; 2]> {
    let last = frames.last().and_then(Input::stamp_ns);
    Some([first.stamp_ns?, last.or(first.stamp_ns)?])
}

/// Where the camera comes from.
fn source_of_camera(capture: &Capture) -> &'static str {
    match (&capture.list, &capture.camera_fit, capture.said.camera) {
        (Some(list), ..) if list.is_virtual => "virtual",
        (_, Some(_), _) => "fitted to the points",
        (_, _, Some(said)) if said.camera == capture.frame.camera() => "said by the input",
        _ => "given",
    }
}

fn as_json(frames: &[Input], first: &Capture, topics: &[Topic]) -> String {
    let (width, height) = first.frame.size();
    let Camera { fx_px, fy_px, cx_px, cy_px } = first.frame.camera();
    let names = frames.iter().map(|input| input.name.display().to_string());
    let topics = topics
        .iter()
        .map(|Topic { name, kind, messages }| json!({"name": name, "type": kind, "messages": messages}));
    let value = json!({
        "frames": frames.len(),
        "names": names.collect::<Vec<_>>(),
        "stamps_ns": stamps_ns(frames, first),
        "size_px": [width, height],
        "has_color": first.frame.color().is_some(),
        "camera": [fx_px, fy_px, cx_px, cy_px],
        "camera_source": source_of_camera(first),
        "depth_scale": first.said.depth_scale,
        "has_poses": first.pose.is_some(),
        "has_truth": first.truth.is_some(),
        "points": first.list.as_ref().map(|list| list.points_m.len()),
        "topics": topics.collect::<Vec<_>>(),
    });
    format!("{value:#}\n")
}

fn as_text(frames: &[Input], first: &Capture, topics: &[Topic]) -> String {
    let (width, height) = first.frame.size();
    let Camera { fx_px, fy_px, cx_px, cy_px } = first.frame.camera();
    let name =
        |input: Option<&Input>| input.map(|input| input.name.display().to_string()).unwrap_or_default();
    let color = if first.frame.color().is_some() { "colour and depth" } else { "depth" };
    let mut text = format!(
        "frames   {}, {} to {}\nimages   {width} x {height}, {color}\ncamera   {fx_px:.2},{fy_px:.2},{cx_px:.2},{cy_px:.2} ({})\n",
        frames.len(),
        name(frames.first()),
        name(frames.last()),
        source_of_camera(first)
    );
    // Writing to a string cannot fail.
    if let Some([from, to]) = stamps_ns(frames, first) {
        let (from_s, to_s) = (from as f64 / 1e9, to as f64 / 1e9);
        let _ = writeln!(text, "stamps   {from_s:.3} to {to_s:.3} s: {:.3} s", to_s - from_s);
    }
    if let Some(scale) = first.said.depth_scale {
        let _ = writeln!(text, "unit     {scale} a metre");
    }
    let has = [("poses", first.pose.is_some()), ("truth", first.truth.is_some())];
    let has: Vec<_> = has.into_iter().filter_map(|(what, is_there)| is_there.then_some(what)).collect();
    if !has.is_empty() {
        let _ = writeln!(text, "beside   {}", has.join(", "));
    }
    if let Some(list) = &first.list {
        let _ = writeln!(text, "points   {} without pixels", list.points_m.len());
    }
    for (k, Topic { name, kind, messages }) in topics.iter().enumerate() {
        let _ =
            writeln!(text, "{}{messages:>6}  {name}  {kind}", if k == 0 { "topics   " } else { "         " });
    }
    text
}
