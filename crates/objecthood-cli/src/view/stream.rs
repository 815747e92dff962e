//! `objecthood view -`: the frames that come by stdin, as docs/PIPE.md describes them.

use std::sync::Arc;
use std::{io, thread};

use anyhow::{Result, anyhow};
use objecthood_io::pipe::PipeFrame;
use objecthood_io::scope::Scope;
use objecthood_io::{Capture, Given};
use objecthood_page::{FrameList, FrameSource};

use crate::args::FrameArgs;
use crate::failure::usage;
use crate::{advice, terminal};

/// So many frames can be looked at, the last ones: a megabyte or two each.
const KEPT: usize = 100;

/// How the frames are read.
pub(super) struct Stream {
    pub(super) asked: FrameArgs,
    pub(super) given: Given,
    pub(super) scope: Scope,
}

impl Stream {
    /// The frames, the first one of which is there. The others are added as they come.
    ///
    /// # Errors
    /// When there is none, or the first one is broken.
    pub(super) fn frames(self) -> Result<Arc<FrameList>> {
        let (stream, mut stdin) = (Arc::new(self), io::stdin());
        let most_px = stream.given.max_pixels;
        let first = PipeFrame::read(&mut stdin, 0, most_px)?;
        let frames = Arc::new(FrameList::stream(KEPT));
        frames.push(stream.source(0, first.ok_or_else(|| usage("no frame comes by stdin"))?));
        let growing = Arc::clone(&frames);
        let grow = move || {
            for number in 1.. {
                match PipeFrame::read(&mut stdin, number, most_px) {
                    Ok(Some(frame)) => growing.push(stream.source(number, frame)),
                    Ok(None) => break,
                    Err(error) => return terminal::error(&error.into()),
                }
            }
            terminal::note("the stream has ended; its frames are still shown");
        };
        // It may wait for a frame for ever, so nobody waits for it.
        thread::Builder::new().spawn(grow).map_err(|e| anyhow!("cannot start a thread ({e})"))?;
        Ok(frames)
    }

    /// The `number`th frame, which is decoded when it is looked at.
    fn source(self: &Arc<Self>, number: usize, frame: PipeFrame) -> FrameSource {
        let name = frame.header().ok().and_then(|header| header.name);
        let stream = Arc::clone(self);
        FrameSource::new(name.unwrap_or_else(|| format!("frame {number}")), move || {
            stream.read(&frame).map_err(|e| format!("{e:#}{}", advice::of(&e)))
        })
    }

    fn read(&self, frame: &PipeFrame) -> Result<Capture> {
        let header = frame.header().map_err(objecthood_io::Error::from)?;
        self.asked.tell(frame.capture(&header, &self.given)?, &self.scope)
    }
}
