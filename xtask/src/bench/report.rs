//! What was measured, as a section of the document.

use std::fmt::Write;

use super::figures::Figures;
use super::machine::Machine;
use super::targets::TARGETS;
use crate::house::METHODS;

/// The stages in the order in which they are done; those of the other method are left out where there is nothing.
const STAGES: [&str; 12] = [
    "normals",
    "curvature",
    "structure",
    "superpixels",
    "facets",
    "borders",
    "shapes",
    "clusters",
    "support",
    "hypotheses",
    "objects",
    "total",
];

/// What is measured beside the methods: series and what it is.
const KERNELS: [(&str, &str); 19] = [
    ("context/alone/1", "`context`, one frame after the other"),
    ("context/alone/2", "`context`, one frame after the other on 2 threads"),
    ("paper/alone/1", "`paper`, one frame after the other"),
    ("paper/alone/2", "`paper`, one frame after the other on 2 threads"),
    ("reading/pcd/read", "reading a PCD file"),
    ("reading/png/read", "reading a pair of PNG files"),
    ("reading/mcap/read", "reading raw images of an MCAP file"),
    ("one pass", "one pass over the frame, 4 bytes a pixel read and 4 written: the yardstick"),
    ("graph", "graph segmentation of the colour image, ours"),
    ("opencv graph", "the same by OpenCV `createGraphSegmentation`"),
    ("skimage graph", "the same by scikit-image `felzenszwalb`"),
    ("integral-image normals", "integral-image normals of `paper`"),
    ("plane fits", "plane fits and windows of `context`: normals too"),
    ("pcl_normals/AVERAGE_3D_GRADIENT", "PCL normals, average 3D gradient"),
    ("pcl_normals/COVARIANCE_MATRIX", "PCL normals, covariance matrix"),
    ("pcl_normals/AVERAGE_DEPTH_CHANGE", "PCL normals, average depth change"),
    ("pcl_normals/SIMPLE_3D_GRADIENT", "PCL normals, simple 3D gradient"),
    ("lccp/TOTAL without load", "PCL VCCS and LCCP, tuned, all but reading"),
    ("omps/TOTAL without load", "PCL organized multi-plane and connected components, all but reading"),
];

/// The circumstances of the figures.
pub(crate) struct Run {
    pub(crate) machine: Machine,
    /// Other libraries with their versions.
    pub(crate) peers: Vec<String>,
    /// What was not there, with reasons.
    pub(crate) skipped: Vec<String>,
    pub(crate) rounds: usize,
    pub(crate) frames: usize,
}

/// The section; `growth` is over how many frames memory must not grow.
pub(crate) fn markdown(figures: &Figures, run: &Run, growth: usize) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail, here and below.
    let beside = if run.peers.is_empty() { "no other library".to_owned() } else { run.peers.join(", ") };
    let _ = writeln!(text, "{} Beside it: {beside}.\n", run.machine);
    let _ = writeln!(
        text,
        "Rounds: {}; frames: {} of mOSD learn. Within a round our methods, kernels and the Python peers take turns on every \
         frame. The programs around PCL, our methods alone and `objecthood segment` take turns as whole processes; the median over \
         the frames of a process counts as one value. Graph segmentation has σ = 0.5, k = 100 and at least 100 px everywhere, \
         smoothing included. Ratios are of medians, and of CPU time unless they say otherwise.\n",
        run.rounds, run.frames
    );
    for why in &run.skipped {
        let _ = writeln!(text, "Skipped: {why}\n");
    }
    targets(&mut text, figures);
    stages(&mut text, figures);
    kernels(&mut text, figures);
    costs(&mut text, figures, growth);
    text
}

fn targets(text: &mut String, figures: &Figures) {
    text.push_str("| | measured | target | stretch | |\n|---|---|---|---|---|\n");
    for target in &TARGETS {
        let measured = target.measured(figures);
        let value = measured.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}{}", target.unit));
        let stretch = target.stretch.map_or_else(String::new, |limit| target.limit(limit));
        let verdict = target.verdict(measured);
        let _ = writeln!(
            text,
            "| {} | {value} | {} | {stretch} | {verdict} |",
            target.what,
            target.limit(target.target)
        );
    }
}

fn stages(text: &mut String, figures: &Figures) {
    text.push_str(
        "\nMilliseconds a frame, median and quartiles. *Passes*: how often the frame could be read and written in the same time on \
         1 thread, at 4 bytes a pixel each:\n\n",
    );
    text.push_str(
        "| | stage | CPU, 1 thread | passes | wall, 1 thread | CPU, 2 threads | wall, 2 threads |\n|---|---|---|---|---|---|---|\n",
    );
    let one_pass = figures.median("one pass/cpu_ms");
    for method in METHODS {
        for stage in STAGES {
            if figures.count(&format!("{method}/1/{stage}/cpu_ms")) == 0 {
                continue;
            }
            let cell = |threads, quantity| spread(figures, &format!("{method}/{threads}/{stage}/{quantity}"));
            let passes = figures.median(&format!("{method}/1/{stage}/cpu_ms")).zip(one_pass);
            let passes = passes.map_or_else(|| "–".to_owned(), |(stage, one)| format!("{:.0}", stage / one));
            let cells =
                [cell(1, "cpu_ms"), passes, cell(1, "wall_ms"), cell(2, "cpu_ms"), cell(2, "wall_ms")];
            let _ = writeln!(text, "| `{method}` | {stage} | {} |", cells.join(" | "));
        }
    }
}

fn kernels(text: &mut String, figures: &Figures) {
    text.push_str("\n| alone, 1 thread unless it says 2 | CPU ms | wall ms | |\n|---|---|---|---|\n");
    for (series, what) in KERNELS {
        let segments = figures.median(&format!("{series}/segments")).map(|n| format!("{n:.0} segments"));
        let ours = figures.median(&format!("{series}/angle_deg"));
        // Angles are printed by the program around PCL as if they were times.
        let theirs = series.split_once('/').map(|(tag, kind)| format!("{tag}/deg to table {kind}/wall_ms"));
        let angle = ours.or_else(|| figures.median(&theirs?));
        let angle = angle.map(|angle| format!("{angle:.2}° to the table's plane"));
        let [cpu, wall] =
            ["cpu_ms", "wall_ms"].map(|quantity| spread(figures, &format!("{series}/{quantity}")));
        let _ = writeln!(text, "| {what} | {cpu} | {wall} | {} |", segments.or(angle).unwrap_or_default());
    }
}

fn costs(text: &mut String, figures: &Figures, growth: usize) {
    text.push_str(
        "\n| | allocations a frame | allocated a frame | peak of a process | resident after 100 frames | resident at the end | \
         the folder on 1 thread | on 2 |\n|---|---|---|---|---|---|---|---|\n",
    );
    for method in METHODS {
        let cell = |series: &str, unit: &str, scale: f64, digits: usize| {
            let median = figures.median(&series.replace('*', method));
            median.map_or_else(|| "–".to_owned(), |value| format!("{:.digits$}{unit}", value * scale))
        };
        let cells = [
            cell("*/1/allocations", "", 1.0, 0),
            cell("*/1/allocated_mb", " MB", 1.0, 1),
            cell("*/peak/mb", " MB", 1.0, 1),
            cell("*/resident warm/mb", " MB", 1.0, 1),
            cell("*/resident end/mb", " MB", 1.0, 1),
            cell("stream/*/1/wall_ms", " s", 1e-3, 2),
            cell("stream/*/2/wall_ms", " s", 1e-3, 2),
        ];
        let _ = writeln!(text, "| `{method}` | {} |", cells.join(" | "));
    }
    let _ = writeln!(
        text,
        "\nThe peak is that of `objecthood segment` on one frame. The folder is read, looked at and written as label images. *At the \
         end* is after {growth} frames, in one process that also holds all decoded frames. Allocations are those of one thread."
    );
}

/// Median and quartiles of a series.
fn spread(figures: &Figures, series: &str) -> String {
    figures.spread(series).map_or_else(|| "–".to_owned(), |spread| spread.to_string())
}
