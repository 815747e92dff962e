//! `objecthood segment - --format frames`: each frame that comes by stdin is answered by a line on stdout.

use std::io;
use std::path::Path;

use anyhow::Result;
use objecthood::{Camera, Estimates, Frame, Params, Pipeline};
use objecthood_io::Given;
use objecthood_io::pipe::{Answer, Header, LabelRun, label_runs};
use objecthood_io::scene::SceneFile;
use objecthood_io::scope::Scope;

use super::mailbox::{Mailbox, Taken};
use crate::args::{CameraArg, SegmentArgs};
use crate::failure::{Outcome, usage};
use crate::inputs::STDIN;
use crate::watch::{Laps, Watch};
use crate::{advice, config, crew, interrupt, terminal};

/// What holds for all frames.
struct Plan<'a> {
    args: &'a SegmentArgs,
    params: Params,
    given: Given,
    scope: Scope,
}

/// What frames of one camera have told of its sensor and of gravity.
#[derive(Default)]
struct Earlier(Option<(Camera, (usize, usize), Estimates)>);

impl Earlier {
    /// What it tells of a frame: nothing, if that is of another camera.
    fn estimates(&self, frame: &Frame) -> Option<Estimates> {
        let (camera, size, estimates) = self.0?;
        (camera == frame.camera() && size == frame.size()).then_some(estimates)
    }

    /// After one more frame, which had what was told before it.
    fn after(frame: &Frame, estimates: Option<Estimates>) -> Self {
        Self(estimates.map(|estimates| (frame.camera(), frame.size(), estimates)))
    }
}

/// Answers the frames of stdin until it ends, nobody reads the answers, or Ctrl-C is pressed.
///
/// # Errors
/// Of usage; when stdin or stdout fails. A frame that fails is answered so, which is no error.
pub(super) fn run(args: &SegmentArgs) -> Result<Outcome> {
    if args.frames.inputs != [Path::new(STDIN)] {
        return Err(usage("--format is for frames that come by stdin: name - as the only input"));
    }
    let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
    let plan = Plan {
        args,
        params: config::params(&args.settings.parameters, args.method)?,
        given: args.frames.given(camera.as_ref()),
        scope: args.frames.scope.read(args.frames.images.max_pixels)?,
    };
    let pool = crew::pool(args.settings.threads())?;
    interrupt::catch()?;

    let mailbox = Mailbox::open(io::stdin(), plan.given.max_pixels, args.stream.latest)?;
    let (mut pipeline, mut earlier) = (Pipeline::default(), Earlier::default());
    let (mut done, mut failed) = (0, 0);
    while let Some(taken) = mailbox.take() {
        let answer = pool.install(|| plan.answer(&mut pipeline, &mut earlier, &taken));
        let count = if answer.error.is_none() { &mut done } else { &mut failed };
        *count += 1;
        if !terminal::print_to_reader(&answer.to_line()?)? {
            break;
        }
    }
    let (arrived, dropped, end) = mailbox.close();
    let parts = [(failed, "failed"), (dropped, "dropped because a newer one was there")];
    let parts = parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!(", {count} {what}"));
    terminal::complain(&format!("{done} of {arrived} frames done{}", parts.collect::<String>()));
    end?;
    Ok(match (interrupt::is_asked(), failed) {
        (true, _) => Outcome::Interrupted,
        (false, 0) => Outcome::AllDone,
        (false, _) => Outcome::SomeFailed,
    })
}

impl Plan<'_> {
    /// What is said of a frame, also when it fails.
    fn answer(&self, pipeline: &mut Pipeline, earlier: &mut Earlier, taken: &Taken) -> Answer {
        let &Taken { number, dropped, .. } = taken;
        let mut answer =
            Answer { number, name: None, stamp_ns: None, dropped, scene: None, labels: None, error: None };
        let header = taken.frame.header().map_err(|error| objecthood_io::Error::from(error).into());
        let found = header.and_then(|header| {
            answer.name.clone_from(&header.name);
            answer.stamp_ns = header.stamp_ns;
            self.look(pipeline, earlier, taken, &header)
        });
        match found {
            Ok((scene, labels)) => (answer.scene, answer.labels) = (Some(scene), Some(labels)),
            Err(error) => {
                let text = format!("{error:#}{}", advice::of(&error));
                terminal::complain(&format!("error: frame {number}: {text}"));
                answer.error = Some(text);
            }
        }
        answer
    }

    /// What is found in a frame.
    fn look(
        &self,
        pipeline: &mut Pipeline,
        earlier: &mut Earlier,
        Taken { number, frame, .. }: &Taken,
        header: &Header,
    ) -> Result<(SceneFile, Vec<LabelRun>)> {
        let mut laps = Laps::start();
        let mut capture = self.args.frames.tell(frame.capture(header, &self.given)?, &self.scope)?;
        let estimates = earlier.estimates(&capture.frame);
        capture.frame = capture.frame.with_estimates(estimates);
        laps.end("reading");
        let mut watch = Watch { laps: &mut laps, next: &mut () };
        let discovery = pipeline.discover_observed(&capture.frame, &self.params, &mut watch)?;
        *earlier = Earlier::after(&capture.frame, discovery.estimates.or(estimates));
        let name = header.name.clone().unwrap_or_else(|| number.to_string());
        tracing::info!("{name}: {laps}");
        Ok((SceneFile::new(&name, &capture, &self.params, discovery), label_runs(&discovery.labels)))
    }
}
