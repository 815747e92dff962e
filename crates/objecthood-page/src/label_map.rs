//! Label maps of stages, with a colour for every label.

use objecthood::{Frame, Segments};
use objecthood_view::stage_colors;

use crate::maps::map;
use crate::pack::{Kind, Map};

/// The labels of a stage, counted from 1, 0 = none or no depth; and the colour of every label, 0 too: the first `structure` of them
/// are grey. O(pixels).
pub(crate) fn labelled(name: &str, frame: &Frame, segments: &Segments, structure: usize) -> [Map; 2] {
    let labels = segments.labels();
    let number = |(i, &label): (usize, &i32)| if frame.is_valid(i) { (label + 1) as u32 } else { 0 };
    let numbers = labels.as_slice().iter().enumerate().map(number);
    let (kind, bytes) = if segments.count() < usize::from(u16::MAX) {
        (Kind::U16, numbers.flat_map(|n| (n as u16).to_le_bytes()).collect())
    } else {
        (Kind::U32, numbers.flat_map(u32::to_le_bytes).collect())
    };
    let mut colors = vec![[0; 3]; segments.count() + 1];
    let chosen = stage_colors(labels, segments.count(), structure);
    for (color, chosen) in colors[1..].iter_mut().zip(chosen) {
        *color = chosen.map_or([0; 3], |rgb| rgb.0);
    }
    let colors = map(&format!("{name}.colors"), Kind::Rgb, (colors.len(), 1), colors.as_flattened().to_vec());
    [map(name, kind, labels.size(), bytes), colors]
}
