//! Depth changes: neighbouring pixels too far apart in depth to lie on one surface.
//!
//! Source: the smart-depth-change windows of integral-image normals (Holzer et al., IROS 2012), PARITY.md 1.
//! *Differs:* their windows also grow with depth; ours do not. The distance is exact, not a chamfer approximation.

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::raster::Raster;

/// Depths that differ by more than this share of the greater one lie on two surfaces, whatever the sensor's noise.
const GREATEST_STEP: f32 = 0.5;

/// Whether depth changes between two neighbours: exactly one depth is missing, or they differ by more than
/// `change_per_m`·z² (m), z the greater depth. Missing depth is `NaN`.
///
/// *Differs:* beyond z = 1/`change_per_m` that bound exceeds z itself, and no difference would be a change. So it is limited
/// to half of z; at the default the limit applies from 25 m on.
#[inline]
pub fn changes(z_p: f32, z_q: f32, change_per_m: f32) -> bool {
    match (z_p.is_nan(), z_q.is_nan()) {
        (false, false) => {
            let z = z_p.max(z_q);
            (z_p - z_q).abs() > (change_per_m * z).min(GREATEST_STEP) * z
        }
        (p, q) => p != q,
    }
}

/// The farthest distance that is measured (px): the square of one pixel more fits 16 bits.
const FARTHEST_REACH_PX: usize = 180;

/// Measures the squared distance (px²) of every pixel from the nearest pixel beside a depth change, at most `reach_px`² + 1. A
/// `reach_px` beyond 180 counts as 180.
///
/// A pixel is beside a change when it differs from its right, left, lower or upper neighbour ([`changes`]). Two passes, columns
/// then rows, exact in integers of 16 bits. O(pixels · `reach_px`); the second pass is parallel over rows.
pub(crate) fn measure_squared_distances(
    depth_m: &Raster<f32>,
    change_per_m: f32,
    reach_px: usize,
) -> Raster<i16> {
    let width = depth_m.width();
    let reach_px = reach_px.min(FARTHEST_REACH_PX);
    let mut column = Buffer::filled(depth_m.len(), (reach_px + 1) as i16);
    mark_changes(depth_m, change_per_m, &mut column);
    spread_along_columns(&mut column, width);
    // Second pass: the nearest change in any column within reach.
    let mut squared = Buffer::filled(depth_m.len(), (reach_px * reach_px + 1) as i16);
    squared.par_chunks_mut(width).zip(column.par_chunks_mut(width)).for_each(|(squared, column)| {
        column.iter_mut().for_each(|rows| *rows *= *rows);
        for columns in 0..=reach_px.min(width - 1) {
            let add = (columns * columns) as i16;
            nearest(&mut squared[columns..], &column[..width - columns], add);
            nearest(&mut squared[..width - columns], &column[columns..], add);
        }
    });
    depth_m.with_data(squared)
}

/// Sets the distance of pixels beside a depth change to 0.
fn mark_changes(depth_m: &Raster<f32>, change_per_m: f32, distance: &mut [i16]) {
    let (width, height) = depth_m.size();
    let z = depth_m.as_slice();
    let mut change = vec![false; width];
    for v in 0..height {
        let (row, below) = z[v * width..].split_at(width);
        let (here, next) = distance[v * width..].split_at_mut(width);
        mark(&mut change, &row[..width - 1], &row[1..], change_per_m);
        bring_near(&mut here[..width - 1], &change);
        bring_near(&mut here[1..], &change);
        if v + 1 < height {
            mark(&mut change, row, &below[..width], change_per_m);
            bring_near(here, &change);
            bring_near(&mut next[..width], &change);
        }
    }
}

/// Turns marks into distances along the columns, first downwards, then upwards.
fn spread_along_columns(distance: &mut [i16], width: usize) {
    let height = distance.len() / width;
    for v in 1..height {
        let (above, below) = distance.split_at_mut(v * width);
        one_farther(&mut below[..width], &above[(v - 1) * width..]);
    }
    for v in (1..height).rev() {
        let (above, below) = distance.split_at_mut(v * width);
        one_farther(&mut above[(v - 1) * width..], &below[..width]);
    }
}

/// Marks where depth changes between two rows of pixels.
fn mark(change: &mut [bool], z_p: &[f32], z_q: &[f32], change_per_m: f32) {
    for (change, (&z_p, &z_q)) in change.iter_mut().zip(z_p.iter().zip(z_q)) {
        *change = changes(z_p, z_q, change_per_m);
    }
}

/// Pixels beside a change are at distance 0.
fn bring_near(distance: &mut [i16], change: &[bool]) {
    for (distance, &change) in distance.iter_mut().zip(change) {
        *distance *= i16::from(!change);
    }
}

/// No pixel is more than one farther from a change than its neighbour.
fn one_farther(distance: &mut [i16], neighbour: &[i16]) {
    for (distance, &neighbour) in distance.iter_mut().zip(neighbour) {
        *distance = (*distance).min(neighbour + 1);
    }
}

/// Lowers squared distances to the distances from changes in another column, `columns_squared` away.
fn nearest(squared: &mut [i16], rows_squared: &[i16], columns_squared: i16) {
    for (squared, &rows) in squared.iter_mut().zip(rows_squared) {
        *squared = (*squared).min(rows.saturating_add(columns_squared));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_the_brute_force_one() {
        let (width, height, reach) = (23, 17, 6);
        let depth: Vec<f32> = (0..width * height)
            .map(|i| match (i * 2_654_435_761_usize) >> 7 & 63 {
                0 => f32::NAN,
                1 => 1.5,
                _ => 1.0,
            })
            .collect();
        let depth = Raster::from_vec(width, height, depth).unwrap();
        let at = |u: i32, v: i32| {
            let inside = u >= 0 && v >= 0 && u < width as i32 && v < height as i32;
            inside.then(|| depth[v as usize * width + u as usize])
        };
        let beside = |u: i32, v: i32| {
            [(1, 0), (-1, 0), (0, 1), (0, -1)]
                .iter()
                .any(|(du, dv)| at(u + du, v + dv).is_some_and(|z| changes(at(u, v).unwrap(), z, 0.02)))
        };
        let squared = measure_squared_distances(&depth, 0.02, reach);
        for v in 0..height as i32 {
            for u in 0..width as i32 {
                let mut best = (reach * reach + 1) as i32;
                for q in 0..height as i32 {
                    for p in 0..width as i32 {
                        if beside(p, q) {
                            best = best.min((p - u).pow(2) + (q - v).pow(2));
                        }
                    }
                }
                assert_eq!(i32::from(squared[v as usize * width + u as usize]), best, "at {u}, {v}");
            }
        }
    }
}
