//! The pipelines that are kept, a bounded number of them: a tab that was pushed out only waits longer once.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use objecthood::Pipeline;
use objecthood_io::Capture;

use crate::error::Result;
use crate::follow::Following;
use crate::repair::Repairing;
use crate::session::Session;

/// Pipelines at a time: both sides of a comparison, the contact sheet, the tracker and the search for repairs of two tabs.
const MOST: usize = 10;
/// One that was not used for this long is forgotten: its browser is gone without a word.
const IDLE: Duration = Duration::from_secs(600);

/// Whose pipeline it is: the tab's number, and which of its pictures.
pub(crate) type Key = (u64, u8);

/// A pipeline, and the frame that it looked at last.
#[derive(Default)]
pub(crate) struct Bench {
    pub(crate) pipeline: Pipeline,
    frame: Option<(usize, Arc<Capture>)>,
    /// Objects that are followed through the frames.
    pub(crate) following: Option<Following>,
    /// A search for what would change the answer for a pixel.
    pub(crate) repairing: Option<Repairing>,
}

impl Bench {
    /// The frame, read unless it is the last one.
    ///
    /// # Errors
    /// As [`Session::read`].
    pub(crate) fn capture(&mut self, session: &Session, frame: usize) -> Result<Arc<Capture>> {
        if let Some((_, capture)) = self.frame.as_ref().filter(|(last, _)| *last == frame) {
            return Ok(Arc::clone(capture));
        }
        let capture = Arc::new(session.read(frame)?);
        self.frame = Some((frame, Arc::clone(&capture)));
        Ok(capture)
    }
}

/// A bench that is kept.
struct Kept {
    key: Key,
    used: Instant,
    bench: Arc<Mutex<Bench>>,
}

/// The benches, the one that was used longest ago first.
#[derive(Default)]
pub(crate) struct Pipelines(Mutex<Vec<Kept>>);

impl Pipelines {
    /// The bench of a tab, new if it has none; the one that was used longest ago makes room.
    pub(crate) fn of(&self, key: Key) -> Arc<Mutex<Bench>> {
        let mut kept = lock(&self.0);
        let found = kept.iter().position(|one| one.key == key).map(|place| kept.remove(place).bench);
        let bench = found.unwrap_or_default();
        if kept.len() >= MOST {
            kept.remove(0);
        }
        kept.push(Kept { key, used: Instant::now(), bench: Arc::clone(&bench) });
        bench
    }

    /// Forgets what a tab has: it was closed.
    pub(crate) fn close(&self, tab: u64) {
        lock(&self.0).retain(|one| one.key.0 != tab);
    }

    /// Forgets what nobody used for long.
    pub(crate) fn forget_idle(&self) {
        lock(&self.0).retain(|one| one.used.elapsed() < IDLE);
    }

    /// How many are kept.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        lock(&self.0).len()
    }
}

/// A lock that a panic left behind is taken all the same: what a bench holds is whole at any time.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tab_keeps_its_bench_until_others_need_the_room_or_it_closes() {
        let pipelines = Pipelines::default();
        let first = pipelines.of((1, 0));
        assert!(Arc::ptr_eq(&first, &pipelines.of((1, 0))));
        for tab in 2..=MOST as u64 {
            pipelines.of((tab, 0));
        }
        assert!(Arc::ptr_eq(&first, &pipelines.of((1, 0))), "used again, so it is not the oldest");
        pipelines.of((99, 0));
        assert_eq!(pipelines.count(), MOST);
        assert!(Arc::ptr_eq(&first, &pipelines.of((1, 0))));
        pipelines.close(1);
        assert_eq!(pipelines.count(), MOST - 1);
        assert!(!Arc::ptr_eq(&first, &pipelines.of((1, 0))));
    }
}
