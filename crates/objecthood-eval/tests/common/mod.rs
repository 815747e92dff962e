//! Where the tests find the real data.

use std::path::PathBuf;

/// The folder of real data, from `OBJECTHOOD_DATA` or beside the workspace; `None` where it is absent.
pub(crate) fn data() -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    let folder = std::env::var_os("OBJECTHOOD_DATA").map_or_else(beside, PathBuf::from);
    folder.join("mosd/learn").is_dir().then_some(folder)
}
