//! What the tests of both methods share: small scenes, and the label maps of the stages.
#![allow(dead_code, unused_imports, reason = "each test uses a part")]

mod invariants;
#[path = "../../examples/world/mod.rs"]
mod world;

use objecthood::{Discovery, Frame, Observer, Output, Params, Segments, discover_observed};
use world::{Solid, snapshot};

pub(crate) use invariants::{check_descriptions, check_edges, check_scene};

pub(crate) const RED: [u8; 3] = [180, 40, 30];
pub(crate) const BLUE: [u8; 3] = [30, 70, 150];
const GREY: [u8; 3] = [90, 90, 95];

/// Two boxes side by side on the table.
pub(crate) fn two_boxes() -> Frame {
    snapshot(&[
        Solid { base_m: [-0.15, 0.0, 0.0], size_m: [0.18, 0.14, 0.12], yaw_deg: 25.0, color: RED },
        Solid { base_m: [0.17, 0.05, 0.0], size_m: [0.14, 0.14, 0.18], yaw_deg: -30.0, color: BLUE },
    ])
}

/// A box on a box: each has its own colour, the upper one is smaller.
pub(crate) fn stack() -> Frame {
    stack_of([RED, BLUE])
}

/// The same of these colours, the lower one first.
pub(crate) fn stack_of([below, above]: [[u8; 3]; 2]) -> Frame {
    snapshot(&[
        Solid { base_m: [0.0, 0.0, 0.0], size_m: [0.3, 0.25, 0.12], yaw_deg: 10.0, color: below },
        Solid { base_m: [0.0, 0.02, 0.12], size_m: [0.14, 0.12, 0.12], yaw_deg: 30.0, color: above },
    ])
}

/// A board on a box, which it overhangs by this much on all sides.
pub(crate) fn covered_box(board_m: f64, overhang_m: f64) -> Frame {
    let size_m = [0.2, 0.15, 0.12];
    let board = [size_m[0] + 2.0 * overhang_m, size_m[1] + 2.0 * overhang_m, board_m];
    snapshot(&[
        Solid { base_m: [0.0, 0.0, 0.0], size_m, yaw_deg: 20.0, color: RED },
        Solid { base_m: [0.0, 0.0, size_m[2]], size_m: board, yaw_deg: 20.0, color: BLUE },
    ])
}

/// A pole before a wide box, which it cuts in two in the image.
pub(crate) fn cut_box() -> Frame {
    snapshot(&[
        Solid { base_m: [0.0, 0.1, 0.0], size_m: [0.32, 0.1, 0.16], yaw_deg: 0.0, color: RED },
        pole(),
    ])
}

/// The same pole before two boxes, one of which stands nearer and is turned.
pub(crate) fn pole_before_two_boxes() -> Frame {
    snapshot(&[
        Solid { base_m: [-0.12, 0.12, 0.0], size_m: [0.16, 0.1, 0.16], yaw_deg: 0.0, color: RED },
        Solid { base_m: [0.13, 0.05, 0.0], size_m: [0.16, 0.1, 0.13], yaw_deg: 25.0, color: RED },
        pole(),
    ])
}

fn pole() -> Solid {
    Solid { base_m: [0.0, -0.12, 0.0], size_m: [0.05, 0.05, 0.3], yaw_deg: 0.0, color: GREY }
}

/// Keeps the label maps of all stages.
#[derive(Default)]
pub(crate) struct Maps(pub(crate) Vec<(&'static str, Segments)>);

impl Observer for Maps {
    fn observe(&mut self, output: Output<'_>) {
        match output {
            Output::Structure(s) => self.0.push(("structure", s.segments().into_owned())),
            Output::Superpixels(s) => self.0.push(("superpixels", s.segments().into_owned())),
            Output::Facets(s) => self.0.push(("facets", s.clone())),
            Output::Shapes(s) => self.0.push(("shapes", s.segments().into_owned())),
            _ => {}
        }
    }
}

/// The outcome of a frame and the label maps on the way to it.
pub(crate) fn observed(frame: &Frame, params: &Params) -> (Discovery, Maps) {
    let mut maps = Maps::default();
    let found = discover_observed(frame, params, &mut maps).expect("the scene is valid");
    (found, maps)
}

/// The label map of every stage as text, the objects last.
pub(crate) fn drawn_stages(frame: &Frame, params: &Params) -> Vec<(&'static str, String)> {
    let (found, maps) = observed(frame, params);
    let stages = maps.0.iter().map(|(stage, s)| (*stage, drawn(frame, |i| s.labels()[i].into())));
    let objects = drawn(frame, |i| i64::from(found.labels[i]) - 1);
    stages.chain([("objects", objects)]).collect()
}

/// Every fourth pixel of a label map as text: `.` = none or no depth, then 0-9, a-z by first appearance, `#` beyond;
/// and below it a hash of the whole map.
fn drawn(frame: &Frame, label: impl Fn(usize) -> i64) -> String {
    let (width, height) = frame.size();
    let mut seen = Vec::new();
    let mut text = String::new();
    for v in (0..height).step_by(4) {
        for i in (0..width).step_by(4).map(|u| v * width + u) {
            if label(i) < 0 || !frame.is_valid(i) {
                text.push('.');
                continue;
            }
            let number = seen.iter().position(|&l| l == label(i)).unwrap_or_else(|| {
                seen.push(label(i));
                seen.len() - 1
            });
            text.push(char::from_digit(number as u32, 36).unwrap_or('#'));
        }
        text.push('\n');
    }
    // FNV-1a.
    let hash = (0..width * height).fold(0xcbf2_9ce4_8422_2325_u64, |hash, i| {
        (hash ^ label(i) as u64).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{text}{hash:016x}")
}
