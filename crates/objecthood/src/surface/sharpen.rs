//! Restores edges that were smeared (docs/CONTEXT.md 0.7, ours, because every stage looks for steps).
//!
//! Phones and filled depth show no steps: over 6 to 14 px, depth goes smoothly from a thing to what is behind
//! it. Stereo smears edges over its matching window. Such a ramp looks like a steep face of the thing.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::raster::Raster;
use crate::surface::disparity::DisparitySpace;
use crate::surface::ramps::{Limits, Line, Restored};

/// Two pixels this far apart in a row or column (px at a focal length of 525 px) ...
const PAIR_PX: usize = 8;
/// ... that differ by more than this have an edge between them (quanta).
const EDGE_QUANTA: f32 = 40.0;
/// ... and at least this far apart in the image (px): a step fits between them with a pixel beside it.
const LEAST_PAIR_PX: usize = 4;
/// An edge is sharp when one step from a pixel to the next makes more than this share of the difference.
const STEP_SHARE: f32 = 0.6;
/// Edges are smeared when a smaller share of them is sharp. Smoothed depth has 0.01; raw depth has 0.6 and more, by flying pixels and narrow
/// side faces.
const LEAST_SHARP: f32 = 0.5;
/// With fewer edges nothing is decided.
const LEAST_EDGES: usize = 20;
/// Rows and columns are sampled at this distance.
const STRIDE_PX: usize = 4;

/// Restores the edges of a disparity image (quanta) if they were smeared: every pixel on a ramp takes the
/// disparity of the surface before or behind the edge. `None` if its edges are sharp. `is_matched`: whether
/// the sensor matches windows. `color`, of the same size, shows where in a ramp the edge is. O(pixels),
/// parallel over rows and columns.
pub(super) fn sharpen(
    disparity: &Raster<f32>,
    color: Option<&Raster<[u8; 3]>>,
    is_matched: bool,
    space: &DisparitySpace,
) -> Option<Raster<f32>> {
    if !is_matched && !is_smeared(disparity, space) {
        return None;
    }
    let limits = &Limits::of(space);
    let along = restore_rows(disparity, color, limits);
    let (turned, turned_color) = (transposed(disparity), color.map(transposed));
    let down = transposed(&restore_rows(&turned, turned_color.as_ref(), limits));
    let mut sharp = disparity.clone();
    let both = along.as_slice().iter().zip(down.as_slice());
    for (d, (along, down)) in sharp.as_mut_slice().iter_mut().zip(both) {
        // The shorter ramp crosses the edge more squarely.
        let restored = if down.length_px < along.length_px { down } else { along };
        if !restored.disparity.is_nan() {
            *d = restored.disparity;
        }
    }
    Some(sharp)
}

/// Whether most edges extend over several pixels.
fn is_smeared(disparity: &Raster<f32>, space: &DisparitySpace) -> bool {
    let (width, height) = disparity.size();
    let span = space.length_px(PAIR_PX).max(LEAST_PAIR_PX);
    let rows = (0..height).step_by(STRIDE_PX).map(|v| count_edges(|u| disparity[v * width + u], width, span));
    let columns =
        (0..width).step_by(STRIDE_PX).map(|u| count_edges(|v| disparity[v * width + u], height, span));
    let (edges, sharp) = rows.chain(columns).fold((0, 0), |sum, line| (sum.0 + line.0, sum.1 + line.1));
    edges >= LEAST_EDGES && (sharp as f32) < LEAST_SHARP * edges as f32
}

/// Counts the edges of a line, and how many of them are sharp. An edge with a hole is sharp, because a hole
/// leaves nothing smeared.
fn count_edges(disparity: impl Fn(usize) -> f32, length: usize, span: usize) -> (usize, usize) {
    let (mut edges, mut sharp) = (0, 0);
    for start in (0..length.saturating_sub(span)).step_by(span) {
        let difference = (disparity(start + span) - disparity(start)).abs();
        if difference > EDGE_QUANTA {
            let is_step = |k: usize| {
                let step = (disparity(k + 1) - disparity(k)).abs();
                step.is_nan() || step > STEP_SHARE * difference
            };
            edges += 1;
            sharp += usize::from((start..start + span).any(is_step));
        }
    }
    (edges, sharp)
}

fn restore_rows(
    disparity: &Raster<f32>,
    color: Option<&Raster<[u8; 3]>>,
    limits: &Limits,
) -> Raster<Restored> {
    let width = disparity.width();
    let mut restored = Buffer::filled(disparity.len(), Restored::NONE);
    restored.par_chunks_mut(width).enumerate().for_each(|(v, restored)| {
        let row = v * width..(v + 1) * width;
        let color = color.map(|color| &color.as_slice()[row.clone()]);
        Line { disparity: &disparity.as_slice()[row], color }.restore(restored, limits);
    });
    disparity.with_data(restored)
}

/// The image with rows and columns exchanged.
fn transposed<T: Copy + Send + Sync + 'static>(image: &Raster<T>) -> Raster<T> {
    let (width, height) = image.size();
    let mut turned = Buffer::stale(image.len(), image[0]);
    turned.par_chunks_mut(height).enumerate().for_each(|(u, column)| {
        let seen = image.as_slice()[u..].iter().step_by(width);
        column.iter_mut().zip(seen).for_each(|(pixel, seen)| *pixel = *seen);
    });
    Raster::from_vec(height, width, turned.into_vec()).expect("as many pixels as before")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{kinect, space};

    const SIZE: usize = 80;
    const BEHIND: f32 = 500.0;
    const BEFORE: f32 = 600.0;

    /// An edge across the columns, smeared over so many of them.
    fn edge(over_px: usize) -> Raster<f32> {
        let share = |u: usize| (u as f32 - 28.0) / over_px as f32;
        let at = |i: usize| BEHIND + (BEFORE - BEHIND) * share(i % SIZE).clamp(0.0, 1.0);
        Raster::from_vec(SIZE, SIZE, (0..SIZE * SIZE).map(at).collect()).unwrap()
    }

    fn has_two_levels(disparity: &Raster<f32>) -> bool {
        let near = |d: &f32, level: f32| (d - level).abs() < 0.01;
        disparity.as_slice().iter().all(|d| near(d, BEHIND) || near(d, BEFORE))
    }

    #[test]
    fn a_smeared_edge_becomes_a_step_along_rows_and_along_columns() {
        let smeared = edge(8);
        for disparity in [transposed(&smeared), smeared] {
            assert!(!has_two_levels(&disparity));
            let sharp = sharpen(&disparity, None, false, &kinect()).unwrap();
            assert!(has_two_levels(&sharp), "{:?}", &sharp.as_slice()[..SIZE]);
        }
    }

    #[test]
    fn colour_tells_where_the_edge_is() {
        let smeared = edge(8);
        // Half of the depth is at column 32, the change of colour at column 30.
        let color =
            smeared.with_data((0..SIZE * SIZE).map(|i| [if i % SIZE < 30 { 250 } else { 20 }; 3]).collect());
        let steps = |color| {
            let sharp = sharpen(&smeared, color, false, &kinect()).unwrap();
            sharp.as_slice()[..SIZE].iter().filter(|&&d| d < 550.0).count()
        };
        assert_eq!(steps(Some(&color)), 30);
        assert_eq!(steps(None), 32);
    }

    #[test]
    fn sharp_edges_stay_as_they_are() {
        let sharp = edge(1);
        assert!(sharpen(&sharp, None, false, &kinect()).is_none());
        let matched = sharpen(&sharp, None, true, &kinect()).unwrap();
        assert_eq!(matched.as_slice(), sharp.as_slice(), "a sensor that matches windows: a step is no ramp");
    }

    #[test]
    fn a_hole_at_the_edge_leaves_it_sharp() {
        let mut holed = edge(8);
        holed.as_mut_slice().iter_mut().skip(31).step_by(SIZE).for_each(|d| *d = f32::NAN);
        holed.as_mut_slice().iter_mut().skip(33).step_by(SIZE).for_each(|d| *d = f32::NAN);
        assert!(sharpen(&holed, None, false, &kinect()).is_none());
    }

    /// A regression: in images with a focal length below 230 px, as those of a phone's depth are, no edge was taken for smeared.
    #[test]
    fn an_edge_that_is_smeared_in_a_small_image_becomes_a_step() {
        let small = space([200.0; 2], [29.5; 2]);
        let sharp = sharpen(&edge(3), None, false, &small).unwrap();
        assert!(has_two_levels(&sharp), "{:?}", &sharp.as_slice()[..SIZE]);
    }
}
