//! `cargo xtask bench --scaling`: how time and memory grow with pixels and with things, on synthetic scenes.

use std::fmt::Write;

use anyhow::{Context, Result};

use super::figures::{Figures, Spread};
use super::machine::Machine;
use super::ours::Program;
use super::plot::Plot;
use super::{build, write};
use crate::house::{House, METHODS, files};

const ROUNDS: usize = 3;
/// The least things and the most that are compared, and how much longer the most may take.
const THINGS: [&str; 2] = ["5", "80"];
const THINGS_LIMIT: f64 = 1.7;
/// Columns of 0.3 and of 2.1 megapixels, and how much longer a pixel may take.
const WIDTHS: [&str; 2] = ["640", "1680"];
const WIDTHS_LIMIT: f64 = 1.5;

/// What was measured at one size or number: pixels a frame, CPU milliseconds and peak memory of `segment`.
struct Point {
    level: String,
    pixels: f64,
    ms: Spread,
    mb: f64,
}

impl Point {
    fn us_per_px(&self) -> f64 {
        1e3 * self.ms.median / self.pixels
    }

    fn megapixels(&self) -> f64 {
        self.pixels / 1e6
    }
}

/// Measures, draws, and writes both to the document.
///
/// # Errors
/// When a program cannot be built or run, or a file cannot be written.
pub(crate) fn run(house: &House) -> Result<bool> {
    build(house)?;
    let program = Program::new(house)?;
    let folder = house.folder("bench/growing")?;
    println!("drawing the scenes");
    program.scenes(&folder)?;
    let frames = files(&folder, "pcd")?;

    let mut figures = Figures::default();
    for round in 1..=ROUNDS {
        println!("round {round} of {ROUNDS}: {} frames", frames.len());
        let mut by_frame = Figures::default();
        program.times_by_frame(&frames, &mut by_frame)?;
        for method in METHODS {
            for file in &frames {
                let name = file.file_stem().context("a file without a name")?.to_string_lossy();
                let (kind, _seed) = name.rsplit_once('-').context("a scene without a seed")?;
                let ms = by_frame.median(&format!("{name}/{method}/1/total/cpu_ms")).context("no time")?;
                figures.add(format!("{method}/{kind}/cpu_ms"), ms);
                let peak_mb = program.segment(file, method, "1")?.peak_mb;
                figures.add(format!("{method}/{kind}/mb"), peak_mb);
            }
        }
    }

    let curves = |kind: &str| -> Vec<(&str, Vec<Point>)> {
        METHODS.iter().map(|method| (*method, points(&figures, method, kind))).collect()
    };
    let (sizes, things) = (curves("size"), curves("objects"));
    let text = format!("{}\n\n{}", Machine::here(house)?, markdown(&sizes, &things));
    println!("\n{text}");
    draw(house, &sizes, &things)?;
    write(house, "scaling", &text)?;
    Ok(true)
}

/// The points of a curve, by size.
fn points(figures: &Figures, method: &str, kind: &str) -> Vec<Point> {
    let start = format!("{method}/{kind}-");
    let mut levels: Vec<&str> = figures.between(&start, "/cpu_ms").collect();
    levels.sort_by_key(|level| (level.len(), *level));
    let point = |level: &str| {
        let spread = |quantity| figures.spread(&format!("{start}{level}/{quantity}"));
        let width = if kind == "size" { level.parse().ok()? } else { 640.0 };
        let (ms, mb) = (spread("cpu_ms")?, spread("mb")?.median);
        Some(Point { level: level.to_owned(), pixels: width * width * 0.75, ms, mb })
    };
    levels.into_iter().filter_map(point).collect()
}

fn markdown(sizes: &[(&str, Vec<Point>)], things: &[(&str, Vec<Point>)]) -> String {
    let mut text = String::new();
    text.push_str(
        "Median and quartiles over three scenes and three rounds, CPU on one thread; memory is the peak of `objecthood segment`, what is paid \
         for the program itself included.\n\n",
    );
    text.push_str("| 20 things on a table | image | megapixels | ms | µs a pixel | peak MB | bytes a pixel more |\n|---|---|---|---|---|---|---|\n");
    // Writing to a string cannot fail, here and below.
    for (method, points) in sizes {
        let mut before: Option<&Point> = None;
        for point in points {
            let more = before.map_or_else(String::new, |b| {
                format!("{:.0}", 1e6 * (point.mb - b.mb) / (point.pixels - b.pixels))
            });
            let height = point.pixels / point.level.parse::<f64>().unwrap_or(1.0);
            let _ = writeln!(
                text,
                "| `{method}` | {} x {height:.0} | {:.2} | {:.1} | {:.3} | {:.1} | {more} |",
                point.level,
                point.megapixels(),
                point.ms,
                point.us_per_px(),
                point.mb
            );
            before = Some(point);
        }
    }
    text.push_str("\n| 640 x 480 | things | ms | peak MB |\n|---|---|---|---|\n");
    for (method, points) in things {
        for Point { level, ms, mb, .. } in points {
            let _ = writeln!(text, "| `{method}` | {level} | {ms:.1} | {mb:.1} |");
        }
    }
    text.push_str("\n| | measured | target | |\n|---|---|---|---|\n");
    for (curves, levels, limit, what) in [
        (sizes, WIDTHS, WIDTHS_LIMIT, "time a pixel at 2.1 megapixels against 0.3"),
        (things, THINGS, THINGS_LIMIT, "80 things against 5"),
    ] {
        for (method, points) in curves {
            let at = |level: &str| points.iter().find(|point| point.level == level).map(Point::us_per_px);
            let [low, high] = levels.map(at);
            let (ratio, verdict) = match high.zip(low).map(|(high, low)| high / low) {
                Some(ratio) if ratio <= limit => (format!("{ratio:.2} x"), "met"),
                Some(ratio) => (format!("{ratio:.2} x"), "**missed**"),
                None => ("–".to_owned(), "not measured"),
            };
            let _ = writeln!(text, "| `{method}`, {what} | {ratio} | ≤ {limit} x | {verdict} |");
        }
    }
    text.push_str(
        "\n![time a pixel over megapixels](pictures/growth-time.svg)\n![peak memory over megapixels](pictures/growth-memory.svg)\n\
         ![time over things](pictures/growth-things.svg)\n",
    );
    text
}

fn draw(house: &House, sizes: &[(&str, Vec<Point>)], things: &[(&str, Vec<Point>)]) -> Result<()> {
    let plot = |file: &str, curves: &[(&str, Vec<Point>)], words: [&str; 3], of: fn(&Point) -> [f64; 2]| {
        let curves = curves.iter().map(|(method, points)| (*method, points.iter().map(of).collect()));
        let [title, across, up] = words;
        let svg = Plot { title, across, up, curves: curves.collect() }.svg();
        let file = house.root.join("docs/pictures").join(file);
        std::fs::write(&file, svg).with_context(|| format!("{}", file.display()))
    };
    let (megapixels, one) = ("megapixels", "CPU on one thread");
    plot("growth-time.svg", sizes, [one, megapixels, "µs a pixel"], |p| [p.megapixels(), p.us_per_px()])?;
    plot("growth-memory.svg", sizes, ["peak memory of segment", megapixels, "MB"], |p| {
        [p.megapixels(), p.mb]
    })?;
    plot("growth-things.svg", things, [one, "things on the table", "ms a frame"], |p| {
        [p.level.parse().unwrap_or(0.0), p.ms.median]
    })
}
