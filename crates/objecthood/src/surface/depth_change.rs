//! Where the depth changes so much that two pixels cannot lie on one surface.
//!
//! Source: the smart-depth-change windows of integral-image normals (Holzer et al., IROS 2012), METHOD 2.2.
//! *Differs:* their windows also grow with depth; ours do not. The distance is exact, not a chamfer approximation.

use rayon::prelude::*;

use crate::raster::Raster;

/// A neighbour at less than this share of the other's depth is on another surface, whatever the sensor's noise.
const GREATEST_STEP: f32 = 0.5;

/// Whether depth changes between two neighbours: exactly one is missing, or they differ by more than
/// `change_per_m`·z² (m), z the greater depth. Missing depth is `NaN`.
///
/// *Differs:* beyond z = 1/`change_per_m` that bound exceeds z itself and would let everything pass, so it is at
/// most half of z; at the default this begins at 25 m.
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

/// Squared distance (px²) of every pixel to the nearest pixel beside a depth change, at most `reach_px`² + 1.
///
/// A pixel is beside a change when it differs from its right, left, lower or upper neighbour ([`changes`]).
/// Two passes, columns then rows, exact in integers. O(pixels · `reach_px`).
pub fn squared_distance(depth_m: &Raster<f32>, change_per_m: f32, reach_px: usize) -> Raster<u32> {
    let (width, height) = depth_m.size();
    let z = depth_m.as_slice();
    let far = (reach_px + 1) as u32;
    // Distance along the column, first downwards, then upwards.
    let mut column = vec![far; z.len()];
    for v in 0..height {
        for u in 0..width {
            let i = v * width + u;
            if u + 1 < width && changes(z[i], z[i + 1], change_per_m) {
                column[i] = 0;
                column[i + 1] = 0;
            }
            if v + 1 < height && changes(z[i], z[i + width], change_per_m) {
                column[i] = 0;
                column[i + width] = 0;
            }
        }
    }
    for i in width..z.len() {
        column[i] = column[i].min(column[i - width] + 1);
    }
    for i in (0..z.len() - width).rev() {
        column[i] = column[i].min(column[i + width] + 1);
    }
    // Then the best column within reach.
    let cap = (reach_px * reach_px + 1) as u32;
    let mut squared = vec![cap; z.len()];
    squared.par_chunks_mut(width).zip(column.par_chunks(width)).for_each(|(squared, column)| {
        for (u, best) in squared.iter_mut().enumerate() {
            let window = u.saturating_sub(reach_px)..(u + reach_px + 1).min(width);
            for (q, &rows) in window.clone().zip(&column[window]) {
                let columns = u.abs_diff(q) as u32;
                *best = (*best).min(columns * columns + rows * rows);
            }
        }
    });
    depth_m.with_data(squared)
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
        let squared = squared_distance(&depth, 0.02, reach);
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
                assert_eq!(squared[v as usize * width + u as usize], best as u32, "at {u}, {v}");
            }
        }
    }
}
