//! Gaussian smoothing of the colour image (paper, III-A).

use glam::Vec4;
use rayon::prelude::*;

use crate::params;
use crate::raster::Raster;

/// The colour image in grey levels 0..255, smoothed by a separable Gaussian; not rounded.
///
/// Pixels with depth and pixels without are smoothed each among themselves, the weights normalised over those
/// in the window (normalised convolution, Knutsson and Westin 1993): the colour of what was not measured
/// does not bleed into what was. The kernel reaches 4σ, rounded up (5 taps at the default); the border is
/// mirrored without repeating the edge pixel. O(pixels · taps).
pub fn smooth(
    color: &Raster<[u8; 3]>,
    depth_m: &Raster<f32>,
    params: &params::Smoothing,
) -> Raster<[f32; 3]> {
    let kernel = kernel(params.sigma_px);
    let (width, height) = color.size();
    let measured = |i: usize| usize::from(!depth_m[i].is_nan());
    let weighted = |(i, &[r, g, b]): (usize, &[u8; 3])| {
        let mut sums = [Vec4::ZERO; 2];
        sums[measured(i)] = Vec4::new(r.into(), g.into(), b.into(), 1.0);
        sums
    };
    let source = color.with_data(color.as_slice().iter().enumerate().map(weighted).collect());
    let along_rows = filter(&source, &kernel, |u, v, t| v * width + mirror(u as isize + t, width));
    let sums = filter(&along_rows, &kernel, |u, v, t| mirror(v as isize + t, height) * width + u);
    let mean = |(i, sums): (usize, &Sums)| {
        let sum = sums[measured(i)];
        (sum.truncate() / sum.w).to_array()
    };
    color.with_data(sums.as_slice().iter().enumerate().map(mean).collect())
}

/// Weighted sums of red, green, blue and one: of the pixels without depth, and of those with.
type Sums = [Vec4; 2];

/// The right half of the kernel, the middle tap first.
fn kernel(sigma_px: f64) -> Vec<f32> {
    let reach = (4.0 * sigma_px).ceil() as usize;
    let tap =
        |t: usize| if t == 0 { 1.0 } else { libm::exp(-((t * t) as f64) / (2.0 * sigma_px * sigma_px)) };
    let taps: Vec<f64> = (0..=reach).map(tap).collect();
    let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
    taps.iter().map(|t| (t / sum) as f32).collect()
}

/// The index that stands in for `i` when it lies outside 0..n: mirrored at the first and last pixel.
fn mirror(i: isize, n: usize) -> usize {
    let period = (2 * n as isize - 2).max(1);
    let i = i.rem_euclid(period) as usize;
    if i < n { i } else { period as usize - i }
}

fn filter(
    image: &Raster<Sums>,
    kernel: &[f32],
    neighbour: impl Fn(usize, usize, isize) -> usize + Sync,
) -> Raster<Sums> {
    let width = image.width();
    let mut out = vec![[Vec4::ZERO; 2]; image.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
        for (u, sums) in row.iter_mut().enumerate() {
            *sums = image[v * width + u].map(|sum| kernel[0] * sum);
            for (t, &weight) in kernel.iter().enumerate().skip(1) {
                let left = image[neighbour(u, v, -(t as isize))];
                let right = image[neighbour(u, v, t as isize)];
                for class in 0..2 {
                    sums[class] += weight * (left[class] + right[class]);
                }
            }
        }
    });
    image.with_data(out)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_flat_image_stays_and_a_dot_becomes_the_kernel() {
        let flat = Raster::filled(3, 2, [10, 20, 30]).unwrap();
        let smooth_flat = smooth(&flat, &Raster::filled(3, 2, 1.0).unwrap(), &params::Smoothing::default());
        for c in smooth_flat.as_slice() {
            assert!((c[0] - 10.0).abs() < 1e-4 && (c[2] - 30.0).abs() < 1e-4, "{c:?}");
        }
        let mut dot = Raster::filled(9, 9, [0; 3]).unwrap();
        dot.as_mut_slice()[40] = [255, 0, 0];
        let smoothed = smooth(&dot, &Raster::filled(9, 9, 1.0).unwrap(), &params::Smoothing::default());
        let k: Vec<f64> = (-2..=2).map(|t: i32| (-f64::from(t * t) / 0.5).exp()).collect();
        let sum: f64 = k.iter().sum();
        for dv in 0..5 {
            for du in 0..5 {
                let expected = 255.0 * k[du] * k[dv] / sum / sum;
                let got = f64::from(smoothed[(2 + dv) * 9 + 2 + du][0]);
                assert!((got - expected).abs() < 1e-3, "{got} {expected}");
            }
        }
    }

    #[test]
    fn the_border_is_mirrored_without_repeating_the_edge() {
        assert_eq!([-2, -1, 0, 3, 4, 5].map(|i| mirror(i, 4)), [2, 1, 0, 3, 2, 1]);
        assert_eq!([-3, 0, 2].map(|i| mirror(i, 1)), [0, 0, 0]);
    }

    /// The place reached after walking `steps` from `start`, turning round at the first and last of `n` places.
    fn walk(start: usize, steps: i32, n: usize) -> usize {
        let (mut at, mut direction) = (start as i32, steps.signum());
        for _ in 0..steps.abs() {
            if n > 1 && !(0..n as i32).contains(&(at + direction)) {
                direction = -direction;
            }
            at += if n > 1 { direction } else { 0 };
        }
        at as usize
    }

    proptest! {
        #[test]
        fn equals_the_naive_mean_over_neighbours_of_the_same_kind(
            (width, pixels) in (1_usize..9, 1_usize..9).prop_flat_map(|(w, h)| {
                (Just(w), prop::collection::vec((any::<[u8; 3]>(), 0_u8..3), w * h))
            }),
            sigma_px in 0.1_f64..1.5,
        ) {
            let height = pixels.len() / width;
            let color = Raster::from_vec(width, height, pixels.iter().map(|p| p.0).collect()).unwrap();
            let depth = color.with_data(pixels.iter().map(|p| if p.1 == 0 { f32::NAN } else { 1.0 }).collect());
            let smoothed = smooth(&color, &depth, &params::Smoothing { sigma_px });
            let reach = (4.0 * sigma_px).ceil() as i32;
            for i in 0..color.len() {
                let (mut sum, mut weights) = ([0.0; 3], 0.0);
                for (dv, du) in (-reach..=reach).flat_map(|dv| (-reach..=reach).map(move |du| (dv, du))) {
                    let q = walk(i / width, dv, height) * width + walk(i % width, du, width);
                    if depth[q].is_nan() == depth[i].is_nan() {
                        let weight = (-f64::from(du * du + dv * dv) / (2.0 * sigma_px * sigma_px)).exp();
                        (0..3).for_each(|c| sum[c] += weight * f64::from(color[q][c]));
                        weights += weight;
                    }
                }
                for (got, sum) in smoothed[i].into_iter().zip(sum) {
                    prop_assert!((f64::from(got) - sum / weights).abs() < 1e-3, "{} {}", got, sum / weights);
                }
            }
        }
    }
}
