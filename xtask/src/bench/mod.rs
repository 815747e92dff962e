//! `cargo xtask bench`: what a frame costs, beside other libraries, interleaved on the same frames in one run.

mod document;
mod figures;
mod machine;
mod ours;
mod pcl;
mod plot;
mod report;
pub(crate) mod scaling;
mod targets;

use anyhow::{Context, Result, bail};

use self::document::Document;
use self::figures::Figures;
use self::machine::Machine;
use self::ours::Program;
use self::pcl::Pcl;
use self::report::Run;
use crate::house::{House, files, pass_on};
use crate::python;

/// How much is measured.
pub(crate) struct Options {
    /// Few frames once, to see that everything runs; nothing is written.
    quick: bool,
    /// How often everything is measured.
    rounds: usize,
    /// How many frames memory must not grow over.
    frames: usize,
}

impl Options {
    /// Reads the command line; `None` when it is wrong.
    pub(crate) fn parse(arguments: &[&str]) -> Option<Self> {
        let quick = arguments.contains(&"--quick");
        let mut options =
            Self { quick, rounds: if quick { 1 } else { 5 }, frames: if quick { 200 } else { 1000 } };
        let mut rest = arguments.iter();
        while let Some(&argument) = rest.next() {
            match argument {
                "--quick" => (),
                "--rounds" => options.rounds = rest.next()?.parse().ok().filter(|&n| n > 0)?,
                "--frames" => options.frames = rest.next()?.parse().ok().filter(|&n| n > 0)?,
                _ => return None,
            }
        }
        Some(options)
    }
}

/// Measures, prints the ratios, and writes them to the document.
///
/// # Errors
/// Without the data; when a program cannot be built or run. A peer that is not there is only said to be skipped.
pub(crate) fn run(house: &House, options: &Options) -> Result<bool> {
    let Some(data) = house.data() else {
        bail!("no real data here: set OBJECTHOOD_DATA to the folder that holds mosd/learn")
    };
    let learn = data.join("mosd/learn");
    let every = if options.quick { 9 } else { 1 };
    let frames: Vec<_> = files(&learn, "pcd")?.into_iter().step_by(every).collect();
    let first = frames.first().context("mosd/learn is empty")?;

    build(house)?;
    let tools = house.folder("bench")?;
    let mut skipped = Vec::new();
    let requirements = house.root.join("crates/objecthood-bench/peers/requirements.txt");
    let python = python::prepare(&tools, &requirements);
    let python = python.map_err(|e| skipped.push(format!("OpenCV and scikit-image: {e:#}"))).ok();
    let pcl = Pcl::build(&data.join("../peers"), &tools.join("peers"));
    let pcl = pcl.map_err(|e| skipped.push(format!("PCL: {e:#}"))).ok();
    skipped.iter().for_each(|why| println!("skipped: {why}"));

    let program = Program::new(house)?;
    let mut figures = Figures::default();
    for round in 1..=options.rounds {
        println!("round {round} of {}: {} frames", options.rounds, frames.len());
        program.times(&frames, python.as_deref(), &mut figures)?;
        // What runs in processes of its own alternates in blocks.
        for block in 0..pcl::BLOCKS {
            if let Some(pcl) = &pcl {
                pcl.run(block, &learn, every, &mut figures)?;
            }
            program.alone(&frames, &mut figures)?;
            program.stream(&learn, &mut figures)?;
        }
        program.reading(&frames, &mut figures)?;
    }
    for _ in 0..options.rounds.max(3) {
        program.peak(first, &mut figures)?;
    }
    println!("memory over {} frames", options.frames);
    program.growth(options.frames, &frames, &mut figures)?;

    let mut peers = Vec::new();
    if python.is_some() {
        peers.extend(python::pins(&requirements)?);
    }
    peers.extend(pcl.map(|pcl| format!("PCL {} at -O2", pcl.version)));
    let run =
        Run { machine: Machine::here(house)?, peers, skipped, rounds: options.rounds, frames: frames.len() };
    let text = report::markdown(&figures, &run, options.frames);
    println!("\n{text}");
    if !options.quick {
        write(house, "bench", &text)?;
    }
    Ok(true)
}

/// Builds what is measured.
fn build(house: &House) -> Result<()> {
    pass_on(&mut house.cargo("build --release --locked -p objecthood-cli -p objecthood-bench"))
}

/// Puts a text into the section of this name of the document.
fn write(house: &House, section: &str, text: &str) -> Result<()> {
    const FILE: &str = "docs/performance.md";
    let file = house.root.join(FILE);
    let mut document = Document::read(&file)?;
    document.set(section, text)?;
    document.write(&file)?;
    println!("written: {FILE}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_wrong_ones_refused() {
        let options = Options::parse(&["--rounds", "7", "--quick"]).unwrap();
        assert_eq!((options.quick, options.rounds, options.frames), (true, 7, 200));
        for wrong in [&["--rounds"][..], &["--rounds", "0"], &["--frames", "many"], &["--fast"]] {
            assert!(Options::parse(wrong).is_none(), "{wrong:?}");
        }
    }
}
