//! `objecthood view`: the live page over any frames.

use std::path::Path;
use std::sync::Arc;
use std::{io, thread};

use anyhow::{Result, anyhow};
use objecthood::Params;
use objecthood_io::camera_file::CameraFile;
use objecthood_io::pipe::PipeFrame;
use objecthood_io::scope::Scope;
use objecthood_page::{Address, FrameList, FrameSource, Session, serve};

use crate::args::{CameraArg, ViewArgs};
use crate::failure::{Outcome, usage};
use crate::inputs::{Input, Inputs, STDIN};
use crate::shell::words_of_frames;
use crate::{advice, config, inputs, interrupt, terminal};

/// Of a stream so many frames can be looked at: a megabyte or two each.
const KEPT_OF_STREAM: usize = 100;

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
    let scope = Arc::new(args.frames.scope.read(args.frames.images.max_pixels)?);
    if args.frames.inputs == [Path::new(STDIN)] {
        return of_stream(args, params, camera.as_ref(), &scope);
    }
    let Inputs { frames, unreadable, notices, .. } = inputs::collect(&args.frames, true, camera.as_ref())?;
    notices.iter().for_each(|notice| terminal::note(notice));
    unreadable.iter().for_each(terminal::error);
    if frames.is_empty() {
        return Err(unreadable.into_iter().next().unwrap_or_else(|| usage("there is no frame to show")));
    }
    let asked = Arc::new(args.frames.clone());
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

/// A session over the frames that come by stdin, as docs/PIPE.md describes them. It begins with the first one.
///
/// # Errors
/// When there is none, or the first one is broken.
fn of_stream(
    args: &ViewArgs,
    params: Params,
    camera: Option<&CameraFile>,
    scope: &Arc<Scope>,
) -> Result<Session> {
    let given = Arc::new(args.frames.given(camera));
    let frames = Arc::new(FrameList::stream(KEPT_OF_STREAM));
    let mut stdin = io::stdin();
    let asked = Arc::new(args.frames.clone());
    let source = {
        let (given, scope) = (Arc::clone(&given), Arc::clone(scope));
        move |number: usize, frame: PipeFrame| -> FrameSource {
            let header = frame.header().ok();
            let name = header.as_ref().and_then(|header| header.name.clone());
            let (asked, given, scope) = (Arc::clone(&asked), Arc::clone(&given), Arc::clone(&scope));
            let read = move || -> Result<_> {
                let header = frame.header().map_err(objecthood_io::Error::from)?;
                asked.tell(frame.capture(&header, &given)?, &scope)
            };
            let name = name.unwrap_or_else(|| format!("frame {number}"));
            FrameSource::new(name, move || read().map_err(|e| format!("{e:#}{}", advice::of(&e))))
        }
    };
    let first = PipeFrame::read(&mut stdin, 0, given.max_pixels)?;
    frames.push(source(0, first.ok_or_else(|| usage("no frame comes by stdin"))?));
    let (growing, most) = (Arc::clone(&frames), given.max_pixels);
    let grow = move || {
        for number in 1.. {
            match PipeFrame::read(&mut stdin, number, most) {
                Ok(Some(frame)) => growing.push(source(number, frame)),
                Ok(None) => break,
                Err(error) => return terminal::error(&error.into()),
            }
        }
        terminal::note("the stream has ended; its frames are still shown");
    };
    // It may wait for a frame for ever, so nobody waits for it.
    thread::Builder::new().spawn(grow).map_err(|e| anyhow!("cannot start a thread ({e})"))?;
    let words = ["-", "--format", "frames"].map(str::to_owned).to_vec();
    Ok(Session { title: "frames by stdin".to_owned(), words, frames, params })
}
