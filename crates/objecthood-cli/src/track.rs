//! `objecthood track`: the frames of a video -> numbers of objects that last, what happened, what stands on what.

mod cast;
mod files;
mod progress;
mod report;
mod silence;
mod smooth;
mod summary;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use objecthood::{Params, Raster};
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, label_image, output};
use objecthood_track::{Event, Hindsight, Rigid, Tracked, Tracker};
use objecthood_view::Mark;

use crate::args::{CameraArg, TrackArgs};
use crate::failure::Outcome;
use crate::inputs::{Input, Inputs};
use crate::outputs::{make_folder, make_folders_of, refuse_file};
use crate::words::counted;
use crate::{advice, config, crew, inputs, interrupt, terminal};
use cast::Cast;
use files::Lines;
use progress::Going;
use report::Filming;
use silence::Silence;

/// With `--resume` what is known is kept this often: a run that is killed loses no more.
const KEPT_EVERY: Duration = Duration::from_secs(30);

/// What to do; nothing is in doubt any more.
struct Plan<'a> {
    args: &'a TrackArgs,
    inputs: Inputs,
    scope: Scope,
    params: Params,
    /// What decides the result beside the files.
    settings: String,
}

/// What is told at the end.
#[derive(Default)]
struct Told {
    cast: Cast,
    events: Vec<Event>,
    done: usize,
    failed: usize,
    last_stamp_s: Option<f64>,
    /// Columns and rows of the last frame.
    last_size: Option<(usize, usize)>,
    /// With `--smooth`.
    hindsight: Option<Hindsight>,
}

/// Follows the objects of the frames named on the command line.
///
/// # Errors
/// Of usage; when the outputs cannot be written; when stdout cannot be written. A frame that cannot be read is reported, which is
/// no error.
pub(crate) fn run(args: &TrackArgs) -> Result<Outcome> {
    let plan = Plan::new(args)?;
    make_folder(&args.out)?;
    let Inputs { frames, unreadable, notices, .. } = &plan.inputs;
    notices.iter().for_each(|notice| terminal::note(notice));
    unreadable.iter().for_each(terminal::error);
    let fingerprints = plan.fingerprints();
    let Going { mut tracker, mut told, mut lines, done } = plan.go_on(&fingerprints)?;
    if done == frames.len() && done > 0 && told.failed == 0 && unreadable.is_empty() {
        told.events.extend(tracker.finish());
        return plan.sum_up(&told, done, ", followed before");
    }
    interrupt::catch()?;

    let begin = || Filming::begin(&args.out.join("report.html"), &plan.params, frames.len());
    let mut filming = args.report.then(begin).transpose()?;
    let bar = terminal::progress_bar(frames.len(), args.settings.verbose);
    told.failed += unreadable.len();
    bar.inc(done as u64);
    told.hindsight = args.smooth.then(Hindsight::default);
    let mut kept = Instant::now();
    let pool = crew::pool(args.settings.threads())?;
    pool.install(|| -> Result<()> {
        for (k, input) in frames.iter().enumerate().skip(done).take_while(|_| !interrupt::is_asked()) {
            match plan.follow(&mut tracker, input, k, &mut told, &mut lines, filming.as_mut()) {
                Ok(()) => told.done += 1,
                Err(e) => {
                    told.failed += 1;
                    bar.suspend(|| terminal::error(&e));
                }
            }
            lines.check()?;
            bar.inc(1);
            if args.resume && kept.elapsed() > KEPT_EVERY {
                plan.keep(&tracker, &told, &mut lines, unreadable.len(), &fingerprints)?;
                kept = Instant::now();
            }
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    // Taken before the end of the video makes late events certain. Written after the lists that hold them.
    let state = args
        .resume
        .then(|| plan.state(&tracker, &told, &lines, unreadable.len(), &fingerprints))
        .transpose()?;
    let late = tracker.finish();
    late.iter().for_each(|event| lines.event(event));
    filming.map(|filming| filming.finish(&late)).transpose()?;
    if let Some(mut hindsight) = told.hindsight.take() {
        hindsight.learn_events(&late);
        plan.smooth(&mut told, &mut lines, hindsight)?;
    }
    told.events.extend(late);
    lines.finish()?;
    state.map(|files| output::write_together(&files)).transpose()?;
    let outcome = plan.sum_up(&told, frames.len() + unreadable.len(), "")?;
    if outcome == Outcome::Interrupted {
        let next = if args.resume { "goes on from here" } else { "follows the video from its beginning" };
        terminal::note(&format!("what is written is whole and ends here; the same command {next}"));
    }
    Ok(outcome)
}

impl<'a> Plan<'a> {
    fn new(args: &'a TrackArgs) -> Result<Self> {
        let params = config::params(&args.settings.parameters, args.method)?;
        let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
        args.frames.scale_note(camera.as_ref()).iter().for_each(|note| terminal::note(note));
        let inputs = inputs::collect(&args.frames, false, camera.as_ref())?;
        let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
        refuse_file("--out", &args.out)?;
        let settings = args.frames.in_words(&params, camera.as_ref())?;
        let settings = format!("{settings} {} {} {:?} {:?}", args.fps, args.poses, args.write, args.without);
        Ok(Self { args, inputs, scope, params, settings })
    }

    /// Follows the objects into a frame and writes its images.
    fn follow(
        &self,
        tracker: &mut Tracker,
        input: &Input,
        number: usize,
        told: &mut Told,
        lines: &mut Lines,
        filming: Option<&mut Filming>,
    ) -> Result<()> {
        let (capture, tracked) = match self.track(tracker, input, number, told.last_stamp_s) {
            Ok(found) => found,
            Err(e) => {
                tracker.skip();
                return self.pass_over(input, number, told.last_size, lines, e);
            }
        };
        (told.last_stamp_s, told.last_size) = (Some(tracked.stamp_s), Some(tracked.labels.size()));
        for notice in &tracked.notices {
            terminal::note(&format!("{}: {notice}", input.path.display()));
        }
        let mut files = Vec::new();
        if self.args.write.is_some() {
            let events = told.events.iter().chain(&tracked.events);
            let marks: Vec<Mark> =
                events.map(|event| Mark { time_s: event.time, text: summary::short(event) }).collect();
            let agents: Vec<_> = tracked.agents.iter().map(|agent| (agent.id.0, agent.box_px)).collect();
            let (labels, now_s) = (&tracked.labels, tracked.stamp_s);
            let picture = objecthood_view::filmed(&capture.frame, labels, &agents, now_s, &marks);
            files.push((self.picture(&input.name), objecthood_view::png(&picture)?));
        }
        self.write_labels(number, &tracked.labels, files)?;
        if let Some(filming) = filming {
            filming.frame(number, &input.title(), &self.params, &capture, &tracked)?;
        }
        lines.frame(&tracked);
        told.cast.see(&tracked);
        if let Some(hindsight) = &mut told.hindsight {
            hindsight.learn(&tracked);
        }
        told.events.extend(tracked.events);
        Ok(())
    }

    /// Writes an empty label image of a frame of which nothing can be said, and a line for it.
    ///
    /// # Errors
    /// `error`, when the frame failed; when an output cannot be written.
    fn pass_over(
        &self,
        input: &Input,
        number: usize,
        last_size: Option<(usize, usize)>,
        lines: &mut Lines,
        error: anyhow::Error,
    ) -> Result<()> {
        let Some(Silence { why, time_s, size }) = Silence::of(&error, input) else { return Err(error) };
        // The size of the last frame first: a list of points without depth has no image.
        let Some((width, height)) = last_size.or(size) else { return Err(error) };
        let (path, advice) = (input.path.display(), advice::of(&error));
        terminal::note(&format!("{path}: nothing is said of this frame: {why}{advice}"));
        self.write_labels(number, &Raster::filled(width, height, 0)?, Vec::new())?;
        lines.blank(number, time_s);
        Ok(())
    }

    /// Reads a frame and follows the objects into it.
    fn track(
        &self,
        tracker: &mut Tracker,
        input: &Input,
        number: usize,
        last_stamp_s: Option<f64>,
    ) -> Result<(Capture, Tracked)> {
        let capture = self.args.frames.read(input, &self.scope)?;
        let stamp_s = capture.stamp_s(number, last_stamp_s, self.args.fps);
        let pose = pose_of(&capture).filter(|_| self.args.poses);
        let tracked = tracker.update(&capture.frame, stamp_s, pose);
        let tracked = tracked.with_context(|| input.path.display().to_string())?;
        Ok((capture, tracked))
    }

    /// Where the label image of a frame is.
    fn label_image(&self, name: &Path) -> PathBuf {
        with_png(self.args.out.join("labels").join(name))
    }

    /// Where the picture of a frame is, with `--write pictures`.
    fn picture(&self, name: &Path) -> PathBuf {
        with_png(self.args.out.join("pictures").join(name))
    }

    /// Writes the label image of a frame together with other files of it.
    fn write_labels(
        &self,
        number: usize,
        labels: &Raster<u16>,
        mut files: Vec<(PathBuf, Vec<u8>)>,
    ) -> Result<()> {
        files.push((self.label_image(&self.inputs.frames[number].name), label_image::encode(labels)?));
        make_folders_of(&files)?;
        Ok(output::write_together(&files)?)
    }

    /// Tells what was found, then `ending`; how the run ends.
    fn sum_up(&self, told: &Told, total: usize, ending: &str) -> Result<Outcome> {
        let is_interrupted = told.done + told.failed < total;
        let count = told.cast.count();
        let mut text = format!(
            "{}, {}, {}{ending} -> {}\n",
            counted(told.done, "frame"),
            counted(count.objects(), "object"),
            counted(told.events.len(), "event"),
            self.args.out.display()
        );
        if self.args.summary && told.done > 0 {
            text.push_str(&summary::of(&told.events, count));
        }
        terminal::print(&text)?;
        if told.failed > 0 {
            terminal::complain(&format!("{} of {total} frames failed", told.failed));
        }
        Ok(match (is_interrupted, told.failed) {
            (true, _) => Outcome::Interrupted,
            (false, 0) => Outcome::AllDone,
            (false, _) => Outcome::SomeFailed,
        })
    }
}

fn pose_of(capture: &Capture) -> Option<Rigid> {
    let pose = capture.pose?;
    Rigid::new(pose.rotation_xyzw, pose.position_m)
}

/// A path with `.png` at its end, whatever dots the name has.
fn with_png(path: PathBuf) -> PathBuf {
    let mut name = path.into_os_string();
    name.push(".png");
    PathBuf::from(name)
}
