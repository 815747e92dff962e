//! The live page: its TypeScript becomes the files that the crate embeds, so that building the crate needs no Node. It is tried in a real
//! browser, which Debian packages.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::house::{House, is_installed, output, pass_on};
use crate::tally::Tally;
use crate::test::read_tests;

/// Where the sources of the page are, and what is built of them.
const WEB: &str = "crates/objecthood-page/web";
const ASSETS: &str = "crates/objecthood-page/assets";
/// What the tests need, each with its package in Debian.
const PROGRAMS: [(&str, &str); 3] = [("node", "nodejs"), ("npm", "npm"), ("chromium", "chromium")];
/// The programs of Node that try the page.
const TESTS: [&str; 2] = ["tests/page.mjs", "tests/report.mjs"];

/// Builds the page into the assets of its crate.
///
/// # Errors
/// Without Node, its packages or a registry that has them; when the sources have a mistake.
pub(crate) fn run(house: &House) -> Result<bool> {
    let web = prepare(house)?;
    build(&web, &house.root.join(ASSETS))?;
    println!("the page is built; commit {ASSETS}");
    Ok(true)
}

/// As [`check`], by itself; says what was skipped.
///
/// # Errors
/// As [`check`].
pub(crate) fn run_tests(house: &House) -> Result<bool> {
    let mut tally = Tally::default();
    let passed = check(house, &mut tally)?;
    tally.skipped.iter().for_each(|why| println!("skipped: {why}"));
    Ok(passed)
}

/// Measures, in release, how long it takes from a change of a parameter to the picture.
///
/// # Errors
/// When the program cannot be built, or there is no Node or no browser.
pub(crate) fn measure(house: &House) -> Result<bool> {
    let web = prepare(house)?;
    pass_on(&mut house.cargo("build --release --locked -p objecthood-cli"))?;
    pass_on(&mut in_browser(house, &web, "tests/times.mjs", &house.program("objecthood")))?;
    Ok(true)
}

/// Draws the picture of the page in the README: of a synthetic scene, so that it is ours to show.
///
/// # Errors
/// When the program cannot be built, or there is no Node or no browser.
pub(crate) fn draw(house: &House) -> Result<bool> {
    let web = prepare(house)?;
    house.build_products()?;
    let mut draw = in_browser(house, &web, "tests/picture.mjs", &house.target.join("debug/objecthood"));
    pass_on(draw.arg(house.root.join("docs/pictures/page.jpg")))?;
    Ok(true)
}

/// Whether the assets are what the sources say, and the page does in a browser what it should. Without Node or a browser, and without
/// the right to install them, that is noted.
///
/// # Errors
/// When the page cannot be built, or its tests cannot be started.
pub(crate) fn check(house: &House, tally: &mut Tally) -> Result<bool> {
    let web = match PROGRAMS.iter().try_for_each(|&(program, package)| install(program, package)) {
        Ok(()) => prepare(house),
        Err(e) => Err(e),
    };
    let web = match web {
        Ok(web) => web,
        Err(e) => {
            tally.skip(format!("the live page in a browser: {e:#}"));
            return Ok(true);
        }
    };
    let fresh = house.folder("page-assets")?;
    build(&web, &fresh)?;
    let is_fresh = is_same(&fresh, &house.root.join(ASSETS))?;
    if !is_fresh {
        println!("{ASSETS} is not what {WEB} says: `cargo xtask page`, and commit it");
    }
    house.build_products()?;
    let mut passed = is_fresh;
    for test in TESTS {
        let mut command = in_browser(house, &web, test, &house.target.join("debug/objecthood"));
        command.env("OBJECTHOOD_PICTURES", house.folder("page-pictures")?);
        passed &= read_tests(&mut command, tally)?;
    }
    Ok(passed)
}

/// A program of Node that drives a browser, and what it needs to know.
fn in_browser(house: &House, web: &Path, script: &str, program: &Path) -> Command {
    let mut command = Command::new("node");
    command.current_dir(web).arg(script).env("OBJECTHOOD_PROGRAM", program);
    if let Some(data) = house.data() {
        command.env("OBJECTHOOD_DATA", data);
    }
    command
}

/// Installs a package of Debian whose program is missing.
fn install(program: &str, package: &str) -> Result<()> {
    if is_installed(program) {
        return Ok(());
    }
    let mut apt = Command::new("apt-get");
    apt.args(["install", "--yes", "--quiet", "--no-install-recommends", package]);
    output(&mut apt).with_context(|| format!("{program} is missing"))?;
    Ok(())
}

/// Installs the packages that the lock names, unless they are there, and returns the folder of the sources.
fn prepare(house: &House) -> Result<PathBuf> {
    ensure!(is_installed("npm"), "Node is missing: apt-get install nodejs npm");
    let web = house.root.join(WEB);
    let (lock, stamp) = (web.join("package-lock.json"), web.join("node_modules/.lock"));
    let wanted = fs::read(&lock).with_context(|| format!("{}", lock.display()))?;
    // Written last, so that packages that were left half-installed are installed again.
    if fs::read(&stamp).is_ok_and(|have| have == wanted) {
        return Ok(web);
    }
    output(npm(&web).args(["ci", "--ignore-scripts"]))?;
    fs::write(&stamp, wanted).with_context(|| format!("{}", stamp.display()))?;
    Ok(web)
}

/// Checks the types of the sources and builds them into a folder.
fn build(web: &Path, folder: &Path) -> Result<()> {
    pass_on(npm(web).args(["run", "--silent", "check"]))?;
    pass_on(npm(web).args(["run", "--silent", "build", "--"]).arg(folder))
}

fn npm(folder: &Path) -> Command {
    let mut command = Command::new("npm");
    command.current_dir(folder);
    command
}

/// Whether two folders have the same files.
fn is_same(a: &Path, b: &Path) -> Result<bool> {
    for entry in fs::read_dir(a).with_context(|| format!("{}", a.display()))? {
        let path = entry?.path();
        let name = path.file_name().context("a file without a name")?;
        if fs::read(&path)? != fs::read(b.join(name)).unwrap_or_default() {
            return Ok(false);
        }
    }
    Ok(true)
}
