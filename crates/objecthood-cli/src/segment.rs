//! `objecthood segment`: frames -> label images, scene files, panels, and what other programs read.

mod mailbox;
mod notes;
mod stream;
mod summary;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ffi::OsStr;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use objecthood::{Estimates, Object, Observer, Params, Pipeline};
use objecthood_io::output::bop::{self, ImageId};
use objecthood_io::scene::notices;
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, output};
use objecthood_page::{Page, Shown};
use objecthood_view::Recording;

use crate::args::{CameraArg, OutputKind, SegmentArgs};
use crate::failure::{Outcome, usage};
use crate::inputs::{Input, Inputs};
use crate::outputs::run::{self, Place, RunFiles, Share};
use crate::outputs::{Found, make_folder, make_folders_of, refuse_file, with_suffix};
use crate::record::{Earlier, Line, Record};
use crate::watch::{Laps, Watch};
use crate::words::counted;
use crate::{config, crew, doctor, inputs, terminal};
use notes::Notes;
use summary::Summary;

/// What to do; nothing is in doubt any more.
struct Plan<'a> {
    args: &'a SegmentArgs,
    out: &'a Path,
    inputs: Inputs,
    scope: Scope,
    params: Params,
    kinds: BTreeSet<OutputKind>,
    /// What decides the result of every frame, beside its files.
    settings: String,
}

/// A frame to be done.
struct Job<'a> {
    input: &'a Input,
    place: Place,
}

/// How a frame ended that did not fail.
enum Step {
    Done(Box<Done>),
    /// An earlier run did it and found so many objects.
    Before(usize),
}

/// A frame that is done.
struct Done {
    fingerprint: String,
    objects: Vec<Object>,
    notices: Vec<String>,
    files: Vec<PathBuf>,
    /// What it adds to the files of the run.
    share: Option<Share>,
}

/// Segments every frame named on the command line.
///
/// # Errors
/// Of usage; when the folder for the outputs cannot be made; when stdout cannot be written. A frame that fails is
/// reported, which is no error.
pub(crate) fn run(args: &SegmentArgs) -> Result<Outcome> {
    let Some(out) = &args.out else { return stream::run(args) };
    let plan = Plan::new(args, out)?;
    make_folder(out)?;

    let Inputs { frames, unreadable, notices, .. } = &plan.inputs;
    notices.iter().for_each(|notice| terminal::note(notice));
    unreadable.iter().for_each(terminal::error);
    let total = frames.len() + unreadable.len();

    let record =
        (total > 1 || args.resume).then(|| Record::open(out, &plan.settings, args.resume)).transpose()?;
    let (earlier, record) = record.unzip();
    let of_run = RunFiles::create(out, &plan.kinds, &plan.params)?;
    let summary = Summary::new(unreadable);
    let (is_single, notes) = (total == 1, Notes::default());
    let mut report =
        Report { plan: &plan, is_single, record, of_run, summary, notes, done_before: 0, added: Ok(()) };
    let bar = terminal::progress_bar(frames.len(), args.settings.verbose);
    let work = |pipeline: &mut Pipeline, job: &Job<'_>| plan.segment(pipeline, job, earlier.as_ref());
    let text = |job: &Job<'_>, step: Result<Step, &anyhow::Error>| report.frame(job.input, step);
    let reported = crew::report_in_order(&plan.jobs(), args.settings.threads(), &bar, work, text)?;
    let record = report.finish()?;
    let outcome = reported.sum_up("frames", unreadable.len())?;
    match (outcome, record) {
        (Outcome::Interrupted, Some(_)) => {
            terminal::note(if plan.kinds.iter().any(|kind| kind.is_of_run()) {
                "what is written is whole and ends here; to go on, give the frames that are left (--frames) and another --out"
            } else {
                "to go on, give the same command with --resume"
            });
        }
        (Outcome::AllDone | Outcome::SomeFailed, Some(record)) if !args.resume => record.remove()?,
        _ => {}
    }
    Ok(outcome)
}

/// Where everything goes that is to be said of frames, in their order.
struct Report<'a> {
    plan: &'a Plan<'a>,
    is_single: bool,
    record: Option<Record>,
    of_run: RunFiles,
    summary: Summary,
    notes: Notes,
    /// Frames that an earlier run has done.
    done_before: usize,
    /// Whether record and files of the run could be written so far.
    added: Result<()>,
}

impl Report<'_> {
    /// Takes note of how a frame ended; what is to be printed.
    fn frame(&mut self, input: &Input, step: Result<Step, &anyhow::Error>) -> String {
        self.summary.add(input, step.as_ref().map_err(|e| *e));
        if self.added.is_ok() {
            self.added = self.add(input, step.as_ref().map_err(|e| *e));
        }
        let done = match step {
            Ok(Step::Done(done)) => done,
            Ok(Step::Before(_)) => {
                self.done_before += 1;
                return String::new();
            }
            Err(_) => return String::new(),
        };
        for notice in &done.notices {
            self.notes.take(input, notice);
        }
        if self.is_single { in_full(input, &done) } else { in_short(input, &done) }
    }

    /// Adds a frame to record and files of the run.
    fn add(&mut self, input: &Input, step: Result<&Step, &anyhow::Error>) -> Result<()> {
        let source = input.path.to_string_lossy().into_owned();
        let line = match step {
            Ok(Step::Before(_)) => return Ok(()),
            Ok(Step::Done(done)) => {
                if let Some(share) = &done.share {
                    self.of_run.add(share)?;
                }
                let out = self.plan.out;
                let below =
                    |path: &PathBuf| path.strip_prefix(out).unwrap_or(path).to_string_lossy().into_owned();
                let (fingerprint, objects) = (Some(done.fingerprint.clone()), Some(done.objects.len()));
                Line {
                    source,
                    fingerprint,
                    objects,
                    files: done.files.iter().map(below).collect(),
                    error: None,
                }
            }
            Err(e) => {
                let error = Some(format!("{e:#}"));
                Line { source, fingerprint: None, objects: None, files: Vec::new(), error }
            }
        };
        self.record.as_mut().map_or(Ok(()), |record| record.add(&line))
    }

    /// Ends the files of the run, and names them. The record stays open.
    fn finish(self) -> Result<Option<Record>> {
        let Self { plan, record, of_run, summary, notes, done_before, added, .. } = self;
        notes.sum_up();
        if done_before > 0 {
            terminal::note(&format!("done before: {}", counted(done_before, "frame")));
        }
        added?;
        let mut paths = of_run.finish()?;
        if plan.args.summary {
            paths.push(summary.write(plan.out, plan)?);
        }
        terminal::print(&paths.iter().map(|path| format!("{}\n", path.display())).collect::<String>())?;
        Ok(record)
    }
}

impl<'a> Plan<'a> {
    fn new(args: &'a SegmentArgs, out: &'a Path) -> Result<Self> {
        let params = config::params(&args.settings.parameters, args.method)?;
        let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
        args.frames.scale_note(camera.as_ref()).iter().for_each(|note| terminal::note(note));
        let inputs = inputs::collect(&args.frames, args.keep_tree, camera.as_ref())?;
        let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
        refuse_file("--out", out)?;
        let of_report = args.report.then_some(OutputKind::Report);
        let kinds: BTreeSet<OutputKind> = args.write.iter().copied().chain(of_report).collect();
        if let (true, Some(kind)) = (args.resume, kinds.iter().find(|kind| kind.is_of_run())) {
            return Err(usage(format!(
                "--resume skips frames, but {} needs every frame: leave one of them out",
                kind.option()
            )));
        }
        let settings = format!("{} {kinds:?}", args.frames.in_words(&params, camera.as_ref())?);
        let plan = Self { args, out, inputs, scope, params, kinds, settings };
        plan.refuse_replacing_what_is_read()?;
        Ok(plan)
    }

    /// The frames in their order.
    fn jobs<'j>(&'j self) -> Vec<Job<'j>> {
        let frames = &self.inputs.frames;
        let ids = ImageId::of_frames(frames.iter().map(|input| (input.path.as_path(), input.name.as_path())));
        let job = |(number, (input, id)): (usize, (&'j Input, ImageId))| {
            // The colour image comes first.
            let image = input.files().next().and_then(Path::file_name).unwrap_or(input.name.as_os_str());
            let image_name = input.name.with_file_name(image).to_string_lossy().into_owned();
            Job { input, place: Place { number, id, image_name } }
        };
        frames.iter().zip(ids).enumerate().map(job).collect()
    }

    /// Finds the objects in one frame and writes its files, all of them or none, unless an earlier run has done so.
    fn segment(&self, pipeline: &mut Pipeline, job: &Job<'_>, earlier: Option<&Earlier>) -> Result<Step> {
        let input = job.input;
        let fingerprint = input.fingerprint(&self.settings, &self.inputs.cameras)?;
        if let Some(objects) = earlier.and_then(|earlier| earlier.objects_of(&fingerprint)) {
            return Ok(Step::Before(objects));
        }
        let mut laps = Laps::start();
        let capture = self.args.frames.read(input, &self.scope)?;
        laps.end("reading");
        let done = self.look_and_write(pipeline, job, &capture, &mut laps);
        tracing::info!("{}: {laps}", input.path.display());
        let done = done.with_context(|| input.path.display().to_string())?;
        Ok(Step::Done(Box::new(Done { fingerprint, ..done })))
    }

    fn look_and_write(
        &self,
        pipeline: &mut Pipeline,
        Job { input, place }: &Job<'_>,
        capture: &Capture,
        laps: &mut Laps,
    ) -> Result<Done> {
        let mut recording = self.kinds.contains(&OutputKind::Panels).then(Recording::default);
        let mut none = ();
        let next = recording.as_mut().map_or(&mut none as &mut dyn Observer, |recording| recording);
        let mut watch = Watch { laps, next };
        let discovery = pipeline.discover_observed(&capture.frame, &self.params, &mut watch)?;
        if let Some(Estimates { noise, .. }) = discovery.estimates {
            let (path, white, waves) = (input.path.display(), noise.white, noise.waves());
            tracing::info!(
                "{path}: noise of the sensor: {white:.2} times a Kinect's, its waves {waves:.2} times"
            );
        }

        let found = Found {
            source: &input.path.display().to_string(),
            capture,
            params: &self.params,
            discovery,
            recording: recording.as_ref(),
        };
        let mut files = found.files(&self.kinds, &self.out.join(&input.name))?;
        let mut share = Share::of(&self.kinds, place, capture, discovery);
        if let (Some(share), true) = (&share, self.kinds.contains(&OutputKind::Bop)) {
            files.extend(bop::masks(&self.out.join(run::BOP), place.id, &discovery.labels, share.found())?);
        }
        laps.end("encoding");
        make_folders_of(&files)?;
        output::write_together(&files)?;
        laps.end("writing");
        let files = files.into_iter().map(|(path, _)| path).collect();
        let mut notices = notices(capture, discovery);
        if discovery.objects.is_empty() || discovery.structure_planes.is_empty() {
            notices.extend(doctor::likely_doubt(capture, discovery, &notices));
        }
        let objects = discovery.objects.clone();
        if let (Some(share), true) = (&mut share, self.args.report) {
            let shown = Shown {
                name: &input.path.display().to_string(),
                capture,
                number: place.number,
                frames: self.inputs.frames.len(),
                laps: Some(&laps.ended_ms()),
                followed: None,
            };
            share.page = Some(Page::new(pipeline, &self.params, &shown)?);
        }
        Ok(Done { fingerprint: String::new(), notices, objects, files, share })
    }

    /// Refuses to write over files that are read: the scene file of `camera-depth.png` would be `camera.json`.
    fn refuse_replacing_what_is_read(&self) -> Result<()> {
        let Inputs { frames, cameras, .. } = &self.inputs;
        let stem = |input: &Input| self.out.join(&input.name);
        let of_frame =
            |input| self.kinds.iter().filter_map(move |kind| Some(with_suffix(&stem(input), kind.suffix()?)));
        let of_run = self.kinds.iter().filter_map(|&kind| run::path_of(self.out, kind));
        // Folders are listed once: a new one has nothing, and then a million frames need not be looked up.
        let mut listed = Listed::default();
        let there = |path: PathBuf| {
            listed.has(&path).then(|| fs::canonicalize(&path).ok()).flatten().map(|real| (real, path))
        };
        let written: BTreeMap<PathBuf, PathBuf> =
            frames.iter().flat_map(of_frame).chain(of_run).filter_map(there).collect();
        if written.is_empty() {
            return Ok(());
        }
        let camera = self.args.frames.camera.as_ref().and_then(CameraArg::file);
        let given = [camera, self.args.frames.scope.mask(), self.args.settings.parameters.config.as_deref()];
        let beside = cameras.iter().map(PathBuf::as_path).chain(given.into_iter().flatten());
        let mut read = frames.iter().flat_map(Input::files).chain(beside);
        match read.find_map(|path| written.get(&fs::canonicalize(path).ok()?)) {
            Some(path) => Err(usage(format!(
                "{} is read, so it cannot be written too: choose another --out",
                path.display()
            ))),
            None => Ok(()),
        }
    }
}

/// The names in folders, in small letters: some file systems take them for equal.
#[derive(Default)]
struct Listed(HashMap<PathBuf, HashSet<String>>);

impl Listed {
    /// Whether a folder may have this path; not if it cannot be listed.
    fn has(&mut self, path: &Path) -> bool {
        let small = |name: &OsStr| name.to_string_lossy().to_lowercase();
        let (Some(folder), Some(name)) = (path.parent(), path.file_name()) else { return false };
        if !self.0.contains_key(folder) {
            let names = fs::read_dir(folder).into_iter().flatten().flatten();
            self.0.insert(folder.to_owned(), names.map(|entry| small(&entry.file_name())).collect());
        }
        self.0.get(folder).is_some_and(|names| names.contains(&small(name)))
    }
}

/// The text for a single frame: a table of its objects, and the files.
fn in_full(input: &Input, done: &Done) -> String {
    let mut text = format!("{}: {}\n", input.path.display(), counted(done.objects.len(), "object"));
    if !done.objects.is_empty() {
        text.push_str("  id  objectness  pixels  size [m]            centre [m]\n");
    }
    for object in &done.objects {
        let [sx, sy, sz] = object.box_m.extents_m;
        let [cx, cy, cz] = object.box_m.center_m;
        let (id, objectness, pixels) = (object.id.0, object.objectness, object.size_px);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{id:>4}  {objectness:>10.2}  {pixels:>6}  {sx:.2} x {sy:.2} x {sz:.2}  {cx:>6.2} {cy:>6.2} {cz:>6.2}"
        );
    }
    for file in &done.files {
        let _ = writeln!(text, "{}", file.display());
    }
    text
}

/// The text for one frame of many: one line.
fn in_short(input: &Input, done: &Done) -> String {
    let files: Vec<String> = done.files.iter().map(|f| f.display().to_string()).collect();
    format!("{}: {} -> {}\n", input.path.display(), counted(done.objects.len(), "object"), files.join(" "))
}
