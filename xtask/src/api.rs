//! The public API of the core as a listing, so that no change of it goes unnoticed.
//!
//! Only rustdoc knows all of it: most parameters come out of a macro. Its JSON output is not stable yet, so rustdoc alone runs with
//! `RUSTC_BOOTSTRAP`; for cargo and the compiler nothing changes and what they have built stays. The format belongs to the toolchain that
//! `rust-toolchain.toml` names: with another toolchain the crate `public-api` may have to be updated too.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, ExitCode};

use anyhow::{Context, Result};
use public_api::Builder;

use crate::house::{House, output};

/// Where the listing stands.
const FILE: &str = "crates/objecthood/api.txt";
const ANEW: &str = "`cargo xtask api` writes the listing anew";
const HEADER: &str = "# What users of the crate objecthood can name. `cargo xtask test` fails when the code differs; `cargo xtask api` writes this file.
";
/// Set when cargo runs this program in the place of rustdoc.
const AS_RUSTDOC: &str = "OBJECTHOOD_XTASK_AS_RUSTDOC";

/// Runs rustdoc with unstable options if that is what this program was started for.
pub(crate) fn run_as_rustdoc() -> Option<ExitCode> {
    std::env::var_os(AS_RUSTDOC)?;
    let mut rustdoc = Command::new("rustdoc");
    let status = rustdoc.args(std::env::args_os().skip(1)).env("RUSTC_BOOTSTRAP", "1").status();
    Some(if status.is_ok_and(|status| status.success()) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Compares the API with the listing that stands in the repository; says what is gone (-) and what is new (+).
///
/// # Errors
/// When rustdoc fails or the listing cannot be read.
pub(crate) fn check(house: &House) -> Result<bool> {
    let listed = std::fs::read_to_string(house.root.join(FILE)).with_context(|| format!("{FILE}: {ANEW}"))?;
    let difference = difference(&listed, &listing(house)?);
    print!("{difference}");
    if !difference.is_empty() {
        println!(
            "{FILE} differs from the code. If that is meant to be so: {ANEW}; CHANGELOG.md tells users what changed."
        );
    }
    Ok(difference.is_empty())
}

/// Writes the listing anew.
///
/// # Errors
/// When rustdoc fails or the file cannot be written.
pub(crate) fn bless(house: &House) -> Result<bool> {
    std::fs::write(house.root.join(FILE), listing(house)?).with_context(|| FILE.to_owned())?;
    println!("written: {FILE}");
    Ok(true)
}

fn listing(house: &House) -> Result<String> {
    let mut rustdoc = house.cargo(
        "rustdoc --quiet --package objecthood --lib --locked -- -Z unstable-options --output-format json",
    );
    rustdoc.env("RUSTDOC", std::env::current_exe().context("this program has no path")?).env(AS_RUSTDOC, "1");
    output(&mut rustdoc)?;
    listing_of(&house.target.join("doc/objecthood.json"))
}

/// The items in the order of their paths, then what is derived for each type.
fn listing_of(json: &Path) -> Result<String> {
    let lines = |omit_derived: bool| -> Result<Vec<String>> {
        let builder = Builder::from_rustdoc_json(json).omit_blanket_impls(true).omit_auto_trait_impls(true);
        let api = builder.omit_auto_derived_impls(omit_derived).build();
        let api =
            api.context("the crate `public-api` does not understand this toolchain's rustdoc: update it")?;
        Ok(api.items().map(ToString::to_string).collect())
    };
    let items = lines(true)?;
    let own: BTreeSet<&String> = items.iter().collect();
    let mut listing = HEADER.to_owned();
    items.iter().for_each(|item| _ = writeln!(listing, "{item}"));
    listing.push_str("\n# Derived\n");
    for (of, traits) in derived(lines(false)?.iter().filter(|line| !own.contains(line))) {
        let _ = writeln!(listing, "{of}: {}", traits.into_iter().collect::<Vec<_>>().join(", "));
    }
    Ok(listing)
}

/// The derived traits of each type, of lines as in `impl core::clone::Clone for objecthood::Camera`; their methods are left out.
fn derived<'a>(lines: impl Iterator<Item = &'a String>) -> BTreeMap<&'a str, BTreeSet<&'a str>> {
    let mut derived: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for line in lines.filter(|line| line.starts_with("impl")) {
        let Some((implemented, of)) = line.split_once(" for ") else { continue };
        let of = of.split(" where ").next().unwrap_or(of);
        let path = implemented.rsplit_once(' ').map_or(implemented, |(_, path)| path);
        let path = path.split('<').next().unwrap_or(path);
        let name = path.rsplit("::").next().unwrap_or(path);
        if name != "StructuralPartialEq" {
            derived.entry(of).or_default().insert(name);
        }
    }
    derived
}

fn difference(listed: &str, found: &str) -> String {
    let [listed, found] = [listed, found].map(|text| text.lines().collect::<BTreeSet<_>>());
    let gone = listed.difference(&found).map(|line| format!("- {line}\n"));
    let new = found.difference(&listed).map(|line| format!("+ {line}\n"));
    gone.chain(new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_gone_and_what_is_new_is_said() {
        assert_eq!(difference("a\nb\nc\n", "a\nc\nd\n"), "- b\n+ d\n");
        assert_eq!(difference("a\nb\n", "a\nb\n"), "");
    }

    #[test]
    fn derived_traits_are_gathered_by_type() {
        let lines = [
            "impl core::clone::Clone for a::Camera",
            "pub fn a::Camera::clone(&self) -> a::Camera",
            "impl<'de> serde_core::de::Deserialize<'de> for a::Camera where a::Camera: core::default::Default",
            "impl core::marker::StructuralPartialEq for a::Camera",
            "impl<E: core::fmt::Debug> core::fmt::Debug for a::Edge<E>",
            "impl core::marker::Copy for a::Camera",
        ]
        .map(str::to_owned);
        let derived = derived(lines.iter());
        assert_eq!(derived["a::Camera"], BTreeSet::from(["Clone", "Copy", "Deserialize"]));
        assert_eq!(derived["a::Edge<E>"], BTreeSet::from(["Debug"]));
    }
}
