//! `objecthood doctor`: what an input is, and what of it may be wrong.

mod subject;

use std::fmt::Write;

use anyhow::Result;
use objecthood::{Camera, Discovery, Params, Pipeline};
use objecthood_io::Capture;
use objecthood_io::doctor::{Cause, Certainty, Examination, Facts, Finding, Mount, Report, Shift};
use serde_json::json;

use crate::args::{CameraArg, DoctorArgs};
use crate::failure::Outcome;
use crate::inputs::Input;
use crate::{advice, config, crew, inputs, interrupt, terminal};
use subject::Subject;

/// Frames that are looked at, spread over an input.
const MOST_FRAMES: usize = 8;

/// Looks at each input named on the command line and prints what it says of it.
///
/// # Errors
/// Of usage; when stdout cannot be written. What is wrong with the input is no error.
pub(crate) fn run(args: &DoctorArgs) -> Result<Outcome> {
    let params = config::params(&args.settings.parameters, None)?;
    let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
    let inputs = inputs::collect(&args.frames, true, camera.as_ref())?;
    inputs.notices.iter().for_each(|notice| terminal::note(notice));
    interrupt::catch()?;

    let subjects = Subject::all_of(&inputs, &args.frames.inputs);
    let total = subjects.iter().map(|subject| spread(&subject.frames).count()).sum();
    let bar = terminal::progress_bar(total, args.settings.verbose);
    let reports: Vec<(String, Report)> = crew::pool(args.settings.threads())?.install(|| {
        let mut pipeline = Pipeline::default();
        let going_on = subjects.iter().take_while(|_| !interrupt::is_asked());
        let report = |subject: &Subject<'_>| {
            (subject.title(), examine(subject, args, &params, &mut pipeline, || bar.inc(1)))
        };
        going_on.map(report).collect()
    });
    bar.finish_and_clear();

    terminal::print(&if args.printed.json {
        all_as_json(args, &reports)
    } else {
        all_as_text(args, &reports)
    })?;
    let is_sure = |finding: &Finding| finding.certainty == Certainty::Sure;
    let is_wrong = reports.iter().any(|(_, report)| report.findings.iter().any(is_sure));
    Ok(match (interrupt::is_asked(), is_wrong) {
        (true, _) => Outcome::Interrupted,
        (false, true) => Outcome::SomeFailed,
        (false, false) => Outcome::AllDone,
    })
}

/// What there is to say of one input; `tick` is called for each frame.
fn examine(
    subject: &Subject<'_>,
    args: &DoctorArgs,
    params: &Params,
    pipeline: &mut Pipeline,
    tick: impl Fn(),
) -> Report {
    let mut examination = Examination::default();
    subject.unreadable.iter().for_each(|error| examination.note(cannot_read(error)));
    for input in spread(&subject.frames).take_while(|_| !interrupt::is_asked()) {
        if let Err(error) = look(&mut examination, pipeline, args, params, input) {
            examination.note(cannot_read(&error));
        }
        tick();
    }
    let names: Vec<String> = subject.frames.iter().map(|input| input.name.display().to_string()).collect();
    let stamps: Vec<_> = subject.frames.iter().map(|input| input.stamp_ns()).collect();
    examination.report(&names, &stamps)
}

fn look(
    examination: &mut Examination,
    pipeline: &mut Pipeline,
    args: &DoctorArgs,
    params: &Params,
    input: &Input,
) -> Result<()> {
    let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
    let capture = args.frames.read(input, &scope)?;
    let found = pipeline.discover(&capture.frame, params)?;
    examination.look(&capture, found);
    Ok(())
}

/// At most [`MOST_FRAMES`], the first and the last among them.
fn spread<T>(frames: &[T]) -> impl Iterator<Item = &T> {
    let count = frames.len().min(MOST_FRAMES);
    let place = move |k: usize| if count < 2 { k } else { k * (frames.len() - 1) / (count - 1) };
    (0..count).map(move |k| &frames[place(k)])
}

fn cannot_read(error: &anyhow::Error) -> Finding {
    Finding::new(Certainty::Sure, Cause::Unreadable, format!("{error:#}{}", advice::of(error)))
}

/// The most likely doubt about a frame in which nothing was found, in words. `None` if there is none, or `told` has it already.
pub(crate) fn likely_doubt(capture: &Capture, found: &Discovery, told: &[String]) -> Option<String> {
    let mut examination = Examination::default();
    examination.look(capture, found);
    let finding = examination.report(&[], &[]).findings.into_iter().next()?;
    let is_told = told.iter().any(|notice| notice.contains(&finding.reason));
    (!is_told).then(|| format!("most likely, {} (`objecthood doctor` says more)", finding.reason))
}

/// Which option, or what else, mends it.
fn mend(args: &DoctorArgs, report: &Report, cause: Cause) -> Option<String> {
    let scale = args.frames.images.depth_scale.or(report.facts.as_ref().and_then(|facts| facts.depth_scale));
    let with_scale = |times: f64| match scale {
        Some(scale) => format!("--depth-scale {}", scale * times),
        None => format!("multiply the points by {}", 1.0 / times),
    };
    let text = match cause {
        Cause::TooFar(times) => with_scale(times),
        Cause::TooNear(times) => with_scale(1.0 / times),
        Cause::Camera(Some(Camera { fx_px, fy_px, cx_px, cy_px })) => {
            format!("--camera {fx_px:.2},{fy_px:.2},{cx_px:.2},{cy_px:.2}")
        }
        Cause::Camera(None) => {
            "--camera with the numbers of the camera at the size of these images".to_owned()
        }
        Cause::NotDepth => "--depth with images of depth in the unit that --depth-scale tells".to_owned(),
        Cause::EightBit => "save depth with 16 bits (OpenCV reads it with IMREAD_UNCHANGED only)".to_owned(),
        Cause::Constant => "check which file or topic holds the depth".to_owned(),
        Cause::Registration => {
            "register the depth to the colour in the program of the camera, or leave out --color".to_owned()
        }
        Cause::Distortion => "leave out --camera, or record rectified images".to_owned(),
        Cause::Turned => {
            "nothing if it is mounted so; else turn the images, or say --gravity X,Y,Z".to_owned()
        }
        Cause::Gravity => "--gravity with the direction in which things fall, or none".to_owned(),
        Cause::Sequence => "record again, or choose a part by --frames or --time".to_owned(),
        _ => return None,
    };
    Some(text)
}

/// An object for each input, one after the other.
fn all_as_json(args: &DoctorArgs, reports: &[(String, Report)]) -> String {
    reports.iter().map(|(input, report)| as_json(args, input, report)).collect()
}

fn as_json(args: &DoctorArgs, input: &str, report: &Report) -> String {
    let finding = |finding: &Finding| {
        json!({
            "certainty": finding.certainty,
            "cause": finding.cause.name(),
            "reason": finding.reason,
            "mend": mend(args, report, finding.cause),
            "frames": finding.frames,
        })
    };
    let findings: Vec<_> = report.findings.iter().map(finding).collect();
    format!("{:#}\n", json!({"input": input, "facts": report.facts, "findings": findings}))
}

/// Each input below its name, where there are several.
fn all_as_text(args: &DoctorArgs, reports: &[(String, Report)]) -> String {
    if let [(_, report)] = reports {
        return as_text(args, report);
    }
    let titled = |(input, report): &(String, Report)| format!("{input}\n{}", as_text(args, report));
    reports.iter().map(titled).collect::<Vec<_>>().join("\n")
}

fn as_text(args: &DoctorArgs, report: &Report) -> String {
    let mut text = report.facts.as_ref().map(facts_text).unwrap_or_default();
    for finding in &report.findings {
        let word = if finding.certainty == Certainty::Sure { "sure" } else { "suspect" };
        // Writing to a string cannot fail.
        let others = match (finding.cause, finding.frames) {
            (Cause::Unreadable, 2..) => format!("; so with {} more", finding.frames - 1),
            _ => String::new(),
        };
        let _ = writeln!(text, "{word}: {}{others}", finding.reason);
        if let Some(mend) = mend(args, report, finding.cause) {
            let _ = writeln!(text, "    mend: {mend}");
        }
    }
    if report.findings.is_empty() {
        text.push_str("nothing looks wrong\n");
    }
    text
}

fn facts_text(facts: &Facts) -> String {
    let [width, height] = facts.size_px;
    let [near, far] = facts.range_m;
    let [fx, fy, cx, cy] = facts.camera;
    let [across, down] = facts.field_of_view_deg;
    let rate = facts.rate_hz.map(|rate| format!(", {rate:.2} a second")).unwrap_or_default();
    let color = if facts.has_color { "colour and depth" } else { "depth" };
    let mut text = format!(
        "frames        {} ({} looked at){rate}\n\
         images        {width} x {height}, {color}\n\
         depth         {near:.2} to {far:.2} m, {:.0} % of the pixels, about {} bits\n\
         camera        fx {fx:.1} fy {fy:.1} cx {cx:.1} cy {cy:.1}: {across:.0} x {down:.0} degrees\n",
        facts.frames,
        facts.examined,
        100.0 * facts.valid_share,
        facts.depth_bits
    );
    let mut line = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            let _ = writeln!(text, "{name:<14}{value}");
        }
    };
    line("unit", facts.depth_scale.map(|scale| format!("{scale} a metre, as the input says")));
    line(
        "noise",
        facts.noise.map(|[white, waves]| {
            format!("{white:.2} times a Kinect's from pixel to pixel, {waves:.2} times in waves")
        }),
    );
    line("distortion", facts.distortion_px.map(|px| format!("{px:.1} px at most, as the input says")));
    line("registration", facts.registration.map(shift_text));
    line("mount", facts.mount.map(mount_text));
    let examined = facts.examined;
    let in_frames =
        |count: usize, what: &str| (count > 0).then(|| format!("{what} in {count} of {examined} frames"));
    line("ground", in_frames(facts.ground_in_doubt, "not sure which surface it is"));
    line("edges", in_frames(facts.smeared, "smeared over several pixels, and made steps again,"));
    line("holes", in_frames(facts.with_hole_grid, "a grid of small ones, which is bridged,"));
    text
}

fn shift_text(Shift { shift_px: [right, down], .. }: Shift) -> String {
    let told = |px: Option<i32>, [there, back]: [&str; 2]| match px {
        None => format!("{there} or {back} unknown"),
        Some(px) => format!("{} px {}", px.abs(), if px < 0 { back } else { there }),
    };
    let (right, down) = (told(right, ["right", "left"]), told(down, ["below", "above"]));
    format!("edges of the colour against those of the depth: {right}, {down}")
}

fn mount_text(Mount { height_m, tilt_deg, roll_deg }: Mount) -> String {
    format!(
        "{height_m:.2} m from the support plane, looks down by {:.0} degrees, rolled by {:.0}",
        whole(tilt_deg),
        whole(roll_deg)
    )
}

/// A whole number, without the sign of -0.
fn whole(number: f64) -> f64 {
    number.round() + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_over_the_input() {
        let places = |count: usize| spread(&(0..count).collect::<Vec<_>>()).copied().collect::<Vec<_>>();
        assert!(places(0).is_empty());
        assert_eq!(places(1), [0]);
        assert_eq!(places(3), [0, 1, 2]);
        assert_eq!(places(100), [0, 14, 28, 42, 56, 70, 84, 99]);
    }
}
