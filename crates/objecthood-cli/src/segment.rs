//! `objecthood segment`: frames -> label images, scene files, panels.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow};
use objecthood::{Discovery, Object, Observer, Params};
use objecthood_io::scene::{SceneFile, notices};
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, images, label_image, output};
use objecthood_view::{Recording, panels, png};

use crate::args::{CameraArg, OutputKind, SegmentArgs};
use crate::failure::{Outcome, usage};
use crate::inputs::{Input, Inputs};
use crate::watch::{Laps, Watch};
use crate::{config, crew, inputs, terminal};

/// What is to be done, and nothing left to doubt.
struct Plan<'a> {
    args: &'a SegmentArgs,
    inputs: Inputs,
    scope: Scope,
    params: Params,
    kinds: BTreeSet<OutputKind>,
}

/// A frame that is done.
struct Done {
    objects: Vec<Object>,
    notices: Vec<String>,
    files: Vec<PathBuf>,
}

/// Segments every frame named on the command line.
///
/// # Errors
/// Of usage; when the folder for the outputs cannot be made; when stdout cannot be written. A frame that fails is
/// reported, which is no error.
pub(crate) fn run(args: &SegmentArgs) -> Result<Outcome> {
    let plan = Plan::new(args)?;
    make_folder(&args.out)?;

    let Inputs { frames, unreadable, notices } = &plan.inputs;
    notices.iter().for_each(|notice| terminal::complain(&format!("note: {notice}")));
    unreadable.iter().for_each(terminal::error);
    let total = frames.len() + unreadable.len();
    let mut failed = unreadable.len();

    let bar = terminal::progress_bar(frames.len(), args.settings.verbose);
    let mut printed = Ok(());
    crew::in_order(
        frames,
        args.settings.threads(),
        |input| plan.segment(input),
        |input, result| {
            bar.suspend(|| match result {
                Ok(done) => {
                    for notice in &done.notices {
                        terminal::complain(&format!("note: {}: {notice}", input.path.display()));
                    }
                    let text = if total == 1 { in_full(input, &done) } else { in_short(input, &done) };
                    if printed.is_ok() {
                        printed = terminal::print(&text);
                    }
                }
                Err(e) => {
                    failed += 1;
                    terminal::error(&e);
                }
            });
            bar.inc(1);
        },
    )?;
    bar.finish_and_clear();

    if total > 1 || failed > 0 {
        let sum = if failed == 0 { String::new() } else { format!(", {failed} failed") };
        terminal::complain(&format!("{} of {total} frames done{sum}", total - failed));
    }
    printed?;
    Ok(if failed == 0 { Outcome::AllDone } else { Outcome::SomeFailed })
}

impl<'a> Plan<'a> {
    fn new(args: &'a SegmentArgs) -> Result<Self> {
        let params = config::params(&args.settings, args.method)?;
        let camera = args.camera.as_ref().map(CameraArg::read).transpose()?;
        let inputs = inputs::collect(args, camera.as_ref())?;
        let scope = args.scope.read(args.images.max_pixels)?;
        if args.out.exists() && !args.out.is_dir() {
            return Err(usage(format!("--out {} is a file: name a folder", args.out.display())));
        }
        Ok(Self { args, inputs, scope, params, kinds: args.write.iter().copied().collect() })
    }

    /// Finds the objects in one frame and writes what was asked for: all of it or nothing.
    fn segment(&self, input: &Input) -> Result<Done> {
        let mut laps = Laps::start();
        let capture = self.read(input)?;
        laps.end("reading");
        let done = self.look_and_write(input, &capture, &mut laps);
        tracing::info!("{}: {laps}", input.path.display());
        done.with_context(|| input.path.display().to_string())
    }

    /// What of a frame is to be looked at.
    fn read(&self, input: &Input) -> Result<Capture> {
        let capture = input.open()?;
        images::check_pixels(capture.frame.size(), self.args.images.max_pixels)
            .map_err(objecthood_io::Error::from)
            .and_then(|()| self.scope.limit(capture))
            .with_context(|| input.path.display().to_string())
    }

    fn look_and_write(&self, input: &Input, capture: &Capture, laps: &mut Laps) -> Result<Done> {
        let mut recording = self.kinds.contains(&OutputKind::Panels).then(Recording::default);
        let mut nobody = ();
        let next = recording.as_mut().map_or(&mut nobody as &mut dyn Observer, |recording| recording);
        let mut watch = Watch { laps, next };
        let discovery = objecthood::discover_observed(&capture.frame, &self.params, &mut watch)?;

        let files = self.encode(input, capture, &discovery, recording.as_ref())?;
        laps.end("encoding");
        for (path, _) in &files {
            path.parent().map_or(Ok(()), make_folder)?;
        }
        output::write_together(&files)?;
        laps.end("writing");
        let files = files.into_iter().map(|(path, _)| path).collect();
        Ok(Done { notices: notices(capture, &discovery), objects: discovery.objects, files })
    }

    /// The files of a frame, none of them written yet.
    fn encode(
        &self,
        input: &Input,
        capture: &Capture,
        discovery: &Discovery,
        recording: Option<&Recording>,
    ) -> Result<Vec<(PathBuf, Vec<u8>)>> {
        let mut files = Vec::new();
        for kind in &self.kinds {
            let (suffix, bytes) = match kind {
                OutputKind::Labels => (".labels.png", label_image::encode(&discovery.labels)?),
                OutputKind::Json => {
                    let source = input.path.display().to_string();
                    let scene = SceneFile::new(&source, capture, &self.params, discovery);
                    (".json", scene.to_json()?.into_bytes())
                }
                OutputKind::Panels => {
                    let Some(recording) = recording else { continue };
                    (".panels.png", png(&panels(&capture.frame, recording, discovery))?)
                }
            };
            files.push((with_suffix(&self.args.out.join(&input.name), suffix), bytes));
        }
        Ok(files)
    }
}

fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder)
        .map_err(|e| anyhow!("cannot make the folder {} ({e}): choose another --out", folder.display()))
}

/// `a.b` -> `a.b.json`; `Path::with_extension` would make `a.json` of it.
fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(suffix);
    name.into()
}

/// The result of the only frame: a table of its objects, and where the files are.
fn in_full(input: &Input, done: &Done) -> String {
    let mut text = format!("{}: {}\n", input.path.display(), count(done.objects.len()));
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

/// The result of one frame of many, on one line.
fn in_short(input: &Input, done: &Done) -> String {
    let files: Vec<String> = done.files.iter().map(|f| f.display().to_string()).collect();
    format!("{}: {} -> {}\n", input.path.display(), count(done.objects.len()), files.join(" "))
}

fn count(objects: usize) -> String {
    if objects == 1 { "1 object".to_owned() } else { format!("{objects} objects") }
}
