//! Ten frames of an Xtion with label images (`ycb-video`): a foam brick, a mug and a box come out whole.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "what fails or was measured is reported so")]

mod common;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use common::{Folder, command, data};
use objecthood::Raster;
use objecthood_io::label_image;

/// A thing is whole when one hypothesis covers it with this intersection over union.
const WHOLE_IOU: f64 = 0.6;
const FRAMES: std::ops::RangeInclusive<usize> = 1..=10;

fn labels(file: &Path) -> Raster<u16> {
    label_image::decode(&std::fs::read(file).unwrap()).unwrap()
}

/// The best IoU of each thing with a hypothesis, on the pixels with depth. What the truth calls 0 is background.
fn best_overlaps(truth: &Raster<u16>, found: &Raster<u16>, depth: &[u16]) -> Vec<f64> {
    let [mut of_thing, mut of_hypothesis] = [BTreeMap::<u16, usize>::new(), BTreeMap::new()];
    let mut common = BTreeMap::<(u16, u16), usize>::new();
    for (i, _) in depth.iter().enumerate().filter(|(_, depth)| **depth > 0) {
        let (thing, hypothesis) = (truth[i], found[i]);
        *of_thing.entry(thing).or_default() += 1;
        *of_hypothesis.entry(hypothesis).or_default() += 1;
        *common.entry((thing, hypothesis)).or_default() += 1;
    }
    let iou = |(&(thing, hypothesis), &shared): (&(u16, u16), &usize)| {
        shared as f64 / (of_thing[&thing] + of_hypothesis[&hypothesis] - shared) as f64
    };
    let best = |thing: u16| {
        let pairs = common.iter().filter(|((of, hypothesis), _)| *of == thing && *hypothesis > 0);
        pairs.map(iou).fold(0.0, f64::max)
    };
    of_thing.keys().filter(|thing| **thing > 0).map(|&thing| best(thing)).collect()
}

#[test]
fn three_things_are_whole_in_each_of_ten_frames() {
    let Some(data) = data() else { return };
    let (from, to) = (data.join("stills/ycb-video"), Folder::new());
    let arguments =
        "--color *-color.png --depth *-depth.png --camera 1066.78,1067.49,312.99,241.31 --depth-scale 10000";
    command()
        .current_dir(&from)
        .args(["segment", "--write", "labels", "--out"])
        .arg(to.path())
        .args(arguments.split_whitespace())
        .assert()
        .success();
    let mut all = Vec::new();
    for frame in FRAMES {
        let found = labels(&to.path().join(format!("{frame:06}.labels.png")));
        let truth = labels(&from.join(format!("{frame:06}-label.png")));
        let depth = image::open(from.join(format!("{frame:06}-depth.png"))).unwrap().into_luma16();
        let overlaps = best_overlaps(&truth, &found, depth.as_raw());
        let hypotheses: BTreeSet<u16> = found.as_slice().iter().copied().filter(|&label| label > 0).collect();
        println!("{frame}: IoU {overlaps:.3?}, {} hypotheses", hypotheses.len());
        assert_eq!(overlaps.len(), 3, "{frame}");
        all.extend(overlaps);
    }
    let whole = all.iter().filter(|iou| **iou >= WHOLE_IOU).count();
    let least = all.iter().copied().fold(1.0, f64::min);
    println!("{whole} of {} whole, at IoU {least:.3} or more", all.len());
    assert_eq!(whole, 30);
}
