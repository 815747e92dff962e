//! The page: its frame and style as they stand in `web/`, and the script and licences that `cargo xtask page` builds from there.

/// The page before anything runs.
pub(crate) const PAGE: &str = include_str!("../web/src/page.html");
/// All of its code, with the packages that it uses.
pub(crate) const SCRIPT: &str = include_str!("../assets/page.js");
/// How it looks.
pub(crate) const STYLE: &str = include_str!("../web/src/page.css");
/// The licences of these packages.
pub(crate) const LICENCES: &str = include_str!("../assets/LICENSES.txt");
