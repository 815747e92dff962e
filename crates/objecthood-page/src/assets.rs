//! The built page: `cargo xtask page` writes these files from `web/`.

/// The page before anything runs.
pub(crate) const PAGE: &str = include_str!("../assets/page.html");
/// All of its code, with the packages that it uses.
pub(crate) const SCRIPT: &str = include_str!("../assets/page.js");
/// How it looks.
pub(crate) const STYLE: &str = include_str!("../assets/page.css");
/// The licences of these packages.
pub(crate) const LICENCES: &str = include_str!("../assets/LICENSES.txt");
