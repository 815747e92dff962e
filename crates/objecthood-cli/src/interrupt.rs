//! Ctrl-C: the first ends the work after the items that are under way, the second at once.

use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Result, anyhow};

use crate::terminal;

/// What shells report of a program that Ctrl-C ended: 128 and the number of the signal.
pub(crate) const EXIT_CODE: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C no longer ends the process: [`is_asked`] says that it should end.
///
/// # Errors
/// When the system does not hand over the signal.
pub(crate) fn catch() -> Result<()> {
    static CAUGHT: OnceLock<Result<(), ctrlc::Error>> = OnceLock::new();
    let ask = || {
        if ASKED.swap(true, Ordering::Relaxed) {
            process::exit(EXIT_CODE.into());
        }
        terminal::note("finishing what is under way; press Ctrl-C again to stop at once");
    };
    let caught = CAUGHT.get_or_init(|| ctrlc::set_handler(ask));
    caught.as_ref().map_err(|e| anyhow!("cannot listen for Ctrl-C ({e})")).copied()
}

/// Whether Ctrl-C was pressed.
pub(crate) fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
