//! Curvature from opposite normals (paper, eq. 2).

use glam::Vec3;
use rayon::prelude::*;

use crate::params;
use crate::raster::Raster;
use crate::workspace::Workspace;

/// Curvature of a pixel around which no pair of normals is usable: beyond every threshold.
pub const UNKNOWN: f32 = f32::INFINITY;

/// One minus the mean cosine between the normals of opposite neighbours at `offset_px`, over the horizontal,
/// the vertical and the two diagonal pairs: 0 = flat, 2 = folded back, [`UNKNOWN`] without a usable pair.
///
/// *Differs from the paper:* printed is 1/(4σ) with a bracket missing; here the mean is over the usable pairs
/// and divided by σ = `scale`. A straight crease bends only three of the four pairs, so it counts from 35.6° at
/// the default threshold. O(pixels).
pub fn curvature(
    normals: &Raster<[f32; 3]>,
    params: &params::Curvature,
    workspace: &mut Workspace,
) -> Raster<f32> {
    let (width, height) = normals.size();
    let offset = params.offset_px as isize;
    let normal = |u: isize, v: isize| -> Option<Vec3> {
        let inside = u >= 0 && v >= 0 && (u as usize) < width && (v as usize) < height;
        let n = if inside { Vec3::from(normals[v as usize * width + u as usize]) } else { Vec3::ZERO };
        (n != Vec3::ZERO).then_some(n)
    };
    let mut curvature = workspace.filled(normals.len(), UNKNOWN);
    curvature.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
        for (u, curvature) in row.iter_mut().enumerate() {
            let (u, v) = (u as isize, v as isize);
            let mut cosines = 0.0;
            let mut pairs = 0.0;
            for (du, dv) in [(offset, offset), (offset, -offset), (offset, 0), (0, offset)] {
                if let (Some(p), Some(q)) = (normal(u + du, v + dv), normal(u - du, v - dv)) {
                    cosines += p.dot(q);
                    pairs += 1.0;
                }
            }
            if pairs > 0.0 {
                *curvature = 1.0 - cosines / (pairs * params.scale);
            }
        }
    });
    normals.with_data(curvature)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn crease(degrees: f32) -> Raster<f32> {
        let turned = degrees.to_radians();
        let normal = |i: usize| if i % 9 < 4 { [0.0, 0.0, -1.0] } else { [turned.sin(), 0.0, -turned.cos()] };
        let normals = Raster::from_vec(9, 9, (0..81).map(normal).collect()).unwrap();
        curvature(&normals, &params::Curvature::default(), &mut Workspace::default())
    }

    #[test]
    fn flat_is_zero_and_a_crease_bends_three_of_four_pairs() {
        assert_eq!(crease(0.0)[40], 0.0);
        let expected = 0.75 * (1.0 - 30_f32.to_radians().cos());
        assert!((crease(30.0)[40] - expected).abs() < 1e-6);
        // METHOD 2.2: the default threshold of 0.14 is passed from 35.6 degrees on.
        assert!(crease(35.5)[40] < 0.14 && crease(35.7)[40] > 0.14);
    }

    #[test]
    fn only_usable_pairs_count_and_none_is_unknown() {
        let mut normals = Raster::filled(9, 9, [0.0, 0.0, -1.0]).unwrap();
        normals.as_mut_slice()[40 - 2] = [0.0; 3];
        let c = curvature(&normals, &params::Curvature::default(), &mut Workspace::default());
        assert_eq!(c[40], 0.0);
        assert_eq!(c[0], UNKNOWN, "a corner has no opposite neighbours");
        let none = Raster::filled(9, 9, [0.0; 3]).unwrap();
        assert!(
            curvature(&none, &params::Curvature::default(), &mut Workspace::default())
                .as_slice()
                .iter()
                .all(|&c| c == UNKNOWN)
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
            let got = curvature(&normals, &params::Curvature { offset_px, scale, ..Default::default() }, &mut Workspace::default());
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
