//! `objecthood view`: the live page over any frames.

mod stream;

use std::path::Path;
use std::sync::Arc;

use anyhow::{Result, anyhow, bail};
use objecthood_page::{Address, FrameList, FrameSource, Session, serve};

use crate::args::{CameraArg, ViewArgs};
use crate::failure::Outcome;
use crate::inputs::{Input, Inputs, STDIN};
use crate::shell::words_of_frames;
use crate::words::counted;
use crate::{advice, config, inputs, interrupt, terminal};
use stream::Stream;

/// Shows the frames until Ctrl-C.
///
/// # Errors
/// Of usage; when there is no frame to show; when the port cannot be had.
pub(crate) fn run(args: &ViewArgs) -> Result<Outcome> {
    let session = session(args)?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(args.settings.threads())
        .build_global()
        .map_err(|e| anyhow!("cannot start the threads ({e}): give fewer with --threads"))?;
    interrupt::catch()?;
    let mut printed = Ok(());
    let ready = |Address(address): &Address| {
        printed = terminal::print(&format!("{address}\n"));
        terminal::note("open this address in a browser on this machine; Ctrl-C ends");
    };
    serve(session, args.port, ready, interrupt::is_asked)?;
    printed.map(|()| Outcome::AllDone)
}

fn session(args: &ViewArgs) -> Result<Session> {
    let params = config::params(&args.settings.parameters, args.method)?;
    let camera = args.frames.camera.as_ref().map(CameraArg::read).transpose()?;
    args.frames.scale_note(camera.as_ref()).iter().for_each(|note| terminal::note(note));
    let scope = args.frames.scope.read(args.frames.images.max_pixels)?;
    if args.frames.inputs == [Path::new(STDIN)] {
        let stream = Stream { asked: args.frames.clone(), given: args.frames.given(camera.as_ref()), scope };
        // As `segment` takes them.
        let words = ["-", "--format", "frames"].map(str::to_owned).to_vec();
        return Ok(Session { title: "frames by stdin".to_owned(), words, frames: stream.frames()?, params });
    }
    let Inputs { frames, mut unreadable, notices, .. } =
        inputs::collect(&args.frames, true, camera.as_ref())?;
    notices.iter().for_each(|notice| terminal::note(notice));
    let reason = if frames.is_empty() { unreadable.pop() } else { None };
    unreadable.iter().for_each(terminal::error);
    if let Some(reason) = reason {
        return Err(reason);
    }
    refuse_missing(&frames)?;
    let (asked, scope) = (Arc::new(args.frames.clone()), Arc::new(scope));
    let of_frame = |input: Input| {
        let (asked, scope) = (Arc::clone(&asked), Arc::clone(&scope));
        let name = input.title();
        FrameSource::new(name, move || {
            asked.read(&input, &scope).map_err(|e| format!("{e:#}{}", advice::of(&e)))
        })
    };
    let frames = Arc::new(FrameList::of(frames.into_iter().map(of_frame).collect()));
    let words = words_of_frames("view");
    Ok(Session { title: words.join(" "), words, frames, params })
}

/// Says at once what the page could not show, because files are listed that are not there.
///
/// # Errors
/// When it could show no frame at all.
fn refuse_missing(frames: &[Input]) -> Result<()> {
    let missing: Vec<&Path> = frames.iter().filter_map(Input::missing_file).collect();
    let Some(first) = missing.first() else { return Ok(()) };
    let (first, count, total) = (first.display(), missing.len(), counted(frames.len(), "frame"));
    if count == frames.len() {
        bail!(
            "no image can be shown of {total}: {first} is not there: bring the images back to where the input lists them"
        );
    }
    terminal::note(&format!("{count} of {total} cannot be shown: {first} is not there"));
    Ok(())
}
