//! Curvature from opposite normals (paper, eq. 2).

use rayon::prelude::*;

use crate::buffers::Buffer;
use crate::params;
use crate::raster::{Raster, part};
use crate::simd::vectorized;

/// Curvature of a pixel without a usable pair of normals: above every threshold.
pub const UNKNOWN: f32 = f32::INFINITY;

/// Measures the curvature of every pixel: one minus the mean cosine between the normals of opposite neighbours at `offset_px`,
/// over the horizontal, the vertical and the two diagonal pairs. 0 = flat, 2 = folded back, [`UNKNOWN`] without a usable pair.
///
/// *Differs from the paper:* it prints the factor 1/(4σ), and a bracket is missing. Here the mean is over the usable pairs and
/// divided by σ = `scale`. A straight crease bends only three of the four pairs, so at the default threshold a crease is
/// curved from 35.6° on. O(pixels); parallel over rows.
pub fn measure_curvature(normals: &Raster<[f32; 3]>, params: &params::Curvature) -> Raster<f32> {
    let (width, height) = normals.size();
    let offset = params.offset_px;
    // A row above or below the image is empty.
    let row = |v: Option<usize>| {
        v.filter(|v| *v < height).map_or(&[][..], |v| &normals.as_slice()[v * width..][..width])
    };
    let mut curvature = Buffer::stale(normals.len(), UNKNOWN);
    curvature.par_chunks_mut(width).enumerate().for_each_init(
        || vec![Pairs::default(); width],
        |pairs, (v, curvature)| {
            let [above, own, below] = [v.checked_sub(offset), Some(v), Some(v + offset)].map(row);
            vectorized(
                #[inline(always)]
                || {
                    pairs.fill(Pairs::default());
                    add_pairs(pairs, offset, below, above);
                    add_pairs(pairs, offset, above, below);
                    add_pairs(pairs, offset, own, own);
                    add_pairs(pairs, 0, below, above);
                    for (curvature, pairs) in curvature.iter_mut().zip(&*pairs) {
                        let bent = 1.0 - pairs.cosines / (pairs.count * params.scale);
                        *curvature = if pairs.count > 0.0 { bent } else { UNKNOWN };
                    }
                },
            );
        },
    );
    normals.with_data(curvature)
}

/// Sums over the usable pairs around a pixel. A pair is usable when both its pixels have a normal.
#[derive(Clone, Copy, Default)]
struct Pairs {
    cosines: f32,
    count: f32,
}

/// Adds one pair to every pixel of a row: the pixel `columns` to the right of it in the row `right`, and the pixel as far to
/// its left in the row `left`.
#[inline(always)]
fn add_pairs(pairs: &mut [Pairs], columns: usize, right: &[[f32; 3]], left: &[[f32; 3]]) {
    let count = right.len().min(left.len()).saturating_sub(2 * columns);
    let ends = part(right, 2 * columns, count).iter().zip(part(left, 0, count));
    for (pair, (&p, &q)) in pairs.iter_mut().skip(columns).zip(ends) {
        let is_some = |n: [f32; 3]| (n[0] != 0.0) | (n[1] != 0.0) | (n[2] != 0.0);
        let is_usable = is_some(p) & is_some(q);
        pair.cosines += if is_usable { p[0] * q[0] + p[1] * q[1] + p[2] * q[2] } else { 0.0 };
        pair.count += if is_usable { 1.0 } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;

    fn crease(degrees: f32) -> Raster<f32> {
        let turned = degrees.to_radians();
        let normal = |i: usize| if i % 9 < 4 { [0.0, 0.0, -1.0] } else { [turned.sin(), 0.0, -turned.cos()] };
        let normals = Raster::from_vec(9, 9, (0..81).map(normal).collect()).unwrap();
        measure_curvature(&normals, &params::Curvature::default())
    }

    #[test]
    fn flat_is_zero_and_a_crease_bends_three_of_four_pairs() {
        assert_eq!(crease(0.0)[40], 0.0);
        let expected = 0.75 * (1.0 - 30_f32.to_radians().cos());
        assert!((crease(30.0)[40] - expected).abs() < 1e-6);
        // PARITY.md 1: the default threshold of 0.14 is passed from 35.6 degrees on.
        assert!(crease(35.5)[40] < 0.14 && crease(35.7)[40] > 0.14);
    }

    #[test]
    fn only_usable_pairs_count_and_none_is_unknown() {
        let mut normals = Raster::filled(9, 9, [0.0, 0.0, -1.0]).unwrap();
        normals.as_mut_slice()[40 - 2] = [0.0; 3];
        let c = measure_curvature(&normals, &params::Curvature::default());
        assert_eq!(c[40], 0.0);
        assert_eq!(c[0], UNKNOWN, "a corner has no opposite neighbours");
        let none = Raster::filled(9, 9, [0.0; 3]).unwrap();
        assert!(
            measure_curvature(&none, &params::Curvature::default()).as_slice().iter().all(|&c| c == UNKNOWN)
        );
    }

    proptest! {
        #[test]
        fn equals_the_naive_mean_over_opposite_pixels(
            (width, normals) in (1_usize..11, 1_usize..11).prop_flat_map(|(w, h)| {
                let normal = (prop::array::uniform3(-1.0_f32..1.0), 0_u8..4);
                (Just(w), prop::collection::vec(normal, w * h))
            }),
            offset_px in 1_usize..5,
            scale in 0.1_f32..3.0,
        ) {
            let height = normals.len() / width;
            let unit = |(n, kind): &([f32; 3], u8)| {
                if *kind == 0 { [0.0; 3] } else { Vec3::from(*n).normalize_or_zero().to_array() }
            };
            let normals = Raster::from_vec(width, height, normals.iter().map(unit).collect()).unwrap();
            let got = measure_curvature(&normals, &params::Curvature { offset_px, scale, ..Default::default() });
            for i in 0..normals.len() {
                // All pairs of pixels whose middle is pixel i and that lie on the ring of eight around it.
                let ring = |d: usize| d == 0 || d == offset_px;
                let mut cosines = Vec::new();
                for p in 0..i {
                    let (du, dv) = ((p % width).abs_diff(i % width), i / width - p / width);
                    let q = 2 * i - p;
                    let opposite = q < normals.len()
                        && p % width + q % width == 2 * (i % width)
                        && p / width + q / width == 2 * (i / width);
                    if opposite && ring(du) && ring(dv) && normals[p] != [0.0; 3] && normals[q] != [0.0; 3] {
                        cosines.push(Vec3::from(normals[p]).dot(Vec3::from(normals[q])));
                    }
                }
                let mean = cosines.iter().sum::<f32>() / cosines.len() as f32;
                let expected = if cosines.is_empty() { UNKNOWN } else { 1.0 - mean / scale };
                let close = got[i] == expected || (got[i] - expected).abs() < 1e-4;
                prop_assert!(close, "{} {}", got[i], expected);
            }
        }
    }
}
