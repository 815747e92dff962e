//! How many instructions a frame takes. Times are noisy, counts are not: a change that makes a method slower shows here.
//!
//! Valgrind's callgrind counts what one frame of the demo's scene takes, by one method on one thread, reading and drawing
//! not included. The counts stand in a file; [`check`] fails when one has grown.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

use crate::house::{House, METHODS, is_installed, output, pass_on};
use crate::tally::Tally;

/// Instructions of a frame by method.
type Counts = BTreeMap<String, u64>;

/// Where the counts stand.
const FILE: &str = "crates/objecthood-bench/instructions.toml";
/// A count that grows by more than this has to be accepted by writing the file anew.
const TOLERATED_PERCENT: u128 = 3;
const ANEW: &str = "cargo xtask bench --instructions writes the counts anew";
const COUNTED: &str = "*counted*the_counted_part*";
/// Has the C library copy memory in the same way on every processor: its choice alone is 2 % of the count.
const TUNABLES: &str =
    "glibc.cpu.hwcaps=-AVX2,-AVX2_Usable,-AVX_Fast_Unaligned_Load,-AVX512F,-AVX512VL,-AVX512BW,-ERMS,-FSRM";
const HEADER: &str = "# Instructions of one frame of 640 x 480 (the scene of `objecthood demo`) on one thread of x86-64, by method.
# `cargo xtask test` fails when one grows by more than 3 %; `cargo xtask bench --instructions` writes this file.
";

/// Compares with the counts that stand in the repository; skipped where valgrind is not to be had.
pub(crate) fn check(house: &House, tally: &mut Tally) -> bool {
    if let Err(e) = prepare() {
        tally.skip(format!("instruction counts: {e:#}"));
        return true;
    }
    compare(house).unwrap_or_else(|e| {
        println!("error: {e:#}");
        false
    })
}

/// Whether no count has grown too much.
fn compare(house: &House) -> Result<bool> {
    let known = read(&house.root.join(FILE))?;
    let counted = count(house)?;
    let mut passed = true;
    for (method, &now) in &counted {
        let verdict = Verdict::of(known.get(method).copied(), now);
        println!("{method}: {}", verdict.text(now));
        match verdict {
            Verdict::Fine(_) => (),
            Verdict::Fallen(_) => println!("that it does not grow back unseen: {ANEW}"),
            Verdict::Grown(_) | Verdict::Unknown => println!("if it is meant to be so: {ANEW}"),
        }
        passed &= verdict.passes();
    }
    Ok(passed)
}

/// Counts anew and writes the file.
///
/// # Errors
/// Without valgrind; when the program cannot be built or run, or the file cannot be written.
pub(crate) fn bless(house: &House) -> Result<bool> {
    prepare()?;
    let file = house.root.join(FILE);
    let known = if file.exists() { read(&file)? } else { Counts::new() };
    let counted = count(house)?;
    for (method, &now) in &counted {
        println!("{method}: {}", Verdict::of(known.get(method).copied(), now).text(now));
    }
    std::fs::write(&file, text(&counted)).with_context(|| format!("{}", file.display()))?;
    println!("written: {FILE}");
    Ok(true)
}

fn read(file: &Path) -> Result<Counts> {
    let text = std::fs::read_to_string(file)
        .with_context(|| format!("{}: cargo xtask bench --instructions writes it", file.display()))?;
    toml::from_str(&text).with_context(|| format!("{}", file.display()))
}

fn text(counts: &Counts) -> String {
    let mut text = HEADER.to_owned();
    for (method, count) in counts {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{method} = {count}");
    }
    text
}

/// What is to be said of a count.
#[derive(Debug, PartialEq)]
enum Verdict {
    /// The file has no count of this method.
    Unknown,
    /// It has grown by more than is tolerated; by this share.
    Grown(f64),
    /// It is much the same; by this share.
    Fine(f64),
    /// It is smaller by more than is tolerated of growth, and could grow back unseen; by this share.
    Fallen(f64),
}

impl Verdict {
    fn of(known: Option<u64>, now: u64) -> Self {
        match known {
            None | Some(0) => Self::Unknown,
            Some(known) => {
                let growth = now as f64 / known as f64 - 1.0;
                let (known, now) = (u128::from(known), 100 * u128::from(now));
                if now > known * (100 + TOLERATED_PERCENT) {
                    Self::Grown(growth)
                } else if now < known * (100 - TOLERATED_PERCENT) {
                    Self::Fallen(growth)
                } else {
                    Self::Fine(growth)
                }
            }
        }
    }

    fn passes(&self) -> bool {
        matches!(self, Self::Fine(_) | Self::Fallen(_))
    }

    fn text(&self, now: u64) -> String {
        let mega = now as f64 / 1e6;
        match self {
            Self::Unknown => format!("{mega:.2} million instructions, of which nothing is known yet"),
            Self::Grown(share) | Self::Fine(share) | Self::Fallen(share) => {
                let (before, percent) = (mega / (1.0 + share), 100.0 * share);
                format!("{before:.2} million instructions were known, now {mega:.2} ({percent:+.2} %)")
            }
        }
    }
}

/// Sees to it that valgrind is there.
fn prepare() -> Result<()> {
    anyhow::ensure!(
        cfg!(all(target_os = "linux", target_arch = "x86_64")),
        "they are those of x86-64 on Linux"
    );
    if is_installed("valgrind") {
        return Ok(());
    }
    let apt = |arguments: &[&str]| {
        let quick = ["-qq", "-o", "Acquire::Retries=0", "-o", "Acquire::http::Timeout=20"];
        output(Command::new("apt-get").args(quick).args(arguments).env("DEBIAN_FRONTEND", "noninteractive"))
    };
    let install = ["install", "--yes", "--no-install-recommends", "valgrind"];
    // The lists of packages of a fresh machine are often missing or old.
    let installed = apt(&install).or_else(|_| apt(&["update"]).and_then(|_| apt(&install)));
    installed.map(drop).context("valgrind is missing and could not be installed")
}

/// Builds the program and has valgrind count one frame by each method.
fn count(house: &House) -> Result<Counts> {
    // The scene is made by a program of the tests: in release it would take longer to compile than the method.
    house.build_products()?;
    pass_on(&mut house.cargo("build --release --locked -p objecthood-counted --features scalar"))?;
    let (program, folder) = (house.program("counted"), house.folder("instructions")?);
    let scene = folder.join("scene.frame");
    output(Command::new(house.target.join("debug/measure")).arg("demo").arg(&scene))?;
    METHODS
        .into_iter()
        .map(|method| Ok((method.to_owned(), count_one(&program, method, &scene, &folder)?)))
        .collect()
}

fn count_one(program: &Path, method: &str, scene: &Path, folder: &Path) -> Result<u64> {
    let profile = folder.join(format!("{method}.callgrind"));
    let out = format!("--callgrind-out-file={}", profile.display());
    let toggle = format!("--toggle-collect={COUNTED}");
    let mut valgrind = Command::new("valgrind");
    valgrind.env("GLIBC_TUNABLES", TUNABLES);
    valgrind.args(["--quiet", "--tool=callgrind", &out, &toggle]).arg(program).arg(method).arg(scene);
    output(&mut valgrind)?;
    let text = std::fs::read_to_string(&profile).with_context(|| format!("{}", profile.display()))?;
    total(&text).with_context(|| format!("{}: nothing was counted", profile.display()))
}

/// The sum that stands in a profile; none when it is 0, which says that the counted function was not found.
fn total(profile: &str) -> Option<u64> {
    let line = profile.lines().find_map(|line| line.strip_prefix("totals: "))?;
    line.trim().parse().ok().filter(|&count| count > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_percent_more_is_too_much() {
        assert!(Verdict::of(Some(100_000), 102_900).passes());
        assert!(Verdict::of(Some(100_000), 103_000).passes());
        assert!(!Verdict::of(Some(100_000), 103_100).passes());
        assert!(Verdict::of(Some(100_000), 97_000).passes());
        assert!(Verdict::of(Some(100_000), 20_000).passes());
        assert!(!Verdict::of(None, 1).passes());
        assert!(!Verdict::of(Some(0), 1).passes());
    }

    #[test]
    fn both_counts_are_said() {
        let said = Verdict::of(Some(200_000_000), 210_000_000).text(210_000_000);
        assert_eq!(said, "200.00 million instructions were known, now 210.00 (+5.00 %)");
        assert_eq!(Verdict::of(Some(100), 96), Verdict::Fallen(0.96 - 1.0));
    }

    #[test]
    fn what_is_written_is_read() {
        let counts = Counts::from([("context".to_owned(), 123), ("paper".to_owned(), 456)]);
        assert_eq!(toml::from_str::<Counts>(&text(&counts)).unwrap(), counts);
    }

    #[test]
    fn a_missing_file_says_how_it_is_made() {
        let error = read(Path::new("no/such/file.toml")).unwrap_err();
        assert!(format!("{error:#}").contains("cargo xtask bench --instructions"), "{error:#}");
    }

    #[test]
    fn the_sum_of_a_profile_is_found_and_nothing_is_no_count() {
        assert_eq!(total("version: 1\nsummary: 7\n\ntotals: 1234\n"), Some(1234));
        assert_eq!(total("totals: 0\n"), None);
        assert_eq!(total("version: 1\n"), None);
    }
}
