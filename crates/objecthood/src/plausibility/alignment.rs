//! Edges of depth against edges of colour.

use super::doubt::{Doubt, Mirrored};
use super::sample::grid_px;
use crate::raster::Raster;

/// Neighbours whose depths differ by more than this share are an edge.
const EDGE: f32 = 0.04;

/// Edges are searched in this many rows for each row of the grid.
const ROWS_A_GRID: usize = 2;

/// Neighbours may have this much between them without depth, as a share of the width: the shadow beside an edge.
const SHADOW: f64 = 0.025;

/// A change of colour is searched within this distance of an edge (px).
const NEAR_PX: usize = 2;

/// Changes of colour (sum of three channels) count up to this.
const MOST_CHANGE: f64 = 60.0;

/// With fewer edges nothing is reported.
const FEWEST: usize = 50;

/// If one image is mirrored, the change of colour at edges must be larger by this ..
const GAIN: f64 = 4.0;

/// .. and by this many standard errors of its mean.
const SURE: f64 = 4.0;

/// This many counted edges are one independent edge, because those of one contour go together.
const TOGETHER: f64 = 4.0;

/// The ways in which the colour image may lie, the first unchanged.
const WAYS: [Option<Mirrored>; 4] =
    [None, Some(Mirrored::Sideways), Some(Mirrored::UpsideDown), Some(Mirrored::Turned)];

/// Whether edges of depth match those of the colour better if one image is mirrored.
pub(super) fn doubt(depth_m: &Raster<f32>, color: &Raster<[u8; 3]>) -> Option<Doubt> {
    let edges = edges(depth_m);
    if edges.len() < FEWEST {
        return None;
    }
    let count = edges.len() as f64;
    let mut best = None;
    let mut plain = 0.0;
    let mut most = 0.0;
    for way in WAYS {
        let changes = edges.iter().map(|&edge| change(color, seen(edge, way, color.size())));
        let [sum, squares] = changes.fold([0.0; 2], |[sum, squares], x| [sum + x, squares + x * x]);
        let mean = sum / count;
        let error = ((squares / count - mean * mean).max(0.0) * TOGETHER / count).sqrt();
        if way.is_none() {
            plain = mean;
        } else if mean - plain > GAIN.max(SURE * error) && mean > most {
            (best, most) = (way, mean);
        }
    }
    best.map(Doubt::ColorMirrored)
}

/// The nearer pixel at each jump of depth along some rows: column and row.
fn edges(depth_m: &Raster<f32>) -> Vec<[usize; 2]> {
    let width = depth_m.width();
    let shadow = (SHADOW * width as f64) as usize + 1;
    let mut edges = Vec::new();
    let rows = depth_m.as_slice().chunks_exact(width).enumerate();
    for (v, row) in rows.step_by((grid_px(width) / ROWS_A_GRID).max(1)) {
        let (mut before, mut z_before) = (0, f32::NAN);
        for (u, &z) in row.iter().enumerate().filter(|(_, z)| !z.is_nan()) {
            // Missing depth counts as nothing nearer.
            if (z - z_before).abs() > EDGE * z.max(z_before) && u - before <= shadow {
                edges.push([if z < z_before { u } else { before }, v]);
            }
            (before, z_before) = (u, z);
        }
    }
    edges
}

/// The place of a pixel in an image that is seen in this way.
fn seen([u, v]: [usize; 2], way: Option<Mirrored>, (width, height): (usize, usize)) -> [usize; 2] {
    let (across, down) = (width - 1 - u, height - 1 - v);
    match way {
        None => [u, v],
        Some(Mirrored::Sideways) => [across, v],
        Some(Mirrored::UpsideDown) => [u, down],
        Some(Mirrored::Turned) => [across, down],
    }
}

/// The greatest change of colour along the row near a pixel.
fn change(color: &Raster<[u8; 3]>, [u, v]: [usize; 2]) -> f64 {
    let width = color.width();
    let row = &color.as_slice()[v * width..][..width];
    let near = u.saturating_sub(NEAR_PX + 1)..(u + NEAR_PX + 2).min(width);
    let change = |three: &[[u8; 3]]| -> u16 {
        three[0].iter().zip(three[2]).map(|(&a, b)| u16::from(a.abs_diff(b))).sum()
    };
    f64::from(row[near].windows(3).map(change).max().unwrap_or(0)).min(MOST_CHANGE)
}
