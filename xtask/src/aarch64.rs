//! Small computers: that everything builds for aarch64, and that labels are the same there.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;

use crate::house::{House, METHODS, files, is_installed, output, pass_on};
use crate::tally::Tally;

const TARGET: &str = "aarch64-unknown-linux-gnu";
const LINKER: &str = "aarch64-linux-gnu-gcc";
const EMULATOR: &str = "qemu-aarch64-static";
/// Where the C library of aarch64 lies.
const SYSROOT: &str = "/usr/aarch64-linux-gnu";
/// Two scenes of every family.
const SCENES: &str = "12";

/// Type-checks what runs on a robot; skipped where the target cannot be installed.
///
/// # Errors
/// When cargo cannot be run.
pub(crate) fn check(house: &House, tally: &mut Tally) -> Result<bool> {
    if let Err(e) = add_target() {
        tally.skip(format!("builds for aarch64: {e:#}"));
        return Ok(true);
    }
    let packages = "-p objecthood -p objecthood-io -p objecthood-cli";
    Ok(house.cargo(&format!("check --locked --target {TARGET} {packages}")).status()?.success())
}

/// Builds the program for aarch64 and for this machine, and compares the label images of synthetic scenes bit by bit.
///
/// # Errors
/// Without the linker and the emulator, or when a build fails.
pub(crate) fn run(house: &House) -> Result<bool> {
    for (program, package) in
        [(LINKER, "gcc-aarch64-linux-gnu, libc6-dev-arm64-cross"), (EMULATOR, "qemu-user-static")]
    {
        anyhow::ensure!(is_installed(program), "{program} is missing: apt-get install {package}");
    }
    add_target()?;
    let build = "build --release --locked -p objecthood-cli";
    pass_on(&mut house.cargo(build))?;
    let linker = "CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER";
    pass_on(house.cargo(&format!("{build} --target {TARGET}")).env(linker, LINKER))?;

    let folder = house.folder("aarch64")?;
    let native = Machine { name: "this machine", command: vec![house.program("objecthood")] };
    let theirs = house.target.join(TARGET).join("release/objecthood");
    let emulated =
        Machine { name: "aarch64", command: vec![EMULATOR.into(), "-L".into(), SYSROOT.into(), theirs] };
    let scenes = folder.join("scenes");
    native.run(&["synth", "--scenes", SCENES, "--out"], &[&scenes])?;

    let mut equal = true;
    for method in METHODS {
        let mut found = Vec::new();
        for machine in [&native, &emulated] {
            let out = folder.join(method).join(machine.name);
            machine.run(&["segment", "--method", method, "--write", "labels", "--out"], &[&out, &scenes])?;
            found.push(out);
        }
        let labels = files(&found[0], "png")?;
        let differ = labels.iter().filter(|file| !is_same(file, &found[1]));
        let differ: Vec<String> = differ.map(|file| file.display().to_string()).collect();
        println!("{method}: {} of {} label images differ {}", differ.len(), labels.len(), differ.join(" "));
        equal &= differ.is_empty() && !labels.is_empty();
    }
    Ok(equal)
}

/// A machine and how the program is started on it.
struct Machine {
    name: &'static str,
    command: Vec<PathBuf>,
}

impl Machine {
    fn run(&self, arguments: &[&str], paths: &[&Path]) -> Result<()> {
        let (program, before) = (&self.command[0], &self.command[1..]);
        output(Command::new(program).args(before).args(arguments).args(paths)).map(drop)
    }
}

/// Whether the file of the same name in another folder has the same bytes.
fn is_same(file: &Path, folder: &Path) -> bool {
    let other = file.file_name().map(|name| folder.join(name));
    match (std::fs::read(file), other.map(std::fs::read)) {
        (Ok(a), Some(Ok(b))) => a == b,
        _ => false,
    }
}

fn add_target() -> Result<()> {
    output(Command::new("rustup").args(["target", "add", TARGET])).map(drop)
}
