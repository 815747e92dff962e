//! Measures frames and writes a line for every figure; see `objecthood_bench::figure`.

#![expect(clippy::print_stdout, reason = "its output is what it is for")]

use std::alloc::System;
use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;
use objecthood_bench::figure::Figure;
use objecthood_bench::graph::color_alone;
use objecthood_bench::peer::Peer;
use objecthood_bench::reading::reading;
use objecthood_bench::recomputed::recomputed;
use objecthood_bench::times::{Bench, METHODS, Named, alone, open};
use objecthood_bench::track::track;
use objecthood_bench::{growth, scenes};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

#[derive(Parser)]
#[command(about)]
enum Task {
    /// Times of both methods, of kernels and, with --python and --script, of peers, frame by frame.
    Times {
        #[arg(long, requires = "script")]
        python: Option<PathBuf>,
        #[arg(long)]
        script: Option<PathBuf>,
        files: Vec<PathBuf>,
    },
    /// Times of each method alone, frame after frame on 1 and on 2 threads, as peers in processes of their own run.
    Alone { files: Vec<PathBuf> },
    /// Memory after 100 and after COUNT frames, for each method.
    Growth { count: usize, files: Vec<PathBuf> },
    /// Times of reading files beside the method; the frames are stored in FOLDER in other formats.
    Reading { folder: PathBuf, files: Vec<PathBuf> },
    /// Times of finding and of following objects in a clip, as `objecthood synth --video` writes it, on one thread.
    Track { folder: PathBuf },
    /// What a change of each parameter computes again, as a share of a whole frame, for each method.
    Recomputed { files: Vec<PathBuf> },
    /// Writes synthetic scenes of growing size and growing number of things to a folder.
    Scenes { folder: PathBuf },
    /// Writes the frame whose instructions `counted` has counted: the scene of `objecthood demo`.
    Demo { file: PathBuf },
}

fn main() -> Result<()> {
    match Task::parse() {
        Task::Times { python, script, files } => {
            let peer = match (python, script) {
                (Some(python), Some(script)) => Some(Peer::start(&python, &script, &color_alone())?),
                _ => None,
            };
            // All frames are read before the first is measured.
            let frames = files.iter().map(|file| open(file)).collect::<Result<Vec<_>>>()?;
            let mut bench = Bench::new(ALLOCATOR, peer)?;
            // Once without looking: threads, pages and caches of all are warm.
            if let Some(first) = frames.first() {
                bench.measure(first, &mut Vec::new())?;
            }
            for frame in &frames {
                let mut figures = Vec::new();
                bench.measure(frame, &mut figures)?;
                figures.iter().for_each(|figure| println!("{figure}"));
            }
        }
        Task::Alone { files } => {
            let frames = files.iter().map(|file| open(file)).collect::<Result<Vec<_>>>()?;
            alone(&frames)?.iter().for_each(|figure| println!("{figure}"));
        }
        Task::Growth { count, files } => {
            let frames = files.iter().map(|file| Ok(open(file)?.frame)).collect::<Result<Vec<_>>>()?;
            for (name, method) in METHODS {
                let [warm, end] = growth::growth(&frames, method, count)?;
                for (when, value) in [("warm", warm), ("end", end)] {
                    let series = format!("{name}/resident {when}/mb");
                    println!("{}", Figure { frame: "all".into(), series, value });
                }
            }
        }
        Task::Reading { folder, files } => {
            reading(&files, &folder)?.iter().for_each(|figure| println!("{figure}"));
        }
        Task::Track { folder } => track(&folder)?.iter().for_each(|figure| println!("{figure}")),
        Task::Recomputed { files } => {
            for file in files {
                let Named { name, frame } = open(&file)?;
                for (_, method) in METHODS {
                    let figures = recomputed(&name, &frame, method)?;
                    figures.iter().for_each(|figure| println!("{figure}"));
                }
            }
        }
        Task::Scenes { folder } => scenes::write_growing(&folder)?,
        Task::Demo { file } => scenes::write_demo(&file)?,
    }
    Ok(())
}
