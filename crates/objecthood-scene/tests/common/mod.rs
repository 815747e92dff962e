//! What several tests need.
#![allow(dead_code, reason = "each test uses a part")]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or is skipped is reported so")]

pub(crate) mod statistics;
pub(crate) mod waves;

use std::path::{Path, PathBuf};

/// The folder of the mOSD data set, if it is there; else says that the test is skipped.
pub(crate) fn mosd() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("OBJECTHOOD_DATA").map_or(beside, PathBuf::from).join("mosd");
    if folder.join("learn").is_dir() {
        return Some(folder);
    }
    println!("skipped: no real data here, set OBJECTHOOD_DATA to the folder that holds mosd/learn");
    None
}
