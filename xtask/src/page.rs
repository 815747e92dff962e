//! The live page: its TypeScript becomes the files that the crate embeds, so that building the crate needs no Node.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Result, ensure};

use crate::house::{House, is_installed, output, pass_on};

/// Builds the page into the assets of its crate.
///
/// # Errors
/// Without Node, its packages or a registry that has them; when the sources have a mistake.
pub(crate) fn run(house: &House) -> Result<bool> {
    let web = prepare(house)?;
    pass_on(npm(&web).args(["run", "--silent", "check"]))?;
    pass_on(npm(&web).args(["run", "--silent", "build"]))?;
    println!("the page is built; commit crates/objecthood-page/assets");
    Ok(true)
}

/// Installs the packages that the lock names, unless they are there, and returns the folder of the sources.
fn prepare(house: &House) -> Result<PathBuf> {
    ensure!(is_installed("npm"), "Node is missing: apt-get install nodejs npm");
    let web = house.root.join("crates/objecthood-page/web");
    let (lock, stamp) = (web.join("package-lock.json"), web.join("node_modules/.lock"));
    let wanted = std::fs::read(&lock)?;
    // Written last, so that packages that were left half-installed are installed again.
    if std::fs::read(&stamp).is_ok_and(|have| have == wanted) {
        return Ok(web);
    }
    output(npm(&web).args(["ci", "--ignore-scripts"]))?;
    std::fs::write(stamp, wanted)?;
    Ok(web)
}

fn npm(folder: &Path) -> Command {
    let mut command = Command::new("npm");
    command.current_dir(folder);
    command
}
