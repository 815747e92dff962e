//! Frames of a stream on their way from the thread that reads them to the one that looks at them.

use std::io::Read;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use anyhow::{Result, anyhow};
use objecthood_io::pipe::{PipeError, PipeFrame};

use crate::interrupt;

/// How often a thread that waits for a frame looks whether Ctrl-C was pressed.
const PATIENCE: Duration = Duration::from_millis(100);

/// A place for one frame. While one is looked at, one waits here and one is being read: no more are in memory.
pub(super) struct Mailbox {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    waiting: Option<(usize, PipeFrame)>,
    arrived: usize,
    dropped: usize,
    /// How the stream ended, once it has.
    end: Option<Result<(), PipeError>>,
}

/// What is taken out of the mailbox.
pub(super) struct Taken {
    /// Which frame of the stream it is, from 0.
    pub(super) number: usize,
    /// Frames that were dropped until now.
    pub(super) dropped: usize,
    pub(super) frame: PipeFrame,
}

impl Mailbox {
    /// Begins to read frames. With `latest` a newer frame takes the place of one that waits; else it waits until that is taken.
    ///
    /// # Errors
    /// When no thread can be had.
    pub(super) fn open(
        mut reader: impl Read + Send + 'static,
        max_pixels: usize,
        latest: bool,
    ) -> Result<Arc<Self>> {
        let mailbox = Arc::new(Self { state: Mutex::default(), changed: Condvar::new() });
        let filled = Arc::clone(&mailbox);
        let fill = move || {
            let mut number = 0;
            let end = loop {
                match PipeFrame::read(&mut reader, number, max_pixels) {
                    Ok(Some(frame)) => filled.put(number, frame, latest),
                    Ok(None) => break Ok(()),
                    Err(error) => break Err(error),
                }
                number += 1;
            };
            filled.lock().end = Some(end);
            filled.changed.notify_all();
        };
        // It may wait for a frame for ever, so nobody waits for it.
        thread::Builder::new().spawn(fill).map_err(|e| anyhow!("cannot start a thread ({e})"))?;
        Ok(mailbox)
    }

    fn put(&self, number: usize, frame: PipeFrame, latest: bool) {
        let mut state = self.lock();
        while !latest && state.waiting.is_some() {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.arrived += 1;
        state.dropped += usize::from(state.waiting.replace((number, frame)).is_some());
        self.changed.notify_all();
    }

    /// The next frame, as soon as there is one. `None`: the stream has ended, or Ctrl-C was pressed.
    pub(super) fn take(&self) -> Option<Taken> {
        let mut state = self.lock();
        loop {
            if interrupt::is_asked() {
                return None;
            }
            if let Some((number, frame)) = state.waiting.take() {
                self.changed.notify_all();
                return Some(Taken { number, dropped: state.dropped, frame });
            }
            if state.end.is_some() {
                return None;
            }
            let woken = self.changed.wait_timeout(state, PATIENCE);
            state = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Frames that arrived, frames of them that were dropped, and how the stream ended.
    pub(super) fn close(&self) -> (usize, usize, Result<(), PipeError>) {
        let mut state = self.lock();
        (state.arrived, state.dropped, state.end.take().unwrap_or(Ok(())))
    }

    /// What a thread that panicked leaves is whole: each change is one assignment.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(frames: usize) -> Vec<u8> {
        let frame = [&b"OHF1"[..], &2_u32.to_le_bytes(), &[0; 8], b"{}"].concat();
        frame.repeat(frames)
    }

    fn numbers(mailbox: &Mailbox) -> Vec<usize> {
        std::iter::from_fn(|| mailbox.take()).map(|taken| taken.number).collect()
    }

    #[test]
    fn every_frame_comes_in_order() {
        let mailbox = Mailbox::open(std::io::Cursor::new(stream(20)), 100, false).unwrap();
        assert_eq!(numbers(&mailbox), (0..20).collect::<Vec<_>>());
        assert!(matches!(mailbox.close(), (20, 0, Ok(()))));
    }

    #[test]
    fn the_newest_frame_wins_and_the_others_are_counted() {
        let mailbox = Mailbox::open(std::io::Cursor::new(stream(20)), 100, true).unwrap();
        while mailbox.lock().end.is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(numbers(&mailbox), [19]);
        assert!(matches!(mailbox.close(), (20, 19, Ok(()))));
    }

    #[test]
    fn what_came_before_a_broken_frame_is_taken() {
        let bytes = [stream(3), b"OHF2".to_vec()].concat();
        let mailbox = Mailbox::open(std::io::Cursor::new(bytes), 100, false).unwrap();
        assert_eq!(numbers(&mailbox), [0, 1, 2]);
        assert!(matches!(mailbox.close(), (3, 0, Err(PipeError::NoMark { number: 3 }))));
    }
}
